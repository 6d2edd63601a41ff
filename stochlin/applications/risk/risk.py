"""Mean annual frequency of pounding of two buildings, and the gap for an allowed frequency.

For one building it is the frequency of crossing its property line.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable, Mapping
from functools import reduce
from operator import and_
from typing import Any, NamedTuple

import numpy as np
import scipy.optimize
import xarray as xr

from stochlin.applications.risk.rates import SeparationsByIntensity, simulated_separations
from stochlin.applications.sites.intensity import scale_ground
from stochlin.applications.sites.simulated_spectra import PGA_STEP
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress, part_of
from stochlin.messages import ImplausibleInput, brief
from stochlin.models.arguments import (
    Duration,
    Metres,
    Paths,
    Scatter,
    Seed,
    Years,
    checked,
    is_number,
)
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground, scatter_of
from stochlin.models.hazards import Hazard, HazardCurve
from stochlin.models.plausible import PLAUSIBLE
from stochlin.models.structures import AnyStructure
from stochlin.models.uncertain import median_of
from stochlin.solver.simulation.prepared import FiniteMotion, PreparedStructures
from stochlin.solver.simulation.statistics import mean_with_error, pounding_shares
from stochlin.solver.tables import labels
from stochlin.solver.tables.cells import over_cells
from stochlin.solver.tables.checks import check_duration, standing

# fewest simulated intensities; an odd number, so that every other one includes both ends
SIMULATED_INTENSITIES = 25
# quantiles of all separations, as gaps for which the intensities have to be close enough
TYPICAL_QUANTILES = (0.25, 0.5, 0.75)
RETURN_PERIODS = (5.0, 2e5)  # [yr] of the lowest and highest intensity of a hazard without a table
ERRORS_OF_INTERVAL = 1.96  # standard errors from a mean to the ends of its 95 % interval
RISK_GAP_TOLERANCE = 1e-6  # relative tolerance of a required gap
HIGHEST_INTENSITY = 1e100  # intensity from which on nothing is added
ROUNDING_OF_HAZARD = 1e-12  # relative rounding error allowed at the end of a hazard curve
INTENSITY_UNITS = {"pga": "m/s^2", "sa": "m/s^2", "intensity": "m^2/s^3"}
_RISK = re.compile(r"\s*(\d++\.?\d*+|\.\d++)\s*%\s*in\s*(\d++\.?\d*+)\s*(?:yr|years|a)\s*")
RISK_REFERENCES = (
    "Cornell, C. A. (1968), Bull. Seismol. Soc. Am. 58; McGuire, R. K. (2004), Seismic Hazard and "
    "Risk Analysis."
)


@checked(uncertain=True)
def pounding_risk(
    first: AnyStructure,
    second: AnyStructure | None,
    ground: Ground,
    gap: Metres,
    hazard: Hazard,
    duration: Duration,
    *,
    envelope: Envelope | None = None,
    years: Years = 50.0,
    scatter: Scatter | None = None,
    paths: Paths = 1024,
    seed: Seed = 0,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Mean annual frequency of pounding of two buildings, from the hazard of the site.

    The mean annual frequency is ``Int P(pounding | im) |d lambda(im)|`` over the intensities ``im``
    of the hazard ``lambda``. The probability of pounding in ``t`` years is ``1 - exp(-rate t)``.
    The same motions are simulated at increasing intensities, which gives the intensities of
    pounding for each.

    Parameters
    ----------
    first, second, ground
        As in `separation`, with arrays over the cells of a table or `Uncertain` parameters. A
        ``reduction_factor`` refers to ``ground`` as given; the resulting strength in metres is the
        same at all intensities. If ``second`` is None, the result is for one building crossing its
        property line.
    gap : float
        Gap between the buildings, or distance of one building from its property line [m], positive.
    hazard : HazardCurve or PowerLawHazard
        Hazard of peak ground acceleration, ``Sa`` at a period, or ``S0``. The intensity of motions
        is their mean peak ground or spectral acceleration, as in `scale_ground`, or ``S0``.
    duration, envelope
        As in `separation`.
    years : float
        Time ``t`` [yr], positive.
    scatter
        As in `separation`.
    paths : int
        Number of motions at each of 25 intensities, or of 49 where the interpolation between 25 has
        a larger error than the motions.
    seed, progress
        As in `separation`.

    Returns
    -------
    xarray.Dataset
        Over the dimensions of the parameters: ``annual_rate`` [1/yr] with its standard error and
        its interval; ``annual_rate_unseen`` and ``annual_rate_unseen_weaker`` [1/yr], the largest
        possible contributions of intensities above the table of the hazard, or a return period of
        200 000 years, and of those below it; ``probability_in_years`` [-] with its interval. The
        intervals are those of 95 % of the sampling; their upper ends include both contributions.
        Also over ``intensity``: ``pounding_probability`` [-] with its 95 % interval. Also over
        ``from_intensity``: ``annual_rate_by_intensity`` [1/yr], the part of the rate from the
        interval of intensities that begins there.

    Raises
    ------
    ValueError, TypeError
        If the gap, the years or the hazard is out of range or of the wrong kind; otherwise as in
        `separation`.

    Notes
    -----
    A motion with pounding at an intensity and without pounding at a higher one counts for the
    former only. Shaking beyond the ends of a `HazardCurve` is left out of the rate. A motion
    without pounding at the highest intensity adds at most the frequency there to the upper end of
    the interval. For a motion with pounding below the lowest intensity the first two points are
    extrapolated, which is an upper limit for a curve that becomes flatter towards weaker shaking,
    as hazard curves do in logarithms.

    Motions of the same intensity differ as samples of a random process; the larger difference
    between earthquakes is included by ``scatter``.

    References
    ----------
    Cornell, C. A. (1968), Engineering seismic risk analysis, Bull. Seismol. Soc. Am. 58.

    Examples
    --------
    >>> import stochlin as sl
    >>> one, two = (sl.Bilinear(T, 0.05) for T in (0.6, 1.0))
    >>> ground = sl.named_ground("firm", intensity=0.01)
    >>> hazard = sl.PowerLawHazard(k0=0.01, k=2.5)
    >>> table = sl.pounding_risk(one, two, ground, 0.1, hazard, 20.0, paths=64)
    >>> bool(table.annual_rate_standard_error < 0.2 * table.annual_rate)
    True
    """
    motion = FiniteMotion(duration, envelope, scatter_of(ground, scatter), seed)
    structures = standing(first, second)
    simulation = RiskSimulation(structures, ground, hazard, motion, paths, progress)
    table = simulation.table("pounding_risk", lambda simulated: simulated.of_gap(gap, years))
    return table.assign_attrs(years=float(years), gap_m=float(gap))


@checked(uncertain=True)
def required_gap(
    first: AnyStructure,
    second: AnyStructure | None,
    ground: Ground,
    hazard: Hazard,
    duration: Duration,
    *,
    risk: str | float,
    envelope: Envelope | None = None,
    scatter: Scatter | None = None,
    paths: Paths = 1024,
    seed: Seed = 0,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Gap that two buildings need for an allowed risk of pounding.

    Parameters
    ----------
    first, second, ground, hazard, duration
        As in `pounding_risk`.
    risk : str or float
        Allowed risk, as a text such as ``"2 % in 50 years"``, or as a mean annual frequency [1/yr].
    envelope, scatter, paths, seed, progress
        As in `pounding_risk`.

    Returns
    -------
    xarray.Dataset
        Over the dimensions of the parameters: ``required_gap`` [m] with its interval, as that of
        ``annual_rate`` in `pounding_risk`; ``target_rate`` [1/yr], and ``annual_rate`` [1/yr] with
        this gap, with its standard error.

    Raises
    ------
    ValueError, TypeError
        If the risk cannot be read or is out of range, or is not between the smallest and the
        largest annual frequency of the hazard; otherwise as in `pounding_risk`.

    References
    ----------
    Cornell, C. A. (1968), Engineering seismic risk analysis, Bull. Seismol. Soc. Am. 58.

    Examples
    --------
    >>> import stochlin as sl
    >>> one, two = (sl.Bilinear(T, 0.05) for T in (0.6, 1.0))
    >>> ground = sl.named_ground("firm", intensity=0.01)
    >>> hazard = sl.PowerLawHazard(k0=0.01, k=2.5)
    >>> table = sl.required_gap(one, two, ground, hazard, 20.0, risk="10 % in 50 years", paths=64)
    >>> bool(abs(table.annual_rate / table.target_rate - 1) < 1e-3)
    True
    """
    if text := doubt_of_text(risk):
        warnings.warn(f"required_gap: risk {text}", ImplausibleInput, stacklevel=3)
    motion = FiniteMotion(duration, envelope, scatter_of(ground, scatter), seed)
    structures = standing(first, second)
    simulation = RiskSimulation(structures, ground, hazard, motion, paths, progress)
    table = simulation.table("required_gap", lambda simulated: simulated.gap_of(risk))
    return table.assign_attrs(risk=brief(risk))


def allowed_rate(risk: str | float) -> tuple[float, float | None]:
    """Mean annual frequency [1/yr] of an allowed risk, and the years in its text, if it is a text.

    The frequency of a text ``"p in t years"`` is ``-ln(1 - p)/t``.
    """
    if is_number(risk):
        if not 0 < risk < np.inf:
            raise ValueError(f"risk = {brief(risk)}; allowed: a positive annual frequency [1/yr]")
        return float(risk), None
    match = _RISK.fullmatch(risk) if isinstance(risk, str) else None
    share, years = (float(match[1]) / 100, float(match[2])) if match else (0.0, 0.0)
    if not 0 < share < 1 or not years > 0:
        allowed = (
            'such as "2 % in 50 years", above 0 and below 100 %, or an annual frequency [1/yr]'
        )
        raise ValueError(f"risk = {brief(risk)}; allowed: {allowed}")
    return -np.log1p(-share) / years, years


def doubt_of_text(risk: str | float) -> str:
    """What is implausible about a risk in words; numbers are judged as other arguments are."""
    rate, years = allowed_rate(risk)
    if years is None:
        return ""
    text = PLAUSIBLE["risk"].doubt(rate) or PLAUSIBLE["years of a risk"].doubt(years)
    return text and f"is doubtful: {brief(risk)} is {rate:.3g} a year; {text}"


def check_target(hazard: Hazard, risk: str | float) -> float:
    """The annual frequency of a risk [1/yr]; a ValueError if it is outside those of the hazard."""
    target, _ = allowed_rate(risk)
    intensities = simulated_at(hazard)
    rarest = float(hazard.frequency(intensities[-1]))
    commonest = float(hazard.frequency(intensities[0]))
    if not rarest < target < commonest:
        allowed = f"between {rarest:.3g} and {commonest:.3g} a year, as far as the hazard reaches"
        raise ValueError(f"risk = {brief(risk)} is {target:.3g} a year; allowed: {allowed}")
    return target


def simulated_at(hazard: Hazard) -> Array:
    """Simulated intensities, over the table of the hazard or over the range of `RETURN_PERIODS`."""
    if isinstance(hazard, HazardCurve):
        ends = hazard.intensities
    else:
        ends = tuple(float(hazard.intensity(years)) for years in RETURN_PERIODS)
    return np.geomspace(ends[0], ends[-1], SIMULATED_INTENSITIES)


def _with_both_errors(rates: Array, interpolation: float) -> tuple[float, float]:
    """Mean of the rates of the motions, and its error together with that of the interpolation."""
    mean, error = mean_with_error(rates)
    return float(mean), float(np.hypot(error, interpolation))


class SimulatedRisk(NamedTuple):
    """Separations in simulated motions of a site, from which the risk of any gap follows."""

    motions: SeparationsByIntensity
    hazard: Hazard

    def _frequency(self, intensity: Array) -> Array:
        """Annual frequency of exceedance [1/yr]; constant below a hazard table, zero beyond."""
        least = 0.0
        top = HIGHEST_INTENSITY
        if isinstance(self.hazard, HazardCurve):
            least = self.hazard.intensities[0]
            top = self.hazard.intensities[-1]
        frequencies = self.hazard.frequency(xr.DataArray(np.clip(intensity, least, top)))
        return np.where(intensity > top * (1 + ROUNDING_OF_HAZARD), 0.0, np.asarray(frequencies))

    def rates(self, gap: float) -> Array:
        """Annual frequency of pounding [1/yr] of each motion in each interval (paths, n + 1).

        Its mean over the motions is the mean annual frequency of the interval of intensities.
        """
        begin, end = self.motions.crossings(gap)
        return np.maximum(self._frequency(begin) - self._frequency(end), 0.0)

    def rate(self, gap: float) -> tuple[float, float]:
        """Mean annual frequency of pounding [1/yr], and its standard error.

        The latter is that of the motions together with `quadrature_error`.
        """
        return _with_both_errors(self.rates(gap).sum(axis=1), self.quadrature_error(gap))

    def quadrature_error(self, gap: float) -> float:
        """Error [1/yr] of the rate by the interpolation between intensities.

        It is about as large as the change of the rate with half of the intensities. With these the
        error is two to four times as large, since motions of yielding structures pound at some
        intensities and not at stronger ones.
        """
        coarser = self._replace(motions=self.motions.every_other())
        change = (self.rates(gap).sum(axis=1) - coarser.rates(gap).sum(axis=1)).mean()
        return abs(float(change))

    def is_coarse(self) -> bool:
        """Whether the error by the interpolation exceeds that of the motions for a typical gap."""
        gaps = self.motions.separation[np.isfinite(self.motions.separation)]
        for gap in np.quantile(gaps, TYPICAL_QUANTILES) if gaps.size else ():
            _, error = mean_with_error(self.rates(gap).sum(axis=1))
            if self.quadrature_error(gap) > error:
                return True
        return False

    def unseen_rates(self, gap: float) -> tuple[Array, Array]:
        """Largest annual frequency of pounding [1/yr] above and below the table, of each motion.

        A motion without pounding at the highest intensity may pound right above it. Below the table
        the line through its first two points is extrapolated to where the gap is reached.
        """
        highest = self._frequency(self.motions.intensity[-1:])
        stronger = np.where(self.motions.separation[:, -1] <= gap, highest, 0.0)
        if not isinstance(self.hazard, HazardCurve):
            return stronger, np.zeros_like(stronger)
        first, second = np.log(self.hazard.intensities[:2])
        rate, next_rate = np.log(self.hazard.frequencies[:2])
        begins = np.log(self.motions.crossings(gap)[0][:, 0])
        further = (rate - next_rate) / (second - first) * np.maximum(first - begins, 0.0)
        return stronger, np.exp(rate) * np.expm1(further)

    def rate_with_ends(self, gap: float) -> dict[str, float]:
        """Annual frequency of pounding [1/yr] and its interval, by the ends of variable names.

        The upper end includes the largest frequencies beyond the table of the hazard.
        """
        rates = self.rates(gap).sum(axis=1)
        stronger, weaker = self.unseen_rates(gap)
        interpolation = self.quadrature_error(gap)
        mean, error = _with_both_errors(rates, interpolation)
        most, error_of_most = _with_both_errors(rates + stronger + weaker, interpolation)
        lower = max(mean - ERRORS_OF_INTERVAL * error, 0.0)
        upper = most + ERRORS_OF_INTERVAL * error_of_most
        ends = mean, lower, upper
        return dict(zip(labels.VALUE_AND_ENDS, ends, strict=True))

    def of_gap(self, gap: float, years: float) -> xr.Dataset:
        """The result of `pounding_risk`."""
        motions = self.motions
        hazard = self.hazard
        _, error = self.rate(gap)
        rates = self.rate_with_ends(gap)
        stronger, weaker = self.unseen_rates(gap)
        # A table has the same intensities in all cells, also where others were added between them.
        step = (motions.intensity.size - 1) // (SIMULATED_INTENSITIES - 1)
        shown = motions.intensity[::step]
        intervals = np.arange(1, motions.intensity.size, step)
        by_interval = self.rates(gap).mean(axis=0)
        by_interval = np.add.reduceat(by_interval, [0, *intervals, motions.intensity.size])
        attrs = {
            "units": INTENSITY_UNITS[hazard.measure],
            "long_name": f"intensity, {hazard.measure}",
        }
        axis = {"intensity": ("intensity", shown, attrs)}
        samples = xr.DataArray(
            motions.separation[:, ::step], dims=("path", "intensity"), coords=axis
        )
        begin = {"from_intensity": ("from_intensity", np.append(0.0, shown), attrs)}
        return xr.Dataset(
            {
                **{f"annual_rate{end}": rate for end, rate in rates.items()},
                "annual_rate_standard_error": error,
                "annual_rate_unseen": float(stronger.mean()),
                "annual_rate_unseen_weaker": float(weaker.mean()),
                "annual_rate_by_intensity": ("from_intensity", by_interval),
                **{
                    f"probability_in_years{end}": -np.expm1(-rate * years)
                    for end, rate in rates.items()
                },
                **{
                    f"pounding_{name}": share
                    for name, share in pounding_shares(samples, gap).items()
                },
            },
            begin,
        )

    def gap_of(self, risk: str | float) -> xr.Dataset:
        """The result of `required_gap`."""
        target = check_target(self.hazard, risk)
        separation = self.motions.separation
        least = 1e-3 * float(separation.min() or 1e-6)
        most = 2 * float(separation.max(where=separation < np.inf, initial=least))

        def gap_at(end: str) -> float:
            """Gap [m] for which the rate, or an end of its interval, equals the target."""

            def excess(log_gap: float) -> float:
                return self.rate_with_ends(float(np.exp(log_gap)))[end] - target

            low, high = np.log(least), np.log(most)
            if excess(high) > 0:  # of motions in which a structure falls
                return np.inf
            if excess(low) <= 0:
                return 0.0
            return float(np.exp(scipy.optimize.brentq(excess, low, high, xtol=RISK_GAP_TOLERANCE)))

        gaps = {f"required_gap{end}": gap_at(end) for end in labels.VALUE_AND_ENDS}
        mean, error = self.rate(gap) if (gap := gaps["required_gap"]) else (np.nan, np.nan)
        rate = {"annual_rate": mean, "annual_rate_standard_error": error}
        return xr.Dataset({**gaps, "target_rate": target, **rate})


class RiskSimulation(NamedTuple):
    """Structures, ground and hazard of a risk, and the motions simulated at each intensity.

    The ``structures`` are those of `pounding_risk`, by the names of their arguments.
    """

    structures: Mapping[str, AnyStructure]
    ground: Ground
    hazard: Hazard
    motion: FiniteMotion
    paths: int
    progress: Progress | None = None

    def run(self) -> SimulatedRisk:
        """Simulated motions at all intensities of the hazard.

        Raises an error for a duration shorter than a period, or too much work.
        """
        hazard = self.hazard
        motion = self.motion
        levels = simulated_at(hazard)
        prepared = PreparedStructures.of(
            self.structures, self.ground, motion, self.paths, SIMULATED_INTENSITIES
        )
        usual = prepared.usual
        power = 0.5
        unit_intensity = 1.0  # S0 of motions with the intensity 1 in the measure of the hazard
        if hazard.measure != "intensity":
            goal: dict[str, Any] = {hazard.measure: 1.0, "period": hazard.period}
            scaled = scale_ground(usual, motion.duration, motion.envelope, seed=motion.seed, **goal)
            power = 1.0
            unit_intensity = float(scaled.arrays()["intensity"])

        def simulated(levels: Array, part: Progress | None) -> SeparationsByIntensity:
            factors = unit_intensity / float(usual.arrays()["intensity"]) * levels ** (2 * power)
            return simulated_separations(prepared, levels, factors, power, self.paths, part)

        risk = SimulatedRisk(simulated(levels, part_of(self.progress, 0.0, 0.5)), hazard)
        if risk.is_coarse():
            between = np.sqrt(levels[:-1] * levels[1:])
            further = simulated(between, part_of(self.progress, 0.5, 1.0))
            risk = risk._replace(motions=risk.motions.joined(further))
        return risk

    def table(self, call: str, result: Callable[[SimulatedRisk], xr.Dataset]) -> xr.Dataset:
        """A ``result`` in every cell of structures and ground; NaN where a period is too long."""
        duration = self.motion.duration
        envelope = self.motion.envelope
        medians = {role: median_of(structure) for role, structure in self.structures.items()}
        check_duration(duration, medians)
        long_enough = reduce(
            and_, (structure.first_period() <= duration for structure in medians.values())
        )

        def of_cell(ground: Ground, **structures: AnyStructure) -> xr.Dataset:
            return result(self._replace(structures=structures, ground=ground).run())

        models = {**self.structures, "ground": self.ground}
        table = labels.label(over_cells(of_cell, models, long_enough))
        alone = len(self.structures) == 1
        what = "one structure crossing its property line" if alone else "pounding of two structures"
        return labels.with_run_information(
            table.assign_attrs(
                paths=self.paths,
                seed=self.motion.seed,
                duration_s=float(duration),
                envelope="none" if envelope is None else envelope.describe(),
                measure=self.hazard.measure,
                **({"pga_step_s": PGA_STEP} if self.hazard.measure == "pga" else {}),
                **labels.of_scatter(self.motion.scatter),
            ),
            f"Risk of {what}, {median_of(self.ground).name} ground",
            f"{call}(duration={duration:g}, paths={self.paths}, seed={self.motion.seed})",
            {**models, "hazard": self.hazard},
            RISK_REFERENCES,
        )
