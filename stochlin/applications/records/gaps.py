"""Gap that two structures would have needed in a recorded motion, or set-back of one structure."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from stochlin.applications.records.cells import (
    RECORD,
    OnRecord,
    RecordCells,
    RecordedMotions,
    Records,
    checked_motions,
    ends_of_events,
)
from stochlin.applications.records.components import events_of
from stochlin.applications.records.stepped import gap_columns, stepped_gap
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.records import oscillator as recorded
from stochlin.kernels.records.runs import peaks_on_records
from stochlin.models.arguments import checked
from stochlin.models.laws.bilinear import Bilinear
from stochlin.solver.simulation.statistics import quantile_intervals
from stochlin.solver.tables import labels
from stochlin.solver.tables.cells import over_cells
from stochlin.solver.tables.checks import standing

RECORDED_SET_BACK = "Set-back of one structure from its property line in recorded motions"
GAP_QUANTILES = np.array([0.5, 0.84, 0.9, 0.95])


@checked
def recorded_gap(
    first: OnRecord,
    second: OnRecord | None,
    record: Records,
    *,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Smallest gap without contact between two structures in a recorded motion.

    It is ``max (u_1 - u_2)`` over the motion, with ``first`` on the left. It requires no rule for
    the combination of peaks.

    Parameters
    ----------
    first, second : Bilinear, BoucWen, Hysteretic or ShearBuilding, or None for ``second``
        Structures, elastic or with a yield displacement or yield drifts. Parameters of oscillators
        broadcast by dimension name. If ``second`` is None, ``first`` stands alone, and the gap is
        its distance from the property line on its right.
    record : xarray.DataArray, or list or mapping of them
        Ground acceleration [m/s^2] over ``time`` [s], as from `read_record`. Several records add
        the dimension ``record`` to the result.
    progress : callable, optional
        Called with the share of the work that is done.

    Returns
    -------
    xarray.Dataset
        Over the dimensions of the parameters: ``separation`` [m]; ``peak_1`` and ``peak_2`` [m],
        the peaks ``max |u|`` of both structures, for a building at the level of the lower roof;
        ``srss`` [m] of the two peaks and ``separation_over_srss`` [-]; ``rho`` [-], ``int u_1 u_2
        dt`` over the square root of ``int u_1^2 dt int u_2^2 dt``, with displacements from the
        position before the motion; ``status``, which is ``elastic_limit`` where no structure
        yielded. For two oscillators also ``pseudo_energy_radius_1`` and ``_2`` [m]. Unless both
        structures are `Bilinear`, also ``step_error`` [-], the largest change of a peak when the
        time step was last halved.

        For buildings with storeys, ``separation`` is the largest over all heights; there are also
        ``separation_at_height`` [m] over ``height``, and ``peak_drift`` [m] and ``ductility`` [-]
        over ``element``. For several records there is also ``separation_quantile`` [m] over
        ``quantile``, with a 95 % interval ``_lower`` and ``_upper``, infinite if the records are
        too few, in which two components of a station in one earthquake count as one (see
        `read_records`). If a structure falls (see `simulate`), its peak and ``separation`` are
        infinite. For one structure alone, the variables of two structures are left out.

    Raises
    ------
    ValueError, TypeError
        As in `response_spectrum`, or if a structure has a reduction factor.

    Notes
    -----
    For two `Bilinear` structures the response is exact for a ground acceleration that is linear
    between samples, as in `response_spectrum`; both have common sub-steps, chosen for the stiffer
    one. Other structures have the time steps of `simulate`, halved until no peak changes by more
    than 1e-4.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (2) and (3), which estimate this gap.

    Examples
    --------
    >>> import numpy as np, xarray as xr, stochlin as sl
    >>> time = 0.02 * np.arange(1000)
    >>> record = xr.DataArray(
    ...     np.sin(2 * np.pi * time), dims="time", coords={"time": time}, attrs={"units": "m/s^2"}
    ... )
    >>> soft, stiff = sl.Bilinear(period=1.1, damping=0.05), sl.Bilinear(period=0.9, damping=0.05)
    >>> table = sl.recorded_gap(soft, stiff, record)
    >>> float(table.separation) < float(table.peak_1 + table.peak_2)
    True
    >>> float(sl.recorded_gap(soft, soft, record).separation)
    0.0
    >>> float(sl.recorded_gap(soft, None, record).separation) <= float(table.peak_1)
    True
    """
    roles = standing(first, second)
    motions = checked_motions(record)
    if all(isinstance(structure, Bilinear) for structure in roles.values()):
        table = _exactly(list(roles.values()), motions, progress)
    else:
        table = over_cells(
            lambda **roles: stepped_gap(list(roles.values()), motions, progress), roles
        )
    if motions.names is not None:
        events = events_of(motions.names, motions.records)
        table = table.merge(
            quantiles_of_records("separation", table.separation, events, GAP_QUANTILES)
        )
    title = "Gap of two structures in recorded motions" if second is not None else RECORDED_SET_BACK
    table = labels.label(table.assign_attrs(records=motions.describe()))
    return labels.with_run_information(table, title, "recorded_gap()", roles)


def quantiles_of_records(
    name: str, values: xr.DataArray, events: Sequence[object], levels: Array
) -> xr.Dataset:
    """Quantiles of values over the records, with their 95 % intervals over events."""
    like = values.isel({RECORD: 0}, drop=True)
    table = xr.Dataset(
        coords={**like.coords, "quantile": labels.axis("quantile", "quantile", levels)}
    )
    for n, samples in enumerate([values, *ends_of_events(values, events)]):
        quantiles = quantile_intervals(samples.transpose(RECORD, ...).to_numpy(), levels)[n]
        table[f"{name}_quantile{labels.VALUE_AND_ENDS[n]}"] = ("quantile", *like.dims), quantiles
    return table


def _exactly(
    structures: list[Bilinear], motions: RecordedMotions, progress: Progress | None
) -> xr.Dataset:
    """Exact results for bilinear structures in all cells, without labels."""
    cells = RecordCells.of(motions, *structures)
    peaks = peaks_on_records(motions.grounds, *cells.sides, progress=progress)
    sides = np.moveaxis(peaks, 2, 0)
    highest = [cells.peak(number, side) for number, side in enumerate(sides)]
    rho = sides[0, ..., recorded.RHO] if len(sides) == 2 else None
    columns = gap_columns(sides[0, ..., recorded.HIGHEST], highest, rho)
    for number, (peak, side) in enumerate(zip(highest, sides, strict=True), start=1):
        radius = np.where(np.isfinite(peak), side[..., recorded.RADIUS], np.inf)
        columns[f"pseudo_energy_radius_{number}"] = radius
    return cells.table(columns, highest)
