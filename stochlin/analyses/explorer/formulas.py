"""Results of a case by formula: spectra, correlation, gaps by rule, probability of pounding.

All raise an ArithmeticError if linearization fails. With storeys the correlation takes some time, and
the probability more.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.analyses.cases.case import Case
from stochlin.analyses.cases.files.known import name_of
from stochlin.analyses.cases.separation import AROUND, periods_of
from stochlin.analyses.correlation.correlation import rho_white_noise
from stochlin.analyses.correlation.drift.pairs import correlation_with_drift
from stochlin.analyses.correlation.linearized import pairs_of_solved
from stochlin.analyses.correlation.variables import VARIABLES as OF_PAIRS
from stochlin.analyses.explorer import storeys
from stochlin.analyses.explorer.pair import (
    elastic_periods,
    gap_of,
    has_storeys,
    heights_of,
    motion_of,
    neighbours_of,
    ratio_of,
    structures_of,
    with_period,
)
from stochlin.analyses.linearization.equivalent_systems import INTERNAL, solve_structure
from stochlin.analyses.linearization.peaks import relative_moments, response_moments
from stochlin.analyses.linearization.strength import strength_in_metres
from stochlin.analyses.linearization.tolerance import USUAL
from stochlin.analyses.probability.cells import PairTable, Solved
from stochlin.analyses.probability.probability import with_samples
from stochlin.analyses.records.gaps import recorded_gap
from stochlin.analyses.separation.rules import (
    EQ_3,
    Rule,
    code_rules,
    equation_3_rule,
    linearized_rule,
)
from stochlin.analyses.separation.separation import TEXTS, gaps_by_height
from stochlin.analyses.separation.variables import VARIABLES as OF_GAPS
from stochlin.analyses.tables import labels
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.linearization.covariance import EquivalentSystem
from stochlin.models.envelopes import strong_seconds
from stochlin.models.grounds import Ground
from stochlin.models.parameters import Model
from stochlin.models.structures import DRIFT, Structure

FREQUENCIES = 301
_EVEN = np.linspace(-1, 1, 49)
RATIOS = 4.0 ** (np.sign(_EVEN) * np.abs(_EVEN) ** 1.5)  # T2/T1, denser around 1
RATIOS_OF_STOREYS = RATIOS[::2]  # fewer, since each of them takes some time
RHO = {
    "rho_white_noise": "eq. (4)",
    "rho_linearized": "linearization, Gaussian closure",
    "rho_drift": "linearization, drift closure",
}
LINEARIZED_PEAKS = "peaks of linearization"
DRIFTED_PEAKS = "peaks by standard deviations of the drift closure and peak factors of linearization"

_solved_pairs: dict[str, Solved] = {}  # of the last probabilities
MOST_PAIRS = 4
OF_PAIR = ("site", "motion", "building_1", "building_2")  # tables on which linearization depends


class _SolvedPair(NamedTuple):
    """Linearized buildings of a case; the second one over ``period_ratio``."""

    structures: tuple[Structure, Structure]
    gaussian: tuple[xr.Dataset, xr.Dataset]
    drift: tuple[xr.Dataset, xr.Dataset]
    own: int  # index of the period ratio of the case

    def single(self, sides: tuple[xr.Dataset, xr.Dataset]) -> list[xr.Dataset]:
        """Both buildings with the periods of the case."""
        return [sides[0], sides[1].isel(period_ratio=self.own, drop=True)]


@lru_cache(maxsize=8)  # three results of a case use it
def _solved(case: Case) -> _SolvedPair:
    ratio = ratio_of(case)
    ratios = np.union1d(RATIOS, ratio)
    own = int(np.searchsorted(ratios, ratio))
    first_structure: Any = structures_of(case)[0]
    structures = first_structure, swept(case, ratios)
    ground = case.ground
    first, second, first_drifting, second_drifting = (
        solve_structure(structure, ground, closure, USUAL)
        for closure in ("gaussian", DRIFT)
        for structure in structures
    )
    pair = _SolvedPair(structures, (first, second), (first_drifting, second_drifting), own)
    for side, structure in zip(pair.single(pair.gaussian), structures_of(case), strict=True):
        labels.raise_if_lone_failure(side, structure.describe())
    return pair


def spectra(case: Case) -> xr.Dataset:
    """Power spectral densities of the ground and of the linearized displacements of both buildings.

    Over ``frequency`` [rad/s], with the coordinate ``period`` [s]: the two-sided densities
    ``psd_ground`` [m^2/s^3] and ``displacement_psd_1`` and ``_2`` [m^2 s]. With storeys they are those
    at the lower roof, whose height is the attribute ``height_m``.
    """
    ground = case.ground
    periods = [*elastic_periods(case), *periods_of(ground)]
    low, high = min(periods) / AROUND, max(periods) * AROUND
    # The periods themselves are points of the grid, because resonances are narrow.
    period = np.unique(np.concatenate([np.geomspace(low, high, FREQUENCIES), periods]))[::-1]
    frequency = 2 * np.pi / period
    density = ground.psd(frequency)
    table = density.rename("psd_ground").to_dataset()
    if has_storeys(case):
        *responses, height = storeys.displacement_densities(case, frequency)
        table = table.assign_attrs(height_m=height)
    else:
        responses = _displacement_densities(_solved(case), density.to_numpy(), frequency)
    for number, response in enumerate(responses, start=1):
        long_name = f"two-sided PSD of the displacement, building {number}, linearized"
        attrs = {"units": "m^2 s", "long_name": long_name}
        table[f"displacement_psd_{number}"] = ("frequency", response, attrs)
    attrs = {"units": "s", "long_name": "period"}
    table = table.assign_coords(period=("frequency", period, attrs))
    table.frequency.attrs = {"units": "rad/s", "long_name": "circular frequency"}
    return _described(case, table, "Spectra of ground and displacements", "spectra")


def _displacement_densities(pair: _SolvedPair, ground: Array, frequency: Array) -> list[Array]:
    systems = [
        EquivalentSystem(*(side[name].to_numpy() for name in INTERNAL[:5]))
        for side in pair.single(pair.gaussian)
    ]
    return [ground * system.transfer_squared(frequency) for system in systems]


def correlation(case: Case, progress: Progress | None = None) -> xr.Dataset:
    """Correlation over the ratio of the periods, by eq. (4) and by linearization.

    It is over ``period_ratio`` [-], ``T2/T1`` for a fixed period of building 1. The ratio of the case
    is one of its values, and an attribute. For oscillators the dataset has ``rho_white_noise`` [-],
    eq. (4); ``rho_linearized`` [-] by the Gaussian closure; ``rho_drift`` [-] by the drift closure; and
    ``bias``, ``bias_1``, ``bias_2`` and ``caution`` of the Gaussian closure. With storeys it has
    ``rho_white_noise`` of the first modes and ``rho_linearized`` at the lower roof, for scaled
    stiffnesses of building 2. ``progress`` is only called with storeys.
    """
    if not has_storeys(case):
        return _of_oscillators(case)
    ratio = ratio_of(case)
    table = storeys.correlation(case, np.union1d(RATIOS_OF_STOREYS, ratio), progress)
    return _of_ratios(case, table.assign_attrs(period_ratio=ratio))


@lru_cache(maxsize=8)
def _of_oscillators(case: Case) -> xr.Dataset:
    pair, ground = _solved(case), case.ground
    first, second = pair.structures
    sides = list(pair.gaussian)
    table = pairs_of_solved(pair.structures, ground, sides, sides, USUAL)
    arguments = (first.period, second.period, first.damping, second.damping)
    shown = {name: table[name] for name in ("bias", "bias_1", "bias_2", "caution", "status")}
    shown |= {
        "rho_white_noise": rho_white_noise(*arguments).rho.drop_attrs(),
        "rho_linearized": table["rho"],
        "rho_drift": correlation_with_drift(pair.structures, list(pair.drift), ground, USUAL),
    }
    return _of_ratios(case, xr.Dataset(shown, attrs={"period_ratio": ratio_of(case)}))


def _of_ratios(case: Case, table: xr.Dataset) -> xr.Dataset:
    """A table over the period ratio with labels, and a caution as its comment if a building yields."""
    for name, text in RHO.items():
        if name in table:
            table[name].attrs = {"units": "1", "long_name": f"correlation coefficient, {text}"}
    table = labels.label(table, OF_PAIRS)
    if any(structure.yields for structure in structures_of(case)):
        table.attrs["comment"] = labels.CAUTION_PAIR
    return _described(case, table, "Correlation over the ratio of periods", "correlation")


def gap_rules(case: Case) -> xr.Dataset:
    """Gaps by the rules that need no simulation.

    The peaks are standard deviations by the drift closure times peak factors by linearization. The rules
    ``eq_3_linearized`` and ``linearization``, and all rules with storeys, for which there is no drift
    closure, use the Gaussian closure alone. Over ``rule``: ``gap`` [m], NaN if a rule has none, and
    ``rho`` [-], with the coordinates of `separation`; with storeys also ``gap_at_height`` [m] over
    ``height``.
    """
    seconds = strong_seconds(case.duration, case.envelope)
    if has_storeys(case):
        rules, heights = storeys.rules(case, seconds)
        by_height = gaps_by_height([rule.gaps for rule in rules], heights)
        return _of_rules(case, rules, "linearized", by_height)
    return _of_rules(case, _rules(case, seconds), "drift closure")


def _rules(case: Case, seconds: float) -> list[Rule]:
    """Rules for two oscillators; ``seconds`` is the duration of strong shaking."""
    ground, pair = case.ground, _solved(case)
    solved, drifting = pair.single(pair.gaussian), pair.single(pair.drift)
    moments = [response_moments(side, ground) for side in solved]
    both = tuple(xr.concat(parts, "building") for parts in zip(*moments, strict=True))
    peaks = storeys.peaks_of(case, both, seconds)
    drifted = peaks * [
        float(d.displacement_std / s.displacement_std) for d, s in zip(drifting, solved, strict=True)
    ]
    rho = correlation(case).isel(period_ratio=pair.own)
    linear = {"mark": "C", "assumptions": f"{EQ_3}; {LINEARIZED_PEAKS}"}
    drift = {"mark": "C", "assumptions": f"{EQ_3}; {DRIFTED_PEAKS}"}
    return [
        equation_3_rule(drifted[:, None], "eq_3_drift", rho.rho_drift.values, **drift),
        equation_3_rule(drifted[:, None], "eq_3_white_noise", rho.rho_white_noise.values, **drift),
        equation_3_rule(peaks[:, None], "eq_3_linearized", rho.rho_linearized.values, **linear),
        linearized_rule(
            relative_moments(solved[0], solved[1], ground),
            seconds,
            case.confidence,
            case.scatter,
        ),
        *code_rules(
            drifted[:, None], heights_of(case), neighbours_of(case), case.of_codes, dict(case.numbers)
        ),
    ]


def _of_rules(
    case: Case, rules: list[Rule], peaks: str, by_height: xr.Dataset | None = None
) -> xr.Dataset:
    """Dataset of the gaps by all rules; ``peaks`` names the method for the peaks."""
    columns = {name: ("rule", [getattr(rule, name) for rule in rules]) for name in TEXTS}
    table = xr.Dataset(
        {name: ("rule", [getattr(rule, name) for rule in rules]) for name in ("gap", "rho")},
        coords={"rule": ("rule", [rule.name for rule in rules]), **columns},
    )
    if by_height is not None:
        table = table.merge(by_height)
        table.height.attrs = {"units": "m", "long_name": "height above the ground"}
    for name, text in TEXTS.items():
        table[name].attrs["long_name"] = text
    table = table.assign_attrs(peaks=peaks, gap_m=gap_of(case), confidence=case.confidence)
    table = labels.label(table, OF_GAPS)
    return _described(case, table, "Gap by rules without simulation", "gap_rules")


def probability(case: Case, progress: Progress | None = None) -> xr.Dataset:
    """Dataset of `pounding_probability` by formula alone.

    What linearization has found is kept; another gap or confidence needs nothing else.
    """

    def solve(pairs: PairTable, ground: Ground, progress: Progress | None) -> Solved:
        key = name_of("pair", [case.whole.values[table] for table in OF_PAIR])
        if key not in _solved_pairs:
            solution = pairs.solve(ground, progress)
            while len(_solved_pairs) >= MOST_PAIRS:
                del _solved_pairs[next(iter(_solved_pairs))]
            _solved_pairs[key] = solution
        return _solved_pairs[key]

    first, second = structures_of(case)
    motions = motion_of(case) | {"paths": 0, "seed": 0, "progress": progress, "solve": solve}
    return with_samples(first, second, case.ground, gap_of(case), **motions)


def recorded(case: Case) -> xr.Dataset:
    """Dataset of `recorded_gap` for the records of the file, with the existing gap as an attribute.

    Reduction factors refer to the ground of the case.
    """
    if not case.records:
        raise ValueError("the case has no record; allowed: a case file with [[site.records]]")
    ground = case.ground
    first, second = (strength_in_metres(structure, ground) for structure in structures_of(case))
    return recorded_gap(first, second, dict(case.records)).assign_attrs(gap_m=gap_of(case))


def swept(case: Case, ratios: Array) -> Structure:
    """Building 2 over ``period_ratio``, the ratios of its period to that of building 1."""
    ratio = labels.axis("period_ratio", "ratio of the periods, T2/T1", ratios)
    other: Any = with_period(structures_of(case)[1], elastic_periods(case)[0] * ratio)
    return other


def models_of(case: Case) -> dict[str, Model]:
    """Models of a case by their names in the attributes of a dataset."""
    first, second = structures_of(case)
    envelope = case.envelope
    models = {"first": first, "second": second, "ground": case.ground}
    return models | ({"envelope": envelope} if envelope else {})


def _described(case: Case, table: xr.Dataset, title: str, call: str) -> xr.Dataset:
    ground = case.ground
    return labels.with_run_information(table, f"{title}, {ground.name} ground", call, models_of(case))
