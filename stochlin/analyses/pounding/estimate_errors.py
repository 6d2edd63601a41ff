"""Error of the estimates from energies, compared with the pounding response in many motions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import xarray as xr

from stochlin.analyses.pounding.ensembles import checked_ensemble
from stochlin.analyses.pounding.estimates import pounding_estimate_row
from stochlin.analyses.pounding.rows import (
    BetweenBuildings,
    Standing,
    build_row,
    checked_buildings,
    checked_gaps,
)
from stochlin.analyses.pounding.runs import (
    jobs_of,
    paces_of,
    responses,
    successful,
)
from stochlin.analyses.pounding.variables import VARIABLES
from stochlin.analyses.records.cells import Records
from stochlin.analyses.simulation.finite_motions import share_interval
from stochlin.analyses.tables import labels
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress, in_order
from stochlin.kernels.pounding import impacts
from stochlin.kernels.pounding.run import SAMPLES, RowResponse, StepCounts
from stochlin.kernels.records.runs import SampledMotion
from stochlin.models.arguments import Points, checked
from stochlin.models.buildings import ModalBuilding, MultistoreyBuilding
from stochlin.models.parameters import Model
from stochlin.models.systems import AnyStructure, first_mode

ESTIMATES = {"one hit": "largest_radius_amplification", "chain": "chain_radius_amplification"}
TRUTHS = {"displacement": "peak_amplification", "energy radius": "peak_radius_amplification"}
FEWEST = 2  # smallest number of motions for a standard deviation


@checked
def pounding_estimate_error(
    structures: Sequence[AnyStructure],
    gaps: npt.ArrayLike,
    contact: BetweenBuildings,
    motion: Records,
    *,
    points: Points = 91,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Error of the energy estimate compared with `pound` in the same motions.

    In every motion `pounding_estimate_row` is applied to the largest energy radii of the structures
    without neighbours, ``max sqrt(q^2 + (q'/w)^2)`` with the displacement ``q`` and the circular
    frequency ``w`` of the first mode. The estimated amplification is compared with that of the largest
    displacement and that of the largest energy radius in `pound`, with pounding over without.

    Parameters
    ----------
    structures, gaps, contact
        As in `pound`, at least two structures.
    motion : xarray.DataArray, or list or mapping of them
        Two or more motions, as in `pound`.
    points : int
        As in `pounding_estimate`.
    progress : callable, optional
        Called with the share of the motions that is done.

    Returns
    -------
    xarray.Dataset
        Over ``path`` or ``record`` and ``structure``: ``radius_alone`` [m], ``hits`` (the number of
        impacts on the structure), ``peak_amplification`` [-] and ``peak_radius_amplification`` [-] by
        pounding, and the estimates ``largest_radius_amplification`` and
        ``chain_radius_amplification`` [-]. Over ``structure``: ``motions_with_hits``. Over
        ``structure``, ``of`` (displacement or energy radius) and ``estimate`` (one hit or chain), for
        the motions in which the structure has an impact: ``estimate_bias`` [-], the mean of
        ``ln(estimate/computed)``, with ``estimate_bias_standard_error``; ``estimate_scatter`` [-], its
        standard deviation; ``exceeded_probability`` [-], the share of motions in which the computed
        value exceeds the estimate, with its 95 % interval ``_lower`` and ``_upper``. Statistics are NaN
        if too few motions have an impact.

    Raises
    ------
    ValueError, TypeError, ArithmeticError
        As in `pound`, also if any motion fails, or if there are fewer than two structures or motions.

    Notes
    -----
    Energy radii are taken at the samples of the motion, so that they are slightly too small for coarse
    samples.

    The table shows measured errors for the largest displacement, from 60 random rows of each kind, each
    in two motions of 12 s on firm ground, with contacts of ``e`` = 0.65 and strengths of a quarter of
    the elastic demand (``benchmarks/pounding_estimates.py``):

    ====================================  =====  =======  ========
    structures, estimate                  bias   scatter  exceeded
    ====================================  =====  =======  ========
    two oscillators, elastic, one hit     0.26   0.25     13 %
    two oscillators, yielding, one hit    0.20   0.24     18 %
    two with storeys, elastic, one hit    0.35   0.21     0 %
    two with storeys, yielding, one hit   0.26   0.16     1 %
    three oscillators, elastic, one hit   0.32   0.28     9 %
    three oscillators, elastic, chain     0.42   0.28     5 %
    three oscillators, yielding, one hit  0.28   0.29     14 %
    three oscillators, yielding, chain    0.38   0.29     6 %
    ====================================  =====  =======  ========

    The standard error of the bias is 0.01 to 0.02, that of the exceeded share 1 to 3 %.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (1) and (13); Clopper and Pearson (1934), Biometrika 26, for
    the intervals of probabilities.

    Examples
    --------
    >>> import stochlin as sl
    >>> soft = sl.Bilinear(period=1.2, damping=0.05, mass=2e5)
    >>> stiff = sl.Bilinear(period=0.6, damping=0.05, mass=4e5)
    >>> motions = sl.simulated_motions(sl.named_ground("firm", intensity=0.01), 8.0, paths=12)
    >>> contact = sl.Kelvin(1e8, restitution=0.65)
    >>> error = sl.pounding_estimate_error([soft, stiff], 0.02, contact, motions)
    >>> error.estimate_bias.sel(of="displacement", estimate="one hit").round(2).values
    array([0.19, 0.33])
    """
    row_of = checked_buildings(structures)
    spaces = checked_gaps(gaps, len(row_of))
    if len(row_of) < 2:
        raise ValueError("structures has one building; allowed: at least two, which can meet")
    ensemble = checked_ensemble(motion)
    grounds, over = ensemble.motions.grounds, ensemble.over
    if over is None or len(grounds) < FEWEST:
        raise ValueError(
            "motion: only one is given; allowed: two or more, over path or as a list of records, "
            "since an error needs many"
        )
    standing = build_row(row_of, spaces, contact, ())
    paces = paces_of(standing, contact, grounds)

    def changes(number: int) -> dict[str, Array]:
        return _changes(standing, grounds[number], paces[number])

    each = list(in_order(changes, len(grounds), progress))
    dims = over, "structure"
    table = xr.Dataset({name: (dims, np.array([values[name] for values in each])) for name in each[0]})
    radii = [table.radius_alone.isel(structure=n) for n in range(len(row_of))]
    estimate = pounding_estimate_row(row_of, spaces, contact, radii, points=points)
    table = table.assign({name: estimate[name].transpose(*dims) for name in ESTIMATES.values()})
    table = table.assign(_statistics(table, over)).assign_coords(structure=estimate.structure)
    if ensemble.labels is not None:
        table = table.assign_coords({over: ensemble.labels})
    models: dict[str, Model] = {f"structure_{n}": each for n, each in enumerate(row_of, start=1)}
    return labels.with_run_information(
        labels.label(table, VARIABLES).assign_attrs(gaps=spaces.tolist(), motion=ensemble.describe()),
        "Error of the energy estimate of pounding",
        f"pounding_estimate_error(points={points})",
        models | {"contact": contact},
    )


def _changes(standing: Standing, ground: SampledMotion, pace: StepCounts) -> dict[str, Array]:
    """Changes of peaks and energy radii by pounding in one motion, and numbers of impacts."""
    jobs = jobs_of(standing, ground, pace)
    both = successful([response for job in jobs for response in responses(standing, [job], SAMPLES)])
    first = standing.first[:-1]
    peak, peak_alone = (np.maximum.reduceat(each.peaks, first) for each in both)
    radius, radius_alone = (_radii(standing, each) for each in both)
    where = standing.left[both[0].impacts[:, impacts.CONTACT].astype(np.int64)]
    return {
        "hits": np.bincount(np.append(where, where + 1), minlength=first.size),
        "radius_alone": radius_alone,
        "peak_amplification": peak / peak_alone,
        "peak_radius_amplification": radius / radius_alone,
    }


def _radii(standing: Standing, response: RowResponse) -> Array:
    """Largest energy radius of the first mode of each structure at the samples [m], (structures,)."""
    at, mass, radii = response.at, standing.row.parts.mass, []
    u, v = response.history[:, at.q : at.v], response.history[:, at.v : at.z]
    first = standing.arrangement.first_coordinate
    for b, structure in enumerate(standing.structures):
        own = slice(first[b], first[b + 1])
        shares = np.ones(1)
        if isinstance(structure, ModalBuilding):
            shares = np.eye(structure.modes)[structure.leading]
        elif isinstance(structure, MultistoreyBuilding):
            moves = structure.first_mode_moves().to_numpy()
            shares = mass[own] * moves / (mass[own] @ moves**2)
        q, rate = (values[:, own] @ shares for values in (u, v))
        w = 2 * np.pi / float(first_mode(structure).arrays()["period"])
        radii.append(np.hypot(q, rate / w).max())
    return np.array(radii)


def _statistics(table: xr.Dataset, over: str) -> xr.Dataset:
    """Bias, scatter and exceeded share of the estimates, over the motions with impacts."""
    of = xr.DataArray(list(TRUTHS), dims="of", attrs={"long_name": "what grows by pounding"})
    by = xr.DataArray(list(ESTIMATES), dims="estimate", attrs={"long_name": "estimate from energies"})
    truth = xr.concat([table[name] for name in TRUTHS.values()], "of").assign_coords(of=of)
    estimate = xr.concat([table[name] for name in ESTIMATES.values()], "estimate").assign_coords(
        estimate=by
    )
    ratio = xr.ufuncs.log(estimate / truth).where(table.hits > 0)
    count = (table.hits > 0).sum(over)
    bias = ratio.mean(over)
    freedom = (count - 1).where(count >= FEWEST)  # `std` warns of cells with fewer motions
    scatter = np.sqrt(((ratio - bias) ** 2).sum(over) / freedom)
    more = (ratio < 0).sum(over)
    lower, upper = share_interval(more.to_numpy(), count.broadcast_like(more).to_numpy())
    return xr.Dataset(
        {
            "motions_with_hits": count,
            "estimate_bias": bias,
            "estimate_bias_standard_error": scatter / np.sqrt(count),
            "estimate_scatter": scatter,
            "exceeded_probability": (more / count.where(count > 0)),
            "exceeded_probability_lower": more.copy(data=lower),
            "exceeded_probability_upper": more.copy(data=upper),
        }
    )
