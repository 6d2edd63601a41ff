"""Results of a case with storeys, by linearization, and its simulated correlation."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
import xarray as xr

from stochlin.analyses.cases.case import Case
from stochlin.analyses.correlation.correlation import rho_white_noise
from stochlin.analyses.correlation.variables import VARIABLES as OF_PAIRS
from stochlin.analyses.explorer.pair import (
    elastic_periods,
    heights_of,
    neighbours_of,
    ratio_of,
    structures_of,
    with_period,
)
from stochlin.analyses.linearization.systems.solution import SystemSolution
from stochlin.analyses.linearization.systems.systems import equations_of, solved
from stochlin.analyses.separation.pairs import peak_quantile
from stochlin.analyses.separation.rules import (
    EQ_3,
    Rule,
    code_rules,
    equation_3_rule,
    linearized_rule,
)
from stochlin.analyses.separation.storeys import (
    correlation_in,
    correlation_of,
    of_storeys,
    stationary_motions,
    weights,
)
from stochlin.analyses.simulation.views import meeting_heights
from stochlin.analyses.tables import labels
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.linearization.systems.response import StationaryResponse
from stochlin.models.parameters import Parameter
from stochlin.models.systems import (
    AnyStructure,
    Arrangement,
    arrangement_of,
    elastic_period,
    first_mode,
)

RATIO = "period_ratio", "ratio of the periods, T2/T1"
LINEARIZED_PEAKS = "peaks of linearization, storey by storey"


class ResponseAtContacts(NamedTuple):
    """Linearized response of both structures, and their displacements at the heights of contact."""

    motion: StationaryResponse
    heights: Array  # [m], from the ground up to the lower roof
    one: Array  # (heights, coordinates) factors that give displacements from the coordinates
    two: Array  # (heights, coordinates)


class Alone(NamedTuple):
    """Linearized structure alone; without links it does not depend on its neighbour."""

    structure: AnyStructure
    solution: SystemSolution


@lru_cache(maxsize=8)
def in_motion(case: Case) -> ResponseAtContacts:
    """Response of both structures with the periods of the case."""
    equations_of(structures_of(case), case.ground, ())  # raises if a storey has no stationary response
    return _together(case, _alone(case, structures_of(case)[0]), _alone(case, structures_of(case)[1]))


def _alone(case: Case, structure: AnyStructure) -> Alone:
    return Alone(structure, solved(equations_of([structure], case.ground, ())))


def _together(case: Case, first: Alone, second: Alone) -> ResponseAtContacts:
    both = first, second
    equations = equations_of([alone.structure for alone in both], case.ground, ())
    c_eq, k_eq = (
        np.concatenate([getattr(alone.solution, name) for alone in both], axis=1)
        for name in ("c_eq", "k_eq")
    )
    own = equations.yields & ((c_eq != -1) | (k_eq != 0))[0]
    heights = meeting_heights(*equations.arrangement.stacks)
    arrangement = equations.arrangement
    factors_1, factors_2 = (
        _weights(arrangement, number, heights) @ arrangement.storeys.shapes for number in (0, 1)
    )
    return ResponseAtContacts(
        StationaryResponse(equations.state_space(c_eq, k_eq, own)), heights, factors_1, factors_2
    )


def _weights(arrangement: Arrangement, number: int, heights: Array) -> Array:
    """Factors that give displacements from those of all floors (heights, floors)."""
    return np.array([weights(arrangement, number, height) for height in heights])


def displacement_densities(case: Case, frequency: Array) -> tuple[Array, Array, float]:
    """Two-sided PSD [m^2 s] of both displacements at the lower roof, and its height [m]."""
    motion, heights, factors_1, factors_2 = in_motion(case)
    ((of_1, of_2),) = motion.spectral_density(np.stack([factors_1[-1], factors_2[-1]]), frequency)
    return of_1, of_2, float(heights[-1])


def correlation(case: Case, ratios: Array, progress: Progress | None) -> xr.Dataset:
    """Correlation over the ratio of the first periods, for scaled stiffnesses of building 2.

    The variables are ``rho_linearized`` at the lower roof and ``rho_white_noise`` of the first modes.
    """
    _ = in_motion(case)  # raises if the case itself has no stationary response
    first, correlations = _alone(case, structures_of(case)[0]), []
    period_1, _ = elastic_periods(case)
    for done, ratio in enumerate(ratios, start=1):
        try:
            second = _alone(case, with_period(structures_of(case)[1], period_1 * float(ratio)))
            motion, _, factors_1, factors_2 = _together(case, first, second)
            correlations.append(float(correlation_of(motion, factors_1[-1:], factors_2[-1:])[0]))
        except (ArithmeticError, ValueError):  # also if P-delta effects take all stiffness
            correlations.append(np.nan)
        if progress is not None:
            progress(done / len(ratios))
    ratio = labels.axis(*RATIO, ratios)
    rho = xr.DataArray(correlations, dims=ratio.dims, coords=ratio.coords)
    of_modes = _of_first_modes(case, period_1 * ratio)
    table = xr.Dataset(
        {
            "status": labels.status_where(rho.notnull()),
            "rho_white_noise": of_modes.drop_attrs(),
            "rho_linearized": rho,
        }
    )
    return table.assign_attrs(height_m=float(in_motion(case).heights[-1]))


def _of_first_modes(case: Case, period_2: Parameter) -> xr.DataArray:
    """Correlation of the first modes by eq. (4)."""
    first, second = structures_of(case)
    ratios = (first_mode(structure).damping for structure in (first, second))
    return rho_white_noise(elastic_period(first), period_2, *ratios).rho


def rules(case: Case, seconds: float) -> tuple[list[Rule], Array]:
    """Rules that need no simulation, with peaks by linearization, and the heights of contact [m]."""
    motion, heights, factors_1, factors_2 = in_motion(case)
    count, dims = len(heights), ("building", "height")
    moments = [
        m[0]
        for m in motion.spectral_moments(np.concatenate([factors_1, factors_2, factors_1 - factors_2]))
    ]
    both = tuple(xr.DataArray(m[: 2 * count].reshape(2, count), dims=dims) for m in moments)
    peaks = peaks_of(case, both, seconds)
    apart = [m[2 * count :] for m in moments]
    texts = {"mark": "C", "assumptions": f"{EQ_3}; {LINEARIZED_PEAKS}"}
    of_modes = _of_first_modes(case, elastic_periods(case)[1]).values
    neighbours = of_storeys(neighbours_of(case), structures_of(case), heights_of(case))
    listed = [
        equation_3_rule(peaks, "eq_3_white_noise", of_modes, **texts),
        equation_3_rule(peaks, "eq_3_linearized", correlation_of(motion, factors_1, factors_2), **texts),
        linearized_rule(tuple(apart), seconds, case.confidence, case.scatter),
        *code_rules(peaks, (heights, heights), neighbours, case.of_codes, dict(case.numbers)),
    ]
    return listed, heights


def peaks_of(case: Case, moments: tuple[xr.DataArray, ...], seconds: float) -> Array:
    """Peak displacements [m] that Gaussian responses do not exceed with the confidence of the case."""
    peaks: Array = peak_quantile(moments, seconds, case.confidence, 2).to_numpy()
    if not np.isfinite(peaks).all():
        raise ValueError(
            f"duration = {case.duration:g} s is too short for a peak at these periods; allowed: "
            "several periods or more"
        )
    return peaks


def simulated_correlation(case: Case, progress: Progress | None) -> xr.Dataset:
    """Simulated correlation at the lower roof, only for the period ratio of the case.

    Between two floors, the standard error is interpolated.
    """
    arrangement, heights = arrangement_of(structures_of(case)), in_motion(case).heights
    motions = stationary_motions(structures_of(case), case.ground, case.duration, case.seed, progress)
    factors_1, factors_2 = (_weights(arrangement, number, heights[-1:]) for number in (0, 1))
    error = factors_1 @ motions.rho_standard_error.values @ factors_2.T
    ratio = labels.axis(*RATIO, [ratio_of(case)])
    table = xr.Dataset(
        {
            "rho": ("period_ratio", correlation_in(motions, factors_1, factors_2)),
            "rho_standard_error": ("period_ratio", error[0]),
        },
        coords=ratio.coords,
        attrs={name: motions.attrs[name] for name in ("title", "history", "paths", "seed")},
    )
    return labels.label(table, OF_PAIRS).assign_attrs(height_m=float(heights[-1]))
