"""Least added damping with which an existing gap is sufficient in a recorded motion."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from stochlin.applications.records.cells import RECORD, OscillatorOnRecord, Records, checked_motions
from stochlin.applications.separation.energy_gap import WHITE_NOISE, Method, RhoEstimate, estimated_gap
from stochlin.applications.separation.existing_gap import DAMPINGS, damped
from stochlin.applications.separation.searches import Required, least
from stochlin.applications.separation.variables import VARIABLES
from stochlin.models.arguments import Metres, checked
from stochlin.models.grounds import Ground
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.parameters import Model
from stochlin.models.rules.effective_properties import EffectiveRule
from stochlin.models.structures import Structure
from stochlin.solver.tables import labels
from stochlin.solver.tables.cells import over_cells

CLOSELY = np.linspace(0, DAMPINGS[-1], 41)  # added damping ratios for bilinear structures
SIDES: Mapping[str, tuple[float, float]] = {
    "both": (1.0, 1.0),
    "structure 1": (1.0, 0.0),
    "structure 2": (0.0, 1.0),
}
DAMPED, BY_DAMPING = "damped", "added_damping"
LEAST = "least_added_damping"
CURVES = ("critical_gap", "separation", "rho_estimate", *(f"pseudo_energy_radius_{n}" for n in (1, 2)))
# Other long names, since the gap is required by one motion or estimated from it.
OF_RECORD = {
    LEAST: ("1", "least damping ratio to be added, by the energy radii and eq. (3)"),
    f"{LEAST}_recorded": ("1", "least damping ratio to be added, by the motion itself"),
    f"{LEAST}_difference": ("1", "least damping ratio by the energy radii less that by the motion"),
}


@checked
def damping_for_gap(
    record: Records,
    first: OscillatorOnRecord,
    second: OscillatorOnRecord,
    gap: Metres,
    method: Method = WHITE_NOISE,
    *,
    rule: str | EffectiveRule = "iwan_1980",
    ground: Ground | None = None,
    closure: str = "gaussian",
) -> xr.Dataset:
    """Least supplemental damping with which a gap is sufficient in a recorded motion.

    It is computed in two ways: by the energy approach of the paper, that is eq. (3) with the pseudo
    energy radii of the damped structures and a correlation by eq. (4) or another estimate; and by
    integration of the response to the record.

    Parameters
    ----------
    record, first, second
        As in `energy_gap`.
    gap : float
        Existing gap [m], positive.
    method, rule, ground, closure
        As in `energy_gap`, for the correlation.

    Returns
    -------
    xarray.Dataset
        Over ``damped``, the structures with added damping (``"both"`` with the same ratio,
        ``"structure 1"`` or ``"structure 2"``): ``least_added_damping`` [-] by the energy approach,
        ``least_added_damping_recorded`` [-] by integration of the response, and
        ``least_added_damping_difference`` [-], the first minus the second. They are 0 if the gap is
        sufficient without added damping, and NaN if it is not sufficient up to 0.4. Over ``damped`` and
        ``added_damping``, the curves from which they are found: ``critical_gap``, ``separation``,
        ``pseudo_energy_radius_1`` and ``_2`` [m] and ``rho_estimate`` [-]. Several records add the
        dimension ``record``. ``status``.

    Raises
    ------
    ValueError, TypeError
        If the gap is not positive; otherwise as in `energy_gap`.

    Notes
    -----
    The required gap need not decrease with added damping: in a single record two structures may move out
    of phase, and damping added to one of two equal buildings causes a relative displacement. The least
    damping is the first sufficient value in steps of 0.01 (0.05 for laws other than the bilinear one),
    refined between two steps. A somewhat larger value may not be sufficient again; this is shown by the
    curves over ``added_damping``.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (1) to (4), and for supplemental energy dissipation.

    Examples
    --------
    >>> import numpy as np, xarray as xr, stochlin as sl
    >>> time = 0.02 * np.arange(1000)
    >>> record = xr.DataArray(np.sin(5 * time), dims="time", coords={"time": time})
    >>> soft, stiff = sl.Bilinear(period=1.1, damping=0.05), sl.Bilinear(period=0.9, damping=0.05)
    >>> table = sl.damping_for_gap(record, soft, stiff, gap=0.04)
    >>> bool(0 < table.least_added_damping.sel(damped="both") < 0.4)
    True
    """
    estimate = RhoEstimate(method, rule, ground, closure)
    estimate.check(first, second)
    motions = checked_motions(record)
    models: dict[str, Model] = {"first": first, "second": second}
    models |= {} if ground is None else {"ground": ground}
    records = record.values() if isinstance(record, Mapping) else record
    tables = [
        over_cells(partial(_of_one, record=recorded, gap=gap, estimate=estimate), models)
        for recorded in ([records] if isinstance(records, xr.DataArray) else records)
    ]
    table = tables[0]
    if motions.names is not None:
        names = xr.DataArray(motions.names, dims=RECORD, attrs={"long_name": "record"})
        kept: dict[str, Any] = {"compat": "override", "combine_attrs": "override", "join": "outer"}
        table = xr.concat(tables, names.rename(RECORD), data_vars="all", coords="minimal", **kept)
    table = table.assign_attrs(
        gap_m=float(gap),
        searched=f"added damping to {DAMPINGS[-1]:g}, the first that is enough",
        records=motions.describe(),
    )
    return labels.with_run_information(
        labels.label(table, {**VARIABLES, **OF_RECORD}),
        "Least added damping for a gap in recorded motions",
        f"damping_for_gap(gap={gap:g}, {estimate.told})",
        models,
    )


def damped_gaps(
    first: Structure, second: Structure, record: xr.DataArray, estimate: RhoEstimate
) -> xr.Dataset:
    """`energy_gap` of two structures with scalar parameters, over ``damped`` and ``added_damping``."""
    where = xr.DataArray(list(SIDES), dims=DAMPED, attrs={"long_name": "where damping is added"})
    bilinear = isinstance(first, Bilinear) and isinstance(second, Bilinear)
    added = labels.axis(BY_DAMPING, "added damping ratio", CLOSELY if bilinear else DAMPINGS)
    shares = np.array(list(SIDES.values()))
    damped_1, damped_2 = (
        damped(structure, xr.DataArray(share, {DAMPED: where.values}, DAMPED) * added)
        for structure, share in zip((first, second), shares.T, strict=True)
    )
    table = estimated_gap(damped_1, damped_2, record, estimate).transpose(DAMPED, BY_DAMPING)
    table[DAMPED].attrs.update(where.attrs)
    return table


def _of_one(
    first: Structure,
    second: Structure,
    ground: Ground | None = None,
    *,
    record: xr.DataArray,
    gap: float,
    estimate: RhoEstimate,
) -> xr.Dataset:
    """The result of `damping_for_gap` for one record and models with scalar parameters."""
    estimate = estimate._replace(ground=ground)
    scan = damped_gaps(first, second, record, estimate)

    def least_of(n: int, shares: tuple[float, float], name: str) -> float:
        tried = scan[BY_DAMPING].values.tolist()
        known = dict(zip(tried, scan[name].values[n].tolist(), strict=True))

        def needed(added: float) -> float:
            left, right = (damped(s, x * added) for s, x in zip((first, second), shares, strict=True))
            return float(estimated_gap(left, right, record, estimate)[name])

        return least(Required(needed, gap, known=known), list(known)).value

    added = [
        xr.DataArray([least_of(n, shares, name) for n, shares in enumerate(SIDES.values())], dims=DAMPED)
        for name in ("critical_gap", "separation")
    ]
    return scan[[*CURVES, "status"]].assign(
        {LEAST: added[0], f"{LEAST}_recorded": added[1], f"{LEAST}_difference": added[0] - added[1]}
    )
