"""All rules for the separation of two buildings, or the set-back of one, from simulated peaks."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr

from stochlin.analyses.correlation.correlation import correlate
from stochlin.analyses.correlation.effective import rho_effective
from stochlin.analyses.linearization.equivalent_systems import solve_elastic, solve_structure
from stochlin.analyses.linearization.peaks import peak_table, relative_moments, response_moments
from stochlin.analyses.linearization.strength import solved_reduction_factor
from stochlin.analyses.linearization.tolerance import USUAL
from stochlin.analyses.separation.code_gaps import code_gaps
from stochlin.analyses.simulation.simulation import simulate
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.correlation.combination import double_difference
from stochlin.models.grounds import Ground
from stochlin.models.rules.codes import Neighbours
from stochlin.models.rules.effective_properties import effective_rule, effective_rule_names
from stochlin.models.rules.peak_factors.vanmarcke import Vanmarcke1975
from stochlin.models.structures import DRIFT, GAUSSIAN, Structure

GUMBEL = np.sqrt(6) / np.pi
EQ_3 = "eq. (3) with the peaks of both structures"
ALIKE = 1e-5  # gap over peak below which the gap is a rounding error of two equal structures
COMBINES = "needs a second building: eq. (3) combines the peaks of two"
SHORT = "not solved, or the motion is too short for a peak"
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

    @property
    def gap(self) -> float:
        """Largest gap over the heights [m], which is required over the whole height."""
        return float(np.max(self.gaps))

    @property
    def rho(self) -> float:
        """Correlation at the height where the gap is largest [-]; NaN if the rule has none."""
        known = self.rhos is not None and not np.isnan(self.gap)
        return float(self.rhos[int(np.argmax(self.gaps))]) if known else np.nan  # type: ignore[index]


@dataclass(frozen=True)
class PairInMotion(ABC):
    """Two structures, or one beside its property line, with their simulated motions of finite length.

    Arrays are over the heights at which the structures could meet, or cross the line. Without storeys
    there is one height, which is NaN.
    """

    structures: tuple[Any, ...]
    ground: Ground
    motions: xr.Dataset
    confidence: float
    strong_seconds: float  # [s], duration of the stationary motion with equal energy

    @property
    def alone(self) -> bool:
        """Whether there is only one structure."""
        return len(self.structures) == 1

    @property
    def scatter(self) -> float:
        """Scatter between the motions [-]."""
        return float(self.motions.attrs.get("scatter", 0.0))

    @property
    @abstractmethod
    def heights(self) -> Array:
        """Heights at which the structures could meet [m]."""

    @property
    @abstractmethod
    def code_heights(self) -> tuple[Any, ...]:
        """Height of each structure for rules of codes [m], a number, an array or None."""

    @property
    @abstractmethod
    def peaks(self) -> Array:
        """Quantile of the peak ``|u|`` at the probability ``confidence`` [m], (structures, heights)."""

    @abstractmethod
    def simulated_rho(self) -> Array:
        """Correlation by stationary simulation [-], (heights,)."""

    @abstractmethod
    def linearized_rho(self, closure: str) -> Array:
        """Correlation by linearization [-], (heights,); a ValueError if there is no solution."""

    @abstractmethod
    def amplified_peaks(self) -> Array:
        """Quantile of the elastic peak ``|u|`` times ``D`` of linearization [m], as `peaks`.

        A ValueError or an ArithmeticError if there is none.
        """

    @abstractmethod
    def effective_arguments(self) -> dict[str, float]:
        """Arguments of `rho_effective`, without the rule."""

    @abstractmethod
    def relative_moments(self) -> tuple[Array, Array, Array]:
        """Spectral moments ``l0, l1, l2`` of the linearized ``u_1 - u_2``, or of ``u_1`` if alone."""

    @abstractmethod
    def quantities(self) -> dict[str, Any]:
        """Variables of the table for the structures, by name."""


@dataclass(frozen=True)
class OscillatorsInMotion(PairInMotion):
    """Oscillators; ``known_heights`` are the given heights of the buildings [m]."""

    known_heights: tuple[float | None, ...]

    @property
    def heights(self) -> Array:
        """See `PairInMotion`."""
        return np.array([np.nan])

    @property
    def code_heights(self) -> tuple[Any, ...]:
        """See `PairInMotion`."""
        return self.known_heights

    @cached_property
    def solved(self) -> list[xr.Dataset]:
        """The linearized response of each structure."""
        return [solve_structure(s, self.ground, "gaussian", USUAL) for s in self.structures]

    @cached_property
    def elastic(self) -> list[xr.Dataset]:
        """The response of each structure as elastic."""
        return [solve_elastic(s, self.ground) for s in self.structures]

    @property
    def yield_displacements(self) -> list[float]:
        """Yield displacement of each structure [m], known even if linearization fails."""
        return [float(side.yield_displacement) for side in self.elastic]

    @property
    def peaks(self) -> Array:
        """See `PairInMotion`."""
        quantile: Array = np.quantile(self.motions.peak.values, self.confidence, axis=0)
        return quantile[:, None]

    @property
    def ductilities(self) -> Array:
        """Mean peak ductility of each structure [-]; 0 if elastic."""
        return self.motions.peak_mean.values / np.array(self.yield_displacements)

    def simulated_rho(self) -> Array:
        """See `PairInMotion`."""
        return simulate(self.structures, self.ground).rho.values[0, 1:]

    def linearized_rho(self, closure: str) -> Array:
        """See `PairInMotion`."""
        lacking = {type(s).__name__ for s in self.structures if closure not in s.closure_names()}
        if lacking:
            raise ValueError(f"no {closure} closure for {', '.join(sorted(lacking))}")
        first, second = self.structures
        return np.atleast_1d(correlate(first, second, self.ground, closure=closure).rho.values)

    def amplified_peaks(self) -> Array:
        """See `PairInMotion`."""
        peaks = np.empty((len(self.structures), 1))
        for n, (elastic, yielding) in enumerate(zip(self.elastic, self.solved, strict=True)):
            moments = response_moments(elastic, self.ground)
            peak = peak_quantile(moments, self.strong_seconds, self.confidence, sides=2)
            peaks[n] = peak * yielding.displacement_std / elastic.displacement_std
        if not np.isfinite(peaks).all():
            raise ArithmeticError(SHORT)
        return peaks

    def effective_arguments(self) -> dict[str, float]:
        """See `PairInMotion`."""
        return effective_arguments(self.structures, self.ductilities)

    def relative_moments(self) -> tuple[Array, Array, Array]:
        """See `PairInMotion`."""
        first, *others = self.solved
        if others:
            l0, l1, l2 = relative_moments(first, others[0], self.ground)
        else:
            l0, l1, l2 = response_moments(first, self.ground)
        return l0.values, l1.values, l2.values

    def quantities(self) -> dict[str, Any]:
        """See `PairInMotion`."""
        table: dict[str, float] = {}
        for n, (structure, side) in enumerate(zip(self.structures, self.elastic, strict=True)):
            mean = ("peak_mean", "peak_mean_standard_error")
            table |= {f"{name}_{n + 1}": float(self.motions[name][n]) for name in mean}
            table[f"peak_{n + 1}"] = float(self.peaks[n, 0])
            table[f"ductility_{n + 1}"] = float(self.ductilities[n]) if structure.yields else np.nan
            table[f"yield_displacement_{n + 1}"] = self.yield_displacements[n]
            table[f"reduction_factor_{n + 1}"] = solved_reduction_factor(structure, side)
        return table


def effective_arguments(structures: Sequence[Structure], ductilities: Array) -> dict[str, float]:
    """Arguments of `rho_effective` for two oscillators with these peak ductilities."""
    arguments: dict[str, float] = {}
    for n, structure in enumerate(structures):
        own, parameters = structure.yields, structure.arrays()
        arguments |= {f"{key}_{n + 1}": float(parameters[key]) for key in ("period", "damping")}
        arguments[f"hardening_{n + 1}"] = float(parameters["hardening"]) if own else 1.0
        arguments[f"ductility_{n + 1}"] = float(ductilities[n]) if own else 1.0
    return arguments


def all_rules(
    pair: PairInMotion,
    neighbours: Neighbours,
    zone: str | None,
    unverified: bool,
    numbers: Mapping[str, float] | None,
) -> list[Rule]:
    """All rules, including those that have no gap because something is missing."""
    return [
        *_with_correlations(pair, effective_rule_names(unverified)),
        _linearized(pair),
        *code_rules(pair.peaks, pair.code_heights, neighbours, zone, numbers),
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


def equation_3_rule(peaks: Array, name: str, rhos: Array, **texts: str) -> Rule:
    """Eq. (3) with these peaks (2, heights) [m] and correlations (heights,)."""
    gaps = double_difference(peaks[0], peaks[1], np.clip(rhos, -1, 1))
    gaps = np.where(gaps < ALIKE * np.max(peaks, axis=0), 0.0, gaps)
    return Rule(name, "equation_3", gaps, np.broadcast_to(rhos, gaps.shape), **texts)


def _with_solved_rho(pair: PairInMotion, name: str, source: str, rho: Callable[[], Array]) -> Rule:
    texts = {"mark": "C", "assumptions": f"{EQ_3}; rho of {source}"}
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
    rho = rho_effective(**pair.effective_arguments(), rule=rule).rho.values
    doubt = "" if rule.verified else f"; {rule.reason}"
    return equation_3_rule(
        pair.peaks,
        f"eq_3_{rule.name}",
        np.atleast_1d(rho),
        reference=rule.reference,
        mark=rule.mark,
        assumptions=f"{EQ_3}; rho by eq. (4) at the simulated mean peak ductility{doubt}",
    )


def _nothing(pair: PairInMotion) -> Array:
    return np.full(pair.heights.size, np.nan)


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
        reference=Vanmarcke1975.reference,
        mark="C",
        assumptions=_unsimulated(seconds, scatter),
        missing="" if np.isfinite(gaps).all() else SHORT,
    )


def peak_quantile(
    moments: tuple[xr.DataArray, ...], seconds: float, confidence: float, sides: int
) -> xr.DataArray:
    """Quantile of the peak of a Gaussian motion [m] at ``confidence``, by a Gumbel distribution."""
    l0, l1, l2 = moments
    peak = peak_table(l0, l1, l2, xr.DataArray(seconds), Vanmarcke1975(), sides)
    reduced = -np.log(-np.log(confidence))
    return peak.peak_mean + GUMBEL * (reduced - np.euler_gamma) * peak.peak_std


def code_rules(
    peaks: Array,
    heights: tuple[Any, ...],
    neighbours: Neighbours,
    zone: str | None,
    numbers: Mapping[str, float] | None = None,
) -> list[Rule]:
    """The rules of building codes with these peaks [m], (1 or 2 structures, heights)."""
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
        zone=zone,
        numbers=numbers,
        **vars(neighbours),
    )
    rules = []
    for name in table.rule.values:
        row = table.sel(rule=name)
        texts: dict[str, Any] = {
            n: str(row[n].values) for n in ("family", "reference", "mark", "assumptions")
        }
        missing = f"needs {row.missing.values}" if row.missing.values else ""
        rules.append(Rule(str(name), "code", row.gap.values, **texts, missing=missing))
    return rules
