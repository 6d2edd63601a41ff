"""Two structures, or one beside a property line, in simulated motions; their gap by every rule."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np
import xarray as xr

from stochlin.applications.separation.code_gaps import Rule, code_row
from stochlin.applications.separation.critical_gap import ROUNDING_OF_GAP, equation_3
from stochlin.applications.separation.storeys import (
    combine_modes,
    correlation_of,
    facing_heights,
    modes_of,
    oscillators_of,
    weights_at,
)
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.systems.response import StationaryResponse
from stochlin.models.envelopes import strong_seconds
from stochlin.models.grounds import Ground
from stochlin.models.rules.codes import CodeRule, Site
from stochlin.models.rules.effective_properties import (
    EffectiveRule,
    effective_rule,
    effective_rule_names,
)
from stochlin.models.rules.peak_factors import PEAK_FACTORS, peak_factor_model
from stochlin.models.structures import Structure
from stochlin.models.systems import Assembly
from stochlin.solver.correlation.equation_4 import rho_effective
from stochlin.solver.correlation.levels import PairsInTime, lone_pair_in_time
from stochlin.solver.linearization.equivalent_systems import Solved, solved_together
from stochlin.solver.linearization.levels import EnvelopesInTime, strengths, why_no_drift
from stochlin.solver.linearization.peaks import peak_table, response_moments
from stochlin.solver.linearization.strength import solved_reduction_factor
from stochlin.solver.linearization.systems.systems import linearized_motion
from stochlin.solver.simulation.prepared import PreparedStructures
from stochlin.solver.simulation.statistics import mean_with_error, pair_peaks, quantiles_of

PEAKS_OF_BOTH = "eq. (3) with the peaks of both structures"
NEEDS_SECOND_BUILDING = "needs a second building: eq. (3) combines the peaks of two"
EQUATION_3 = "equation_3"  # kind of the rules by eq. (3)
ELASTIC_MODES = (
    "CQC over all elastic modes, with their peaks and correlations on the ground; what yields "
    "moves as far as if it were elastic"
)
RHO_AT_DUCTILITY = "rho by eq. (4) at the simulated mean peak ductility"
EQUATION_3_SOURCE = "Valles-Mattox and Reinhorn (1996), eq. (3) and Fig. 5"
CQC_SOURCE = "Der Kiureghian (1981), Earthquake Eng. Struct. Dyn. 9, here for a difference"
GUMBEL_SCALE = np.sqrt(6) / np.pi  # of a Gumbel distribution, over its standard deviation

Gaps = tuple[Array, Array | None]
"""Gaps [m] and correlations over the heights; None for a rule without correlations."""


@dataclass(frozen=True)
class PairInMotion:
    """Two structures, or one beside its property line, with simulated motions of finite length.

    Rules take the structures at their medians, and the peaks of all samples. Arrays are over the
    heights at which the structures could meet, or cross the line. Without storeys there is one
    height, which is NaN.
    """

    prepared: PreparedStructures
    motions: xr.Dataset
    confidence: float
    site: Site  # what else the rules of codes ask

    @property
    def structures(self) -> tuple[Any, ...]:
        """The structures at their medians, with strengths in metres."""
        return self.prepared.medians

    @property
    def ground(self) -> Ground:
        """The ground at its medians."""
        return self.prepared.usual

    @cached_property
    def strong_seconds(self) -> float:
        """Duration of the stationary motion with equal energy [s]."""
        return strong_seconds(self.prepared.motion.duration, self.prepared.motion.envelope)

    @cached_property
    def course(self) -> EnvelopesInTime:
        """The motions in sizes that scatter."""
        motion = self.prepared.motion
        return EnvelopesInTime.of(motion.envelope, motion.duration, *strengths(motion.scatter))

    @property
    def alone(self) -> bool:
        """Whether there is only one structure."""
        return len(self.structures) == 1

    @property
    def has_storeys(self) -> bool:
        """Whether one of the structures is a building with storeys."""
        return any(structure.has_storeys for structure in self.structures)

    @property
    def system(self) -> Assembly:
        """All structures as one system, without links."""
        return self.prepared.system

    @cached_property
    def heights(self) -> Array:
        """Heights at which the structures could meet [m]."""
        return facing_heights(self.system)

    @cached_property
    def peaks(self) -> Array:
        """Quantile of the peak ``|u|`` at probability ``confidence`` [m], (structures, heights)."""
        peaks = self.motions.peak
        if self.has_storeys and not self.alone:
            peaks = self.motions.peak_at_height.sel(height=self.heights)
        samples = peaks.to_numpy().reshape(len(peaks), len(self.structures), -1)
        return quantiles_of(samples, np.array([self.confidence]))[0]

    @cached_property
    def modes(self) -> list[Structure]:
        """The first modes of the structures as oscillators."""
        return [structure.first_mode() for structure in self.structures]

    @cached_property
    def elastic(self) -> list[Solved]:
        """The response of each first mode as elastic."""
        return [solved_together((mode,), self.ground) for mode in self.modes]

    @cached_property
    def linearized(self) -> StationaryResponse:
        """Stationary response of all structures by linearization."""
        return linearized_motion(self.structures, self.ground)

    @property
    def yield_displacements(self) -> list[float]:
        """Yield displacement of each first mode [m], known even if linearization fails."""
        return [side.values["yield_displacement"].item() for side in self.elastic]

    @cached_property
    def ductilities(self) -> Array:
        """Mean peak ductility of the first modes, from roof displacements; 0 if elastic."""
        roofs = self.motions.peak_mean.to_numpy()[self.system.first[1:] - 1]
        shares = [
            float(structure.first_mode_moves()[-1]) if structure.has_storeys else 1.0
            for structure in self.structures
        ]
        ductilities: Array = roofs / np.array(shares) / np.array(self.yield_displacements)
        return ductilities

    @cached_property
    def weights(self) -> list[Array]:
        """Displacement of each structure at the heights, as weights of floors (heights, floors)."""
        return weights_at(self.system, self.heights)

    @property
    def coordinate_weights(self) -> list[Array]:
        """The `weights` as those of the coordinates of the system (heights, coordinates)."""
        return [weights @ self.system.storeys.shapes for weights in self.weights]

    def linearized_rho(self) -> Array:
        """Correlation by linearization [-], (heights,); an error if there is no solution."""
        return correlation_of(self.linearized, *self.coordinate_weights)

    @cached_property
    def in_time(self) -> PairsInTime:
        """The structures in these motions by the drift closure; an error if there is none."""
        if missing := why_no_drift(self.structures):
            raise ValueError(missing)
        return lone_pair_in_time(self.structures, self.ground, self.course)

    def drift_rho(self) -> Array:
        """Correlation by the drift closure [-], (1,), while the shaking is strong."""
        return self.in_time.strong_rho()

    def passage_gaps(self) -> Array:
        """Gap by the drift closure in time [m], (1,)."""
        return self.in_time.required_gaps(self.confidence)

    def amplified_peaks(self) -> Array:
        """Quantile of the elastic peak ``|u|`` times ``D`` of linearization [m], as `peaks`.

        A ValueError or an ArithmeticError if there is none.
        """
        if self.has_storeys:
            raise ValueError(
                "the linearized amplification of Fig. 5b is only available for oscillators"
            )
        peaks = np.empty((len(self.structures), 1))
        sides = zip(self.elastic, self.coordinate_weights, strict=True)
        for n, (elastic, weights) in enumerate(sides):
            moments = response_moments(elastic)
            peak = peak_quantile(moments, self.strong_seconds, self.confidence, sides=2)
            amplification = self.linearized.std(weights) / elastic.values["displacement_std"]
            peaks[n] = amplification.item() * peak.item()
        return _finite(peaks)

    def combined_modes(self) -> tuple[Array, Array]:
        """Peak ``|u|`` by the CQC of elastic modes [m], as `peaks`, and its correlation (heights,).

        The peak of a mode is the quantile of that of its oscillator. An ArithmeticError or a
        ValueError if there is none.
        """
        modes = modes_of(self.system)
        moments = response_moments(solved_together((oscillators_of(modes),), self.ground))
        peaks = peak_quantile(moments, self.strong_seconds, self.confidence, sides=2).to_numpy()
        return combine_modes(modes, _finite(peaks), self.ground, self.weights)

    def effective_rho(self, rule: EffectiveRule) -> Array:
        """Correlation by a rule for effective properties of the first modes [-], (1,)."""
        arguments: dict[str, float] = {}
        sides = zip(self.modes, self.ductilities, strict=True)
        for n, (mode, ductility) in enumerate(sides, start=1):
            parameters = mode.arrays()
            arguments |= {f"{key}_{n}": float(parameters[key]) for key in ("period", "damping")}
            arguments[f"hardening_{n}"] = float(parameters["hardening"]) if mode.yields else 1.0
            arguments[f"ductility_{n}"] = float(ductility) if mode.yields else 1.0
        return np.atleast_1d(rho_effective(**arguments, rule=rule).rho.values)

    def linearized_gaps(self) -> Array:
        """Quantile of the peak of linearized ``u_1 - u_2``, or ``u_1`` if alone [m], (heights,)."""
        weights_1, *weights_2 = self.coordinate_weights
        apart = weights_1 - sum(weights_2)
        rows = self.linearized.spectral_moments(apart)
        moments = tuple(xr.DataArray(row[0]) for row in rows)
        gaps = peak_quantile(moments, self.strong_seconds, self.confidence, sides=1)
        alike = self.linearized.std(apart) < ROUNDING_OF_GAP * self.linearized.std(weights_1)
        return _finite(np.where(alike[0], 0.0, gaps.to_numpy()))

    def quantities(self) -> dict[str, Any]:
        """Variables of the table for the structures, by name."""
        table: dict[str, Any] = {}
        means, errors = mean_with_error(pair_peaks(self.motions))
        for n, structure in enumerate(self.structures):
            ductility = self.ductilities[n]
            if self.has_storeys:
                ductility = self.motions.ductility[self.motions.element_structure == n + 1].max()
            columns = {
                "peak_mean": means[n],
                "peak_mean_standard_error": errors[n],
                "peak": self.peaks[n, -1],
                "ductility": ductility if structure.yields else np.nan,
                "yield_displacement": self.yield_displacements[n],
                "reduction_factor": solved_reduction_factor(self.modes[n], self.elastic[n]),
            }
            table |= {f"{name}_{n + 1}": float(value) for name, value in columns.items()}
        if "collapse_probability" in self.motions:
            shares = self.motions.collapse_probability.values
            table |= {f"collapse_probability_{n}": share for n, share in enumerate(shares, start=1)}
        if self.has_storeys:
            names = ("peak_drift_mean", "peak_drift_mean_standard_error", "ductility")
            table |= {name: self.motions[name] for name in names}
        return table


def _finite(peaks: Array) -> Array:
    """Peaks by a formula; an ArithmeticError if there are none."""
    if not np.isfinite(peaks).all():
        raise ArithmeticError("not solved, or the motion is too short for a peak")
    return peaks


def peak_quantile(
    moments: Sequence[xr.DataArray], seconds: float, confidence: float, sides: int
) -> xr.DataArray:
    """Quantile of the peak of a Gaussian motion [m] at ``confidence``, by a Gumbel distribution."""
    l0, l1, l2 = moments
    peak = peak_table(l0, l1, l2, xr.DataArray(seconds), peak_factor_model("vanmarcke"), sides)
    reduced = -np.log(-np.log(confidence))
    return peak.peak_mean + GUMBEL_SCALE * (reduced - np.euler_gamma) * peak.peak_std


def all_rules(pair: PairInMotion, codes: Sequence[CodeRule]) -> list[Rule]:
    """All rules, including those that have no gap because something is missing.

    Rules of codes for the roof are applied at every level below it.
    """
    rules = [_solved(pair, *formula) for formula in _formulas(pair)]
    # Of a building that falls codes say nothing.
    peaks = np.where(np.isfinite(pair.peaks), pair.peaks, np.nan)
    arrays = {f"peak_{n}": peak for n, peak in enumerate(peaks, start=1)}
    if pair.has_storeys:
        arrays |= {f"height_{n}": pair.heights for n in range(1, len(peaks) + 1)}
    site = pair.site.with_arrays(arrays)
    return [*rules, *(code_row(code, site) for code in codes)]


def _solved(pair: PairInMotion, rule: Rule, solve: Callable[[], Gaps]) -> Rule:
    """A rule with its gaps, or with the reason why it has none."""
    try:
        if pair.alone and rule.kind == EQUATION_3:
            raise ValueError(NEEDS_SECOND_BUILDING)
        gaps, rhos = solve()
    except (ArithmeticError, ValueError) as error:
        return Rule(rule.name, rule.kind, np.full(pair.heights.size, np.nan), missing=str(error))
    return replace(rule, gaps=gaps, rhos=rhos)


def _formulas(pair: PairInMotion) -> Iterator[tuple[Rule, Callable[[], Gaps]]]:
    """Eq. (3) with each correlation, and rules without simulation, each with what solves it."""

    def eq_3(name: str, about: str, rho: Callable[[], Array], mark: str, source: str = "") -> Any:
        about = f"{PEAKS_OF_BOTH}; {about}"
        rule = Rule(f"eq_3_{name}", EQUATION_3, reference=source, mark=mark, assumptions=about)
        return rule, lambda: _equation_3(pair.peaks, rho())

    assumptions = "first passage with plastic drift in time; nothing simulated"
    passage = Rule("first_passage_drift", "first_passage", mark="C", assumptions=assumptions)
    yield passage, lambda: (pair.passage_gaps(), None)
    yield eq_3("linearized", "rho of linearization", pair.linearized_rho, "C")
    yield eq_3("drift", "rho with plastic drift in time", pair.drift_rho, "C")
    scatter = pair.motions.attrs.get("scatter", 0.0)
    without = f", without the scatter of {scatter:g} between motions" if scatter else ""
    unsimulated = (
        f"stationary for {pair.strong_seconds:.3g} s, Gaussian; nothing simulated{without}"
    )
    about = f"eq. (3) with elastic peaks times D; rho and D of linearization; {unsimulated}"
    paper = Rule("eq_3_paper", EQUATION_3, reference=EQUATION_3_SOURCE, mark="P", assumptions=about)
    yield paper, lambda: _equation_3(pair.amplified_peaks(), pair.linearized_rho())
    for rule in map(effective_rule, effective_rule_names()):
        rho = partial(pair.effective_rho, rule)
        yield eq_3(rule.name, RHO_AT_DUCTILITY, rho, rule.mark, rule.reference)
    about = f"{ELASTIC_MODES}; {unsimulated}"
    cqc = Rule("cqc", "response_spectrum", reference=CQC_SOURCE, mark="C", assumptions=about)
    yield cqc, partial(_cqc_gaps, pair)
    source = PEAK_FACTORS["Vanmarcke1975"].reference
    linear = Rule(
        "linearization", "linearization", reference=source, mark="C", assumptions=unsimulated
    )
    yield linear, lambda: (pair.linearized_gaps(), None)


def _equation_3(peaks: Array, rhos: Array) -> Gaps:
    """Gaps by eq. (3) with these peaks (2, heights) [m], and the correlations."""
    first, second = peaks
    falls = np.isposinf(first) | np.isposinf(second)
    gaps = np.where(falls, np.inf, equation_3(first, second, rhos))
    return gaps, np.broadcast_to(rhos, gaps.shape)


def _cqc_gaps(pair: PairInMotion) -> Gaps:
    """Response spectrum analysis of both buildings together, or of one building alone."""
    peaks, rhos = pair.combined_modes()
    return (peaks[0], None) if pair.alone else _equation_3(peaks, rhos)
