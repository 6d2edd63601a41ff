"""The energy approach in recorded motions: eq. (3) with pseudo energy radii, and added damping."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr

from stochlin.applications.records.cells import OscillatorOnRecord, Records, checked_motions
from stochlin.applications.records.gaps import recorded_gap
from stochlin.applications.separation.existing_gap import damped
from stochlin.kernels.correlation.closed_forms import double_difference
from stochlin.models.arguments import Metres, checked
from stochlin.models.grounds import Ground
from stochlin.models.parameters import Model
from stochlin.models.structures import Structure
from stochlin.solver.correlation.correlation import correlate
from stochlin.solver.correlation.equation_4 import rho_white_noise
from stochlin.solver.tables import labels

TRIED_DAMPINGS = np.linspace(0, 0.4, 41)  # added damping ratios
SHARES_BETWEEN_DAMPINGS = np.linspace(0, 1, 11)  # of the step between two of these
DAMPED_STRUCTURES: Mapping[str, tuple[float, float]] = {
    "both": (1.0, 1.0),
    "structure 1": (1.0, 0.0),
    "structure 2": (0.0, 1.0),
}
DAMPED = "damped"
ADDED_DAMPING = "added_damping"
LEAST_DAMPING = "least_added_damping"
GAP_CURVES = (
    "critical_gap",
    "separation",
    "rho_estimate",
    *(f"pseudo_energy_radius_{n}" for n in (1, 2)),
)


@checked
def energy_gap(
    first: Structure,
    second: Structure,
    record: Records,
    *,
    ground: Ground | None = None,
) -> xr.Dataset:
    """Critical gap in a recorded motion by the energy approach, compared with the required gap.

    The critical gap is eq. (3) with the pseudo energy radii of both structures, eqs. (1) and (2),
    elastic or yielding, and an estimate of the correlation coefficient. The gap that the record
    requires is that of `recorded_gap`.

    Parameters
    ----------
    first, second : Bilinear, BoucWen or Hysteretic
        Structures, elastic or with a yield displacement. Their parameters broadcast by dimension
        name.
    record : xarray.DataArray, or list or mapping of them
        Ground acceleration [m/s^2] over ``time`` [s], as from `read_record`. Several records add
        the dimension ``record`` to the result.
    ground : WhiteNoise, KanaiTajimi or CloughPenzien, optional
        Ground that represents the record, as from `fit_ground`: the correlation is then that of
        linearization on it, as the paper recommends for yielding structures. By default it is eq.
        (4) with the elastic periods and damping ratios.

    Returns
    -------
    xarray.Dataset
        Over the dimensions of the parameters: the variables of `recorded_gap`, among them
        ``pseudo_energy_radius_1`` and ``_2`` [m] and the required gap ``separation`` [m];
        ``critical_gap`` [m] by eq. (3), with ``rho_estimate`` [-]; and ``critical_gap_error`` [-],
        the critical gap over the separation minus 1.

    Raises
    ------
    ValueError, TypeError
        As in `recorded_gap` and `correlate`.

    Notes
    -----
    The elastic ``rho`` is too small for yielding structures, so that eq. (4) leads to too large a
    gap; the error of linearization has either sign. Both are means over many motions. In a single
    record two structures may therefore touch with the gap of eq. (3). With another correlation,
    such as that of effective properties by ``correlate(..., "effective")``, `critical_gap` combines
    the radii.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (1) to (4), Fig. 2.

    Examples
    --------
    >>> import numpy as np, xarray as xr, stochlin as sl
    >>> time = 0.02 * np.arange(1000)
    >>> record = xr.DataArray(
    ...     np.sin(5 * time), dims="time", coords={"time": time}, attrs={"units": "m/s^2"}
    ... )
    >>> soft, stiff = sl.Bilinear(period=1.1, damping=0.05), sl.Bilinear(period=0.9, damping=0.05)
    >>> table = sl.energy_gap(soft, stiff, record)
    >>> radii = table.pseudo_energy_radius_1, table.pseudo_energy_radius_2
    >>> bool(table.critical_gap == sl.critical_gap(*radii, table.rho_estimate).gap)
    True
    """
    return labels.with_run_information(
        labels.label(estimated_gap(first, second, record, ground)),
        "Critical gap in recorded motions by the energy approach, eq. (3)",
        "energy_gap()",
        {"first": first, "second": second} | ({} if ground is None else {"ground": ground}),
    )


def estimated_gap(
    first: Structure, second: Structure, record: Records, ground: Ground | None
) -> xr.Dataset:
    """The result of `energy_gap`, without labels and run information."""
    table = recorded_gap(first, second, record)
    radii = (table.pseudo_energy_radius_1, table.pseudo_energy_radius_2)
    if ground is not None:
        rho = correlate(first, second, ground, bias=False).rho
    else:
        sides = enumerate((first.arrays(), second.arrays()), start=1)
        linear = {f"{name}_{n}": side[name] for n, side in sides for name in ("period", "damping")}
        rho = np.minimum(rho_white_noise(**linear).rho, 1)
    gap = xr.apply_ufunc(double_difference, *radii, rho, join="exact")
    with np.errstate(divide="ignore", invalid="ignore"):
        error = gap / table.separation - 1
    return table.assign(critical_gap=gap, rho_estimate=rho, critical_gap_error=error)


@checked
def damping_for_gap(
    record: Records,
    first: OscillatorOnRecord,
    second: OscillatorOnRecord,
    gap: Metres,
    *,
    ground: Ground | None = None,
) -> xr.Dataset:
    """Least supplemental damping with which a gap is sufficient in a recorded motion.

    It is computed in two ways: by the energy approach of the paper, that is eq. (3) with the pseudo
    energy radii of the damped structures and a correlation by eq. (4) or by linearization on a
    ground; and by integration of the response to the record.

    Parameters
    ----------
    record, first, second
        As in `energy_gap`.
    gap : float
        Existing gap [m], positive.
    ground : WhiteNoise, KanaiTajimi or CloughPenzien, optional
        As in `energy_gap`, for the correlation.

    Returns
    -------
    xarray.Dataset
        Over ``damped``, the structures with added damping (``"both"`` with the same ratio,
        ``"structure 1"`` or ``"structure 2"``): ``least_added_damping`` [-] by the energy approach,
        and ``least_added_damping_recorded`` [-] by integration of the response. They are 0 if the
        gap is sufficient without added damping, and NaN if it is not sufficient up to 0.4. Over
        ``damped`` and ``added_damping``, the curves from which they are found: ``critical_gap``,
        ``separation``, ``pseudo_energy_radius_1`` and ``_2`` [m] and ``rho_estimate`` [-]. Several
        records add the dimension ``record``. ``status``.

    Raises
    ------
    ValueError, TypeError
        If the gap is not positive; otherwise as in `energy_gap`.

    Notes
    -----
    The required gap need not decrease with added damping: in a single record two structures may
    move out of phase, and damping added to one of two equal buildings causes a relative
    displacement. The least damping is the first sufficient value in steps of 0.01, and between two
    of these in steps of 0.001. A somewhat larger value may not be sufficient again; this is shown
    by the curves over ``added_damping``.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (1) to (4), and for supplemental energy dissipation.

    Examples
    --------
    >>> import numpy as np, xarray as xr, stochlin as sl
    >>> time = 0.02 * np.arange(1000)
    >>> record = xr.DataArray(
    ...     np.sin(5 * time), dims="time", coords={"time": time}, attrs={"units": "m/s^2"}
    ... )
    >>> soft, stiff = sl.Bilinear(period=1.1, damping=0.05), sl.Bilinear(period=0.9, damping=0.05)
    >>> table = sl.damping_for_gap(record, soft, stiff, gap=0.04)
    >>> bool(0 < table.least_added_damping.sel(damped="both") < 0.4)
    True
    """
    motions = checked_motions(record)
    tables = [_least_damping(first, second, record, gap, ground) for record in motions.records]
    table = motions.together(tables).assign_attrs(
        gap_m=float(gap),
        searched=f"added damping to {TRIED_DAMPINGS[-1]:g}, the first that is enough",
        records=motions.describe(),
    )
    models: dict[str, Model] = {"first": first, "second": second}
    return labels.with_run_information(
        labels.label(table),
        "Least added damping for a gap in recorded motions",
        f"damping_for_gap(gap={gap:g})",
        models | ({} if ground is None else {"ground": ground}),
    )


def _least_damping(
    first: Structure, second: Structure, record: xr.DataArray, gap: float, ground: Ground | None
) -> xr.Dataset:
    """The curves over the added damping in one record, and the least that is sufficient."""
    names = xr.DataArray(
        list(DAMPED_STRUCTURES), dims=DAMPED, attrs={"long_name": "where damping is added"}
    )
    shares = np.array([*DAMPED_STRUCTURES.values()])
    share_1 = xr.DataArray(shares[:, 0], {DAMPED: names})
    share_2 = xr.DataArray(shares[:, 1], {DAMPED: names})

    def gaps(added: xr.DataArray) -> xr.Dataset:
        both = damped(first, share_1 * added), damped(second, share_2 * added)
        return estimated_gap(*both, record, ground)

    added = labels.axis(ADDED_DAMPING, "added damping ratio", TRIED_DAMPINGS)
    shares_between = xr.DataArray(SHARES_BETWEEN_DAMPINGS, dims=ADDED_DAMPING)
    table = gaps(added)[[*GAP_CURVES, "status"]]
    for end, name in (("", "critical_gap"), ("_recorded", "separation")):
        enough = table[name] <= gap
        first_enough = enough.argmax(ADDED_DAMPING)
        lower = added[np.maximum(first_enough - 1, 0)].drop_vars(ADDED_DAMPING)
        upper = added[first_enough].drop_vars(ADDED_DAMPING)
        between = lower + (upper - lower) * shares_between
        least = _crossing(gaps(between)[name], between, gap)
        table[f"{LEAST_DAMPING}{end}"] = least.where(enough.any(ADDED_DAMPING))
    return table


def _crossing(required: xr.DataArray, added: xr.DataArray, gap: float) -> xr.DataArray:
    """Added damping with which the required gap first falls to this one, linear between steps."""
    after = (required <= gap).argmax(ADDED_DAMPING)
    before = np.maximum(after - 1, 0)
    x = added.isel({ADDED_DAMPING: before})
    y = required.isel({ADDED_DAMPING: before})
    x_after = added.isel({ADDED_DAMPING: after})
    y_after = required.isel({ADDED_DAMPING: after})
    return x_after.where(after == 0, x + (y - gap) / (y - y_after) * (x_after - x))
