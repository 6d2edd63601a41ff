"""All rules for the separation of two buildings, or the set-back of one, from simulated peaks."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from stochlin.applications.separation.code_gaps import Rule, code_rules
from stochlin.applications.separation.critical_gap import equation_3
from stochlin.applications.separation.pairs import PairInMotion
from stochlin.kernels.basics.arrays import Array
from stochlin.models.rules.codes import Neighbours
from stochlin.models.rules.effective_properties import (
    effective_rule,
    effective_rule_names,
)
from stochlin.models.rules.peak_factors import PEAK_FACTORS

EQ_3 = "eq. (3) with the peaks of both structures"
COMBINES = "needs a second building: eq. (3) combines the peaks of two"
EQUATION_3 = "equation_3"  # kind of the rules by eq. (3)
ELASTIC_MODES = (
    "CQC over all elastic modes, with their peaks and correlations on the ground; what yields moves as "
    "far as if it were elastic"
)
OF_DUCTILITY = "rho by eq. (4) at the simulated mean peak ductility"
PAPER = "Valles-Mattox and Reinhorn (1996), eq. (3) and Fig. 5"
OF_CQC = "Der Kiureghian (1981), Earthquake Eng. Struct. Dyn. 9, here for a difference"

Gaps = tuple[Array, Array | None]
"""Gaps [m] and correlations over the heights; None for a rule without correlations."""


def all_rules(
    pair: PairInMotion,
    neighbours: Neighbours,
    site: dict[str, Any],
    zone: str | None,
    unverified: bool,
    numbers: Mapping[str, float] | None,
    simulated_rho: bool,
) -> list[Rule]:
    """All rules, including those that have no gap because something is missing.

    ``site`` has the numbers of storeys and the peak ground acceleration of the design.
    """
    rules = [_solved(pair, *each) for each in _formulas(pair, unverified, simulated_rho)]
    # Of a building that falls codes say nothing.
    peaks = np.where(np.isfinite(pair.peaks), pair.peaks, np.nan)
    values = dict(zip(("height_1", "height_2"), pair.code_heights, strict=False)) | site
    values |= dict(zip(("peak_1", "peak_2"), peaks, strict=False))
    return [*rules, *code_rules(values, neighbours, zone, numbers)]


def _solved(pair: PairInMotion, rule: Rule, solve: Callable[[], Gaps]) -> Rule:
    """A rule with its gaps, or with the reason why it has none."""
    missing = COMBINES if pair.alone and rule.kind == EQUATION_3 else ""
    try:
        gaps, rhos = (None, None) if missing else solve()
    except (ArithmeticError, ValueError) as error:
        gaps, missing = None, str(error)
    if gaps is None:
        return Rule(rule.name, rule.kind, np.full(pair.heights.size, np.nan), missing=missing)
    return replace(rule, gaps=gaps, rhos=rhos)


def _formulas(
    pair: PairInMotion, unverified: bool, simulated_rho: bool
) -> Iterator[tuple[Rule, Callable[[], Gaps]]]:
    """Eq. (3) with each correlation, and rules without simulation, each with what solves it."""

    def eq_3(name: str, about: str, rho: Callable[[], Array], mark: str, source: str = "") -> Any:
        about = f"{EQ_3}; {about}"
        rule = Rule(f"eq_3_{name}", EQUATION_3, reference=source, mark=mark, assumptions=about)
        return rule, lambda: _equation_3(pair.peaks, rho())

    if simulated_rho:  # which raises an error for structures that yield too rarely for it
        yield eq_3("simulated", "rho of stationary simulation", pair.simulated_rho, "C")
    yield eq_3("linearized", "rho of linearization", pair.linearized_rho, "C")
    yield eq_3("drift", "rho of linearization with plastic drift", pair.drift_rho, "C")
    without = f", without the scatter of {pair.scatter:g} between motions" if pair.scatter else ""
    unsimulated = f"stationary for {pair.strong_seconds:.3g} s, Gaussian; nothing simulated{without}"
    about = f"eq. (3) with elastic peaks times D; rho and D of linearization; {unsimulated}"
    paper = Rule("eq_3_paper", EQUATION_3, reference=PAPER, mark="P", assumptions=about)
    yield paper, lambda: _equation_3(pair.amplified_peaks(), pair.linearized_rho())
    for rule in map(effective_rule, effective_rule_names(unverified)):
        about = "; ".join(filter(None, [OF_DUCTILITY, rule.reason]))
        rho = partial(pair.effective_rho, rule)
        yield eq_3(rule.name, about, rho, rule.mark, rule.reference)
    about = f"{ELASTIC_MODES}; {unsimulated}"
    of_modes = Rule("cqc", "response_spectrum", reference=OF_CQC, mark="C", assumptions=about)
    yield of_modes, partial(_of_modes, pair)
    source = PEAK_FACTORS["Vanmarcke1975"].reference
    alone = Rule("linearization", "linearization", reference=source, mark="C", assumptions=unsimulated)
    yield alone, lambda: (pair.linearized_gaps(), None)


def _equation_3(peaks: Array, rhos: Array) -> Gaps:
    """Gaps by eq. (3) with these peaks (2, heights) [m], and the correlations."""
    first, second = peaks
    falls = np.isposinf(first) | np.isposinf(second)
    gaps = np.where(falls, np.inf, equation_3(first, second, rhos))
    return gaps, np.broadcast_to(rhos, gaps.shape)


def _of_modes(pair: PairInMotion) -> Gaps:
    """Response spectrum analysis of both buildings together, or of one building alone."""
    peaks, rhos = pair.combined_modes()
    return (peaks[0], None) if pair.alone else _equation_3(peaks, rhos)
