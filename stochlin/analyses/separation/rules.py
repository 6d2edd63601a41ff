"""Every rule for the separation of two buildings, fed with their simulated peaks."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr

from stochlin.analyses.correlation.correlation import correlate
from stochlin.analyses.correlation.effective import rho_effective
from stochlin.analyses.linearization.equivalent_systems import solve_elastic, solve_structure
from stochlin.analyses.linearization.peaks import peak_table, relative_moments
from stochlin.analyses.linearization.strength import solved_reduction_factor
from stochlin.analyses.linearization.tolerance import USUAL
from stochlin.analyses.separation.code_gaps import code_gaps
from stochlin.analyses.separation.critical_gap import double_difference
from stochlin.analyses.simulation.simulation import simulate
from stochlin.kernels.basics.arrays import Array
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground
from stochlin.models.rules.effective_properties import effective_rule, effective_rule_names
from stochlin.models.rules.peak_factors.vanmarcke import Vanmarcke1975
from stochlin.models.structures import DRIFT, GAUSSIAN, Structure

STEPS = 2000  # of the envelope, for the length of motion that it stands for
GUMBEL = np.sqrt(6) / np.pi
EQ_3 = "eq. (3) with the peaks of both structures"


@dataclass(frozen=True)
class Rule:
    """One row of the table."""

    name: str
    kind: str
    gap: float  # [m], NaN if not available
    rho: float = np.nan
    reference: str = ""
    mark: str = ""
    assumptions: str = ""
    missing: str = ""


@dataclass(frozen=True)
class PairInMotion:
    """Two structures, linearized, and what the simulation of finite motions tells of each."""

    structures: tuple[Structure, Structure]
    ground: Ground
    motions: xr.Dataset
    confidence: float
    strong_seconds: float  # length of the stationary motion that an envelope stands for
    heights: tuple[float | None, float | None]

    @cached_property
    def solved(self) -> list[xr.Dataset]:
        """Both structures, linearized."""
        return [solve_structure(s, self.ground, "gaussian", USUAL) for s in self.structures]

    @cached_property
    def yield_displacements(self) -> list[float]:
        """Of both [m], known whether linearization succeeds or not."""
        return [float(solve_elastic(s, self.ground).yield_displacement) for s in self.structures]

    @property
    def peaks(self) -> Array:
        """Largest ``|u|`` of both [m], not exceeded with the probability ``confidence``."""
        quantile: Array = np.quantile(self.motions.peak.values, self.confidence, axis=0)
        return quantile

    @property
    def ductilities(self) -> Array:
        """Mean peak ductility of both; 0 where elastic."""
        return self.motions.peak_mean.values / np.array(self.yield_displacements)

    def quantities(self) -> dict[str, float]:
        """What the table says of the structures."""
        table: dict[str, float] = {}
        for n, (structure, side) in enumerate(zip(self.structures, self.solved, strict=True)):
            mean = ("peak_mean", "peak_mean_standard_error")
            table |= {f"{name}_{n + 1}": float(self.motions[name][n]) for name in mean}
            table[f"peak_{n + 1}"] = float(self.peaks[n])
            table[f"ductility_{n + 1}"] = float(self.ductilities[n]) if structure.yields else np.nan
            table[f"yield_displacement_{n + 1}"] = self.yield_displacements[n]
            table[f"reduction_factor_{n + 1}"] = solved_reduction_factor(structure, side)
        for name in ("separation_mean", "separation_mean_standard_error"):
            table[name] = float(self.motions[name][0, 1])
        return table


def strong_seconds(duration: float, envelope: Envelope | None) -> float:
    """Length [s] of the stationary motion that an envelope stands for: the integral of its square."""
    if envelope is None:
        return duration
    middle = (np.arange(STEPS) + 0.5) * duration / STEPS
    return duration * float(np.mean(envelope.at(middle) ** 2))


def all_rules(pair: PairInMotion, floors_align: bool, zone: str | None, unverified: bool) -> list[Rule]:
    """Every rule that there is, those that lack something too."""
    both = pair.structures, pair.ground
    return [  # simulation is refused for structures so rarely yielding that it would take hours
        _with_solved_rho(pair, "simulated", "stationary simulation", lambda: simulate(*both).rho[0, 1]),
        _with_linearized_rho(pair, "linearized", GAUSSIAN, "linearization"),
        _with_linearized_rho(pair, "drift", DRIFT, "linearization with plastic drift"),
        *(_with_effective_rho(pair, name) for name in effective_rule_names(unverified)),
        linearized_rule(pair.solved, pair.ground, pair.strong_seconds, pair.confidence),
        *code_rules(pair.peaks, pair.heights, floors_align, zone),
    ]


def equation_3_rule(peaks: Array, name: str, rho: float, **texts: str) -> Rule:
    """Eq. (3) with these peaks [m] and this correlation."""
    gap = float(double_difference(peaks[0], peaks[1], np.clip(rho, -1, 1)))
    return Rule(name, "equation_3", gap, rho, **texts)


def _with_linearized_rho(pair: PairInMotion, name: str, closure: str, source: str) -> Rule:
    lacking = {type(s).__name__ for s in pair.structures if closure not in s.closure_names()}
    if lacking:
        missing = f"no {closure} closure for {', '.join(sorted(lacking))}"
        return Rule(f"eq_3_{name}", "equation_3", np.nan, missing=missing)
    both = (*pair.structures, pair.ground)
    return _with_solved_rho(pair, name, source, lambda: correlate(*both, closure=closure).rho)


def _with_solved_rho(
    pair: PairInMotion, name: str, source: str, solve: Callable[[], xr.DataArray]
) -> Rule:
    try:
        rho = float(solve())
    except (ArithmeticError, ValueError) as error:
        return Rule(f"eq_3_{name}", "equation_3", np.nan, missing=str(error))
    texts = {"mark": "C", "assumptions": f"{EQ_3}; rho of {source}"}
    return equation_3_rule(pair.peaks, f"eq_3_{name}", rho, **texts)


def _with_effective_rho(pair: PairInMotion, name: str) -> Rule:
    rule = effective_rule(name)
    arguments: dict[str, float] = {}
    for n, structure in enumerate(pair.structures):
        own, given = structure.yields, structure.arrays()
        arguments |= {f"{key}_{n + 1}": float(given[key]) for key in ("period", "damping")}
        arguments[f"hardening_{n + 1}"] = float(given["hardening"]) if own else 1.0
        arguments[f"ductility_{n + 1}"] = float(pair.ductilities[n]) if own else 1.0
    rho = float(rho_effective(**arguments, rule=rule).rho)
    doubt = "" if rule.verified else f"; {rule.reason}"
    return equation_3_rule(
        pair.peaks,
        f"eq_3_{rule.name}",
        rho,
        reference=rule.reference,
        mark=rule.mark,
        assumptions=f"{EQ_3}; rho by eq. (4) at the simulated mean peak ductility{doubt}",
    )


def linearized_rule(
    solved: Sequence[xr.Dataset], ground: Ground, seconds: float, confidence: float
) -> Rule:
    """Linearization alone: a Gaussian difference, its one-sided peak by Vanmarcke."""
    moments = relative_moments(solved[0], solved[1], ground)
    gap = float(peak_quantile(moments, seconds, confidence, sides=1))
    missing = "" if np.isfinite(gap) else "not solved, or the motion is too short to hold a peak"
    return Rule(
        "linearization",
        "linearization",
        gap,
        reference=Vanmarcke1975.reference,
        mark="C",
        assumptions=f"stationary for {seconds:.3g} s, Gaussian; nothing simulated",
        missing=missing,
    )


def peak_quantile(
    moments: tuple[xr.DataArray, ...], seconds: float, confidence: float, sides: int
) -> xr.DataArray:
    """Peak [m] that a Gaussian motion does not exceed with this probability, a Gumbel distribution."""
    l0, l1, l2 = moments
    peak = peak_table(l0, l1, l2, xr.DataArray(seconds), Vanmarcke1975(), sides)
    reduced = -np.log(-np.log(confidence))
    return peak.peak_mean + GUMBEL * (reduced - np.euler_gamma) * peak.peak_std


def code_rules(
    peaks: Array, heights: tuple[float | None, float | None], floors_align: bool, zone: str | None
) -> list[Rule]:
    """The rules of building codes, fed with these peaks [m]."""
    height_1, height_2 = heights
    table = code_gaps(*peaks, height_1=height_1, height_2=height_2, floors_align=floors_align, zone=zone)
    rules = []
    for name in table.rule.values:
        row = table.sel(rule=name)
        texts: dict[str, Any] = {n: str(row[n].values) for n in ("reference", "mark", "assumptions")}
        missing = f"needs {row.missing.values}" if row.missing.values else ""
        rules.append(Rule(str(name), "code", float(row.gap), **texts, missing=missing))
    return rules
