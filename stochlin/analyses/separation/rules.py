"""All rules for the separation of two buildings, or the set-back of one, from simulated peaks."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr

from stochlin.analyses.correlation.effective import rho_effective
from stochlin.analyses.separation.code_gaps import code_gaps
from stochlin.analyses.separation.critical_gap import equation_3
from stochlin.analyses.separation.pairs import SHORT, PairInMotion, peak_quantile
from stochlin.kernels.basics.arrays import Array
from stochlin.models.rules.codes import CODE_RULES, Neighbours
from stochlin.models.rules.effective_properties import effective_rule, effective_rule_names
from stochlin.models.rules.peak_factors import PEAK_FACTORS
from stochlin.models.structures import DRIFT, GAUSSIAN

EQ_3 = "eq. (3) with the peaks of both structures"
COMBINES = "needs a second building: eq. (3) combines the peaks of two"
CQC, SPECTRUM = "cqc", "response_spectrum"  # a rule, and its kind
ELASTIC_MODES = (
    "CQC over all elastic modes, with their peaks and correlations on the ground; what yields moves as "
    "far as if it were elastic"
)
SOLVED, PAPER = ("simulated", "linearized", "drift"), "paper"


@dataclass(frozen=True)
class Rule:
    """A row of the table: the gap of a rule at each height at which the buildings could meet."""

    name: str
    kind: str
    gaps: Array  # (heights,) [m], NaN if not available
    rhos: Array | None = None  # (heights,)
    family: str = ""  # for a building code only
    reference: str = ""
    mark: str = ""
    assumptions: str = ""
    missing: str = ""
    judged: bool = True  # False for a code's combination of simulated peaks

    @property
    def gap(self) -> float:
        """Largest gap over the heights [m], which is required over the whole height."""
        return float(np.max(self.gaps))

    @property
    def rho(self) -> float:
        """Correlation at the height where the gap is largest [-]; NaN if the rule has none."""
        known = self.rhos is not None and not np.isnan(self.gap)
        return float(self.rhos[int(np.argmax(self.gaps))]) if known else np.nan  # type: ignore[index]


def all_rules(
    pair: PairInMotion,
    neighbours: Neighbours,
    site: Mapping[str, Any],
    unverified: bool,
    numbers: Mapping[str, float] | None,
) -> list[Rule]:
    """All rules, including those that have no gap because something is missing."""
    return [
        *_with_correlations(pair, effective_rule_names(unverified)),
        _of_modes(pair),
        _linearized(pair),
        *code_rules(pair.peaks, pair.code_heights, neighbours, site, numbers),
    ]


def _with_correlations(pair: PairInMotion, effective: Sequence[str]) -> list[Rule]:
    """Eq. (3) with the correlation by each method; for one building alone there is no gap."""
    if pair.alone:
        names = (f"eq_3_{name}" for name in (*SOLVED, PAPER, *effective))
        return [Rule(name, "equation_3", _nothing(pair), missing=COMBINES) for name in names]
    ways: list[tuple[str, Callable[[], Array]]] = [
        # The simulation raises an error for structures that yield so rarely that it would take hours.
        ("stationary simulation", pair.simulated_rho),
        ("linearization", lambda: pair.linearized_rho(GAUSSIAN)),
        ("linearization with plastic drift", lambda: pair.linearized_rho(DRIFT)),
    ]
    return [
        *(_with_solved_rho(pair, name, *way) for name, way in zip(SOLVED, ways, strict=True)),
        _of_paper(pair),
        *(_with_effective_rho(pair, name) for name in effective),
    ]


def equation_3_rule(peaks: Array, name: str, rhos: Array, **texts: Any) -> Rule:
    """Eq. (3) with these peaks (2, heights) [m] and correlations (heights,)."""
    gaps = np.where(np.isposinf(peaks).any(axis=0), np.inf, equation_3(peaks[0], peaks[1], rhos))
    return Rule(name, "equation_3", gaps, np.broadcast_to(rhos, gaps.shape), **texts)


def _with_solved_rho(pair: PairInMotion, name: str, source: str, rho: Callable[[], Array]) -> Rule:
    texts: Any = {"mark": "C", "assumptions": f"{EQ_3}; rho of {source}"}
    return _solved_rule(pair, name, lambda: (pair.peaks, rho()), **texts)


def _of_paper(pair: PairInMotion) -> Rule:
    """Eq. (3) as the paper uses it, with ``rho`` of Fig. 5a and elastic peaks times ``D`` of Fig. 5b."""
    return _solved_rule(
        pair,
        PAPER,
        lambda: (pair.amplified_peaks(), pair.linearized_rho(GAUSSIAN)),
        reference="Valles-Mattox and Reinhorn (1996), eq. (3) and Fig. 5",
        mark="P",
        assumptions="eq. (3) with elastic peaks times D; rho and D of linearization; "
        + _unsimulated(pair.strong_seconds, pair.scatter),
    )


def _solved_rule(
    pair: PairInMotion, name: str, solve: Callable[[], tuple[Array, Array]], **texts: str
) -> Rule:
    """Eq. (3) with the peaks and correlations that ``solve`` finds, or the reason why it does not."""
    try:
        peaks, rhos = solve()
    except (ArithmeticError, ValueError) as error:
        return Rule(f"eq_3_{name}", "equation_3", _nothing(pair), missing=str(error))
    return equation_3_rule(peaks, f"eq_3_{name}", rhos, **texts)


def _unsimulated(seconds: float, scatter: float) -> str:
    """Assumptions of a rule that uses no simulated peaks."""
    without = f", without the scatter of {scatter:g} between motions" if scatter else ""
    return f"stationary for {seconds:.3g} s, Gaussian; nothing simulated{without}"


def _with_effective_rho(pair: PairInMotion, name: str) -> Rule:
    rule = effective_rule(name)
    doubt = "" if rule.verified else f"; {rule.reason}"

    def solved() -> tuple[Array, Array]:
        """Simulated peaks, and the correlation of the rule; a ValueError if it has none."""
        rho = rho_effective(**pair.effective_arguments(), rule=rule).rho.values
        return pair.peaks, np.atleast_1d(rho)

    return _solved_rule(
        pair,
        rule.name,
        solved,
        reference=rule.reference,
        mark=rule.mark,
        assumptions=f"{EQ_3}; rho by eq. (4) at the simulated mean peak ductility{doubt}",
    )


def _nothing(pair: PairInMotion) -> Array:
    return np.full(pair.heights.size, np.nan)


def _of_modes(pair: PairInMotion) -> Rule:
    """Response spectrum analysis of both buildings together, or of one building alone."""
    try:
        peaks, rhos = pair.combined_modes()
    except (ArithmeticError, ValueError) as error:
        return Rule(CQC, SPECTRUM, _nothing(pair), missing=str(error))
    texts: Any = {
        "reference": "Der Kiureghian (1981), Earthquake Eng. Struct. Dyn. 9, here for a difference",
        "mark": "C",
        "assumptions": f"{ELASTIC_MODES}; {_unsimulated(pair.strong_seconds, pair.scatter)}",
    }
    if pair.alone:
        return Rule(CQC, SPECTRUM, peaks[0], **texts)
    return replace(equation_3_rule(peaks, CQC, rhos, **texts), kind=SPECTRUM)


def _linearized(pair: PairInMotion) -> Rule:
    try:
        moments = pair.relative_moments()
    except (ArithmeticError, ValueError) as error:
        return Rule("linearization", "linearization", _nothing(pair), missing=str(error))
    return linearized_rule(moments, pair.strong_seconds, pair.confidence, pair.scatter)


def linearized_rule(
    moments: tuple[Any, ...], seconds: float, confidence: float, scatter: float = 0.0
) -> Rule:
    """The gap by linearization: the one-sided peak of a Gaussian ``u_1 - u_2`` by Vanmarcke.

    It does not include the ``scatter`` between motions, which is stated in its assumptions.
    """
    l0, l1, l2 = (xr.DataArray(np.atleast_1d(moment), dims="height") for moment in moments)
    gaps = peak_quantile((l0, l1, l2), seconds, confidence, sides=1).values
    return Rule(
        "linearization",
        "linearization",
        gaps,
        reference=PEAK_FACTORS["Vanmarcke1975"].reference,
        mark="C",
        assumptions=_unsimulated(seconds, scatter),
        missing="" if np.isfinite(gaps).all() else SHORT,
    )


def code_rules(
    peaks: Array,
    heights: tuple[Any, ...],
    neighbours: Neighbours,
    site: Mapping[str, Any],
    numbers: Mapping[str, float] | None = None,
    factors: Mapping[str, Any] | None = None,
) -> list[Rule]:
    """The rules of building codes with these peaks [m], (1 or 2 structures, heights).

    ``site`` has further arguments of `code_gaps` by name, such as the zone. Without ``factors`` of
    `code_gaps` the peaks are simulated ones, and a code that defines displacements of its own only
    combines them: it is not judged.
    """
    height_1, height_2 = (
        xr.DataArray(height, dims="height") if np.ndim(height) else height
        for height in (*heights, None)[:2]
    )
    peak_1, *others = (xr.DataArray(peak, dims="height") for peak in peaks)
    table = code_gaps(
        peak_1,
        next(iter(others), None),
        height_1=height_1,
        height_2=height_2,
        numbers=numbers,
        **site,
        **vars(neighbours),
        **(factors or {}),
    )
    rules = []
    for name in table.rule.values:
        row = table.sel(rule=name)
        texts: dict[str, Any] = {
            n: str(row[n].values) for n in ("family", "reference", "mark", "assumptions")
        }
        missing = f"needs {row.missing.values}" if row.missing.values else ""
        judged = factors is not None or not CODE_RULES[name].multiplies
        rules.append(Rule(str(name), "code", row.gap.values, **texts, missing=missing, judged=judged))
    return rules
