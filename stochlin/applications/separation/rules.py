"""All rules for the separation of two buildings, or the set-back of one, from simulated peaks."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from stochlin.applications.separation.code_gaps import code_gaps
from stochlin.applications.separation.critical_gap import equation_3
from stochlin.applications.separation.pairs import SHORT, PairInMotion, peak_quantile
from stochlin.kernels.basics.arrays import Array
from stochlin.models.rules.codes import CODE_RULES, Neighbours
from stochlin.models.rules.effective_properties import (
    EffectiveRule,
    effective_rule,
    effective_rule_names,
)
from stochlin.models.rules.peak_factors import PEAK_FACTORS
from stochlin.models.structures import DRIFT, GAUSSIAN
from stochlin.solver.correlation.effective import rho_effective

EQ_3 = "eq. (3) with the peaks of both structures"
COMBINES = "needs a second building: eq. (3) combines the peaks of two"
EQUATION_3 = "equation_3"  # kind of the rules by eq. (3)
ELASTIC_MODES = (
    "CQC over all elastic modes, with their peaks and correlations on the ground; what yields moves as "
    "far as if it were elastic"
)
PAPER = "Valles-Mattox and Reinhorn (1996), eq. (3) and Fig. 5"
OF_CQC = "Der Kiureghian (1981), Earthquake Eng. Struct. Dyn. 9, here for a difference"


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
    simulated_rho: bool,
) -> list[Rule]:
    """All rules, including those that have no gap because something is missing."""
    rules = [_solved(pair, *way) for way in _ways(pair, effective_rule_names(unverified), simulated_rho)]
    return [*rules, *code_rules(pair.peaks, pair.code_heights, neighbours, site, numbers)]


Gaps = tuple[Array, Array | None]
"""Gaps and correlations over the heights; None for a rule without correlations."""
Way = tuple[str, str, str, str, str, Callable[[], Gaps]]
"""Name, kind, reference, mark and assumptions of a rule, and the function that solves it."""


def _solved(
    pair: PairInMotion,
    name: str,
    kind: str,
    source: str,
    mark: str,
    about: str,
    solve: Callable[[], Gaps],
) -> Rule:
    """A rule with its gaps, or with the reason why it has none."""
    missing = COMBINES if pair.alone and kind == EQUATION_3 else ""
    try:
        gaps, rhos = (None, None) if missing else solve()
    except (ArithmeticError, ValueError) as error:
        gaps, missing = None, str(error)
    if gaps is None:
        return Rule(name, kind, np.full(pair.heights.size, np.nan), missing=missing)
    return Rule(name, kind, gaps, rhos, reference=source, mark=mark, assumptions=about)


def _ways(pair: PairInMotion, effective: Sequence[str], simulated_rho: bool) -> Iterator[Way]:
    """The rules that are solved here: eq. (3) with each correlation, and rules without simulation."""
    without = f", without the scatter of {pair.scatter:g} between motions" if pair.scatter else ""
    unsimulated = f"stationary for {pair.strong_seconds:.3g} s, Gaussian; nothing simulated{without}"
    rhos: dict[str, tuple[str, Callable[[], Array]]] = {
        "linearized": ("linearization", lambda: pair.linearized_rho(GAUSSIAN)),
        "drift": ("linearization with plastic drift", lambda: pair.linearized_rho(DRIFT)),
    }
    if simulated_rho:  # which raises an error for structures that yield too rarely for it
        rhos = {"simulated": ("stationary simulation", pair.simulated_rho)} | rhos
    for name, (source, rho) in rhos.items():
        solve = partial(_equation_3, lambda: pair.peaks, rho)
        yield f"eq_3_{name}", EQUATION_3, "", "C", f"{EQ_3}; rho of {source}", solve
    solve = partial(_equation_3, pair.amplified_peaks, lambda: pair.linearized_rho(GAUSSIAN))
    about = f"eq. (3) with elastic peaks times D; rho and D of linearization; {unsimulated}"
    yield "eq_3_paper", EQUATION_3, PAPER, "P", about, solve
    for name in effective:
        rule = effective_rule(name)
        about = f"{EQ_3}; rho by eq. (4) at the simulated mean peak ductility"
        about += "" if rule.verified else f"; {rule.reason}"
        solve = partial(_equation_3, lambda: pair.peaks, partial(_effective_rho, pair, rule))
        yield f"eq_3_{rule.name}", EQUATION_3, rule.reference, rule.mark, about, solve
    about = f"{ELASTIC_MODES}; {unsimulated}"
    yield "cqc", "response_spectrum", OF_CQC, "C", about, partial(_of_modes, pair)
    source = PEAK_FACTORS["Vanmarcke1975"].reference
    yield "linearization", "linearization", source, "C", unsimulated, partial(_linearized, pair)


def _equation_3(peaks: Callable[[], Array], rhos: Callable[[], Array]) -> Gaps:
    """Gaps by eq. (3) with these peaks (2, heights) [m], and the correlations."""
    (first, second), known = peaks(), rhos()
    falls = np.isposinf(first) | np.isposinf(second)
    gaps = np.where(falls, np.inf, equation_3(first, second, known))
    return gaps, np.broadcast_to(known, gaps.shape)


def _effective_rho(pair: PairInMotion, rule: EffectiveRule) -> Array:
    """The correlation by a rule for effective properties."""
    return np.atleast_1d(rho_effective(**pair.effective_arguments(), rule=rule).rho.values)


def _of_modes(pair: PairInMotion) -> Gaps:
    """Response spectrum analysis of both buildings together, or of one building alone."""
    peaks, rhos = pair.combined_modes()
    return (peaks[0], None) if pair.alone else _equation_3(lambda: peaks, lambda: rhos)


def _linearized(pair: PairInMotion) -> Gaps:
    """The gap by linearization: the one-sided peak of a Gaussian ``u_1 - u_2`` by Vanmarcke."""
    moments = (xr.DataArray(np.atleast_1d(each), dims="height") for each in pair.relative_moments())
    gaps = peak_quantile(tuple(moments), pair.strong_seconds, pair.confidence, sides=1).values
    if not np.isfinite(gaps).all():
        raise ArithmeticError(SHORT)
    return gaps, None


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
