"""Every rule for the separation of two buildings, fed with their simulated peaks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from stochlin.analyses.correlation.correlation import correlate
from stochlin.analyses.correlation.effective import rho_effective
from stochlin.analyses.linearization.equivalent_systems import STRENGTH_RATIO, solve_structure
from stochlin.analyses.linearization.peaks import peak_table, relative_moments
from stochlin.analyses.linearization.tolerance import USUAL
from stochlin.analyses.separation.code_gaps import code_gaps
from stochlin.analyses.separation.critical_gap import double_difference
from stochlin.analyses.simulation.simulation import simulate
from stochlin.kernels.basics.arrays import Array
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground
from stochlin.models.rules.effective_properties import effective_rule, effective_rule_names
from stochlin.models.rules.peak_factors.vanmarcke import Vanmarcke1975
from stochlin.models.structures import DRIFT, Structure

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
    solved: tuple[xr.Dataset, xr.Dataset]
    motions: xr.Dataset
    confidence: float
    strong_seconds: float  # length of the stationary motion that an envelope stands for
    heights: tuple[float | None, float | None]

    @classmethod
    def of(
        cls,
        first: Structure,
        second: Structure,
        ground: Ground,
        motions: xr.Dataset,
        confidence: float,
        duration: float,
        envelope: Envelope | None,
        heights: tuple[float | None, float | None],
    ) -> PairInMotion:
        """Linearize the structures; an envelope counts by the integral of its square."""
        solved = tuple(solve_structure(s, ground, "gaussian", USUAL) for s in (first, second))
        seconds = strong_seconds(duration, envelope)
        pair = (first, second)
        return cls(pair, ground, (solved[0], solved[1]), motions, confidence, seconds, heights)

    @property
    def peaks(self) -> Array:
        """Largest ``|u|`` of both [m], not exceeded with the probability ``confidence``."""
        quantile: Array = np.quantile(self.motions.peak.values, self.confidence, axis=0)
        return quantile

    @property
    def ductilities(self) -> Array:
        """Mean peak ductility of both; 0 where elastic."""
        return self.motions.peak_mean.values / [float(side.yield_displacement) for side in self.solved]

    def quantities(self) -> dict[str, float]:
        """What the table says of the structures."""
        table: dict[str, float] = {}
        for n in (0, 1):
            mean = ("peak_mean", "peak_mean_standard_error")
            table |= {f"{name}_{n + 1}": float(self.motions[name][n]) for name in mean}
            table[f"peak_{n + 1}"] = float(self.peaks[n])
            yields = self.structures[n].yields
            table[f"ductility_{n + 1}"] = float(self.ductilities[n]) if yields else np.nan
            table[f"yield_displacement_{n + 1}"] = float(self.solved[n].yield_displacement)
            factor = float(self.structures[n].arrays()["peak_factor"] * self.solved[n][STRENGTH_RATIO])
            table[f"reduction_factor_{n + 1}"] = factor if yields else np.nan
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
    return [
        _with_simulated_rho(pair),
        _with_linearized_rho(pair),
        _with_drifting_rho(pair),
        *(_with_effective_rho(pair, name) for name in effective_rule_names(unverified)),
        linearized_rule(pair.solved, pair.ground, pair.strong_seconds, pair.confidence),
        *code_rules(pair.peaks, pair.heights, floors_align, zone),
    ]


def _with_rho(pair: PairInMotion, name: str, rho: float, **texts: str) -> Rule:
    return equation_3_rule(pair.peaks, name, rho, **texts)


def equation_3_rule(peaks: Array, name: str, rho: float, **texts: str) -> Rule:
    """Eq. (3) with these peaks [m] and this correlation."""
    gap = float(double_difference(peaks[0], peaks[1], np.clip(rho, -1, 1)))
    return Rule(name, "equation_3", gap, rho, **texts)


def _with_simulated_rho(pair: PairInMotion) -> Rule:
    name, kind = "eq_3_simulated", "equation_3"
    try:
        table = simulate(pair.structures, pair.ground)
    except ValueError as error:  # of a structure that yields so rarely that it would take hours
        return Rule(name, kind, np.nan, missing=str(error))
    rho = float(table.rho[0, 1])
    return _with_rho(pair, name, rho, mark="C", assumptions=f"{EQ_3}; rho of stationary simulation")


def _with_linearized_rho(pair: PairInMotion) -> Rule:
    return _with_solved_rho(pair, "eq_3_linearized", "gaussian", "rho of linearization")


def _with_drifting_rho(pair: PairInMotion) -> Rule:
    name = "eq_3_drift"
    lacking = [s for s in pair.structures if DRIFT not in s.closure_names()]
    if lacking:
        names = ", ".join(sorted({type(structure).__name__ for structure in lacking}))
        return Rule(name, "equation_3", np.nan, missing=f"no drift closure for {names}")
    return _with_solved_rho(pair, name, DRIFT, "rho of linearization with plastic drift")


def _with_solved_rho(pair: PairInMotion, name: str, closure: str, source: str) -> Rule:
    try:
        rho = float(correlate(*pair.structures, pair.ground, closure=closure).rho)
    except ArithmeticError as error:
        return Rule(name, "equation_3", np.nan, missing=str(error))
    return _with_rho(pair, name, rho, mark="C", assumptions=f"{EQ_3}; {source}")


def _with_effective_rho(pair: PairInMotion, name: str) -> Rule:
    rule = effective_rule(name)
    values = [structure.arrays() for structure in pair.structures]
    yields = [structure.yields for structure in pair.structures]
    arguments: dict[str, float] = {}
    for n, (given, own) in enumerate(zip(values, yields, strict=True)):
        arguments |= {f"{key}_{n + 1}": float(given[key]) for key in ("period", "damping")}
        arguments[f"hardening_{n + 1}"] = float(given["hardening"]) if own else 1.0
        arguments[f"ductility_{n + 1}"] = float(pair.ductilities[n]) if own else 1.0
    rho = float(rho_effective(**arguments, rule=rule).rho)
    doubt = "" if rule.verified else f"; {rule.reason}"
    return _with_rho(
        pair,
        f"eq_3_{rule.name}",
        rho,
        reference=rule.reference,
        mark=rule.mark,
        assumptions=f"{EQ_3}; rho by eq. (4) at the simulated mean peak ductility{doubt}",
    )


def linearized_rule(
    solved: tuple[xr.Dataset, xr.Dataset], ground: Ground, seconds: float, confidence: float
) -> Rule:
    """Linearization alone: a Gaussian difference, its one-sided peak by Vanmarcke."""
    moments = relative_moments(*solved, ground)
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
    table = code_gaps(
        peaks[0],
        peaks[1],
        height_1=heights[0],
        height_2=heights[1],
        floors_align=floors_align,
        zone=zone,
    )
    names = ("rule", "gap", "reference", "mark", "assumptions", "missing")
    columns = (table[name].values for name in names)
    return [
        Rule(
            str(name),
            "code",
            float(gap),
            reference=str(reference),
            mark=str(mark),
            assumptions=str(assumptions),
            missing=_lacking(str(missing)),
        )
        for name, gap, reference, mark, assumptions, missing in zip(*columns, strict=True)
    ]


def _lacking(names: str) -> str:
    return f"needs {names}" if names else ""
