"""Mean annual frequency of pounding of two buildings, and the gap for an allowed frequency.

For one building it is the frequency of crossing its property line.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, reduce
from operator import and_
from typing import Any

import numpy as np
import scipy.optimize
import xarray as xr

from stochlin.applications.risk.rates import SeparationsByIntensity, rates, simulated_separations
from stochlin.applications.sites.intensity import scale_ground
from stochlin.applications.sites.simulated_spectra import PGA_STEP
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.messages import DoubtfulInput, brief
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
from stochlin.models.grounds import Ground
from stochlin.models.hazards import Hazard, HazardCurve
from stochlin.models.systems import AnyStructure, first_period
from stochlin.models.uncertain import applied, median_of
from stochlin.solver.linearization.strength import strength_in_metres
from stochlin.solver.simulation.finite_motions import (
    exceedance,
    mean_with_error,
)
from stochlin.solver.simulation.simulation import check_repeated
from stochlin.solver.tables import labels
from stochlin.solver.tables.cells import over_cells
from stochlin.solver.tables.checks import check_duration, standing

POINTS = 13  # number of simulated intensities
RETURN_PERIODS = (5.0, 2e5)  # [yr] of the lowest and highest intensity of a hazard without a table
CERTAIN = 1.96  # standard errors to each side of a 95 % interval
WEAKEST = 0.1  # largest pounding probability at the lowest intensity of a hazard without a warning
OF_HAZARD, NARROWEST = (1e-100, 1e100), 1e-9  # intensities of a hazard, and least share between two
CLOSE = 1e-6  # relative tolerance of a required gap
ROUNDING = 1e-12  # relative rounding error allowed at the end of a hazard curve
UNITS = {"pga": "m/s^2", "sa": "m/s^2", "intensity": "m^2/s^3"}
_RISK = re.compile(r"\s*(\d++\.?\d*+|\.\d++)\s*%\s*in\s*(\d++\.?\d*+)\s*(?:yr|years|a)\s*")
REFERENCES = (
    "Cornell, C. A. (1968), Bull. Seismol. Soc. Am. 58; McGuire, R. K. (2004), Seismic Hazard and Risk "
    "Analysis."
)


@checked
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
    scatter: Scatter = 0.0,
    paths: Paths = 1024,
    seed: Seed = 0,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Mean annual frequency of pounding of two buildings, from the hazard of the site.

    The mean annual frequency is ``Int P(pounding | im) |d lambda(im)|`` over the intensities ``im`` of
    the hazard ``lambda``. The probability of pounding in ``t`` years is ``1 - exp(-rate t)``. The same
    motions are simulated at increasing intensities, which gives the intensities of pounding for each.

    Parameters
    ----------
    first, second, ground
        As in `separation`, with arrays over the cells of a table or `Uncertain` parameters. A
        ``reduction_factor`` refers to ``ground`` as given; the resulting strength in metres is the same
        at all intensities. If ``second`` is None, the result is for one building crossing its property
        line.
    gap : float
        Gap between the buildings, or distance of one building from its property line [m], positive.
    hazard : HazardCurve or PowerLawHazard
        Hazard of peak ground acceleration, ``Sa`` at a period, or ``S0``. The intensity of motions is
        their mean peak ground or spectral acceleration, as in `scale_ground`, or ``S0``.
    duration, envelope
        As in `separation`.
    years : float
        Time ``t`` [yr], positive.
    scatter
        As in `separation`.
    paths : int
        Number of motions at each of 13 intensities.
    seed, progress
        As in `separation`.

    Returns
    -------
    xarray.Dataset
        Over the dimensions of the parameters: ``annual_rate`` [1/yr] with its standard error;
        ``annual_rate_unseen`` [1/yr], the largest possible contribution of intensities beyond the table
        of the hazard, or beyond a return period of 200 000 years; ``probability_in_years`` [-] with its
        95 % interval. Also over ``intensity``: ``pounding_probability`` [-] with its 95 % interval. Also
        over ``from_intensity``: ``annual_rate_by_intensity`` [1/yr], the part of the rate from the
        interval of intensities that begins there.

    Raises
    ------
    ValueError, TypeError
        If the gap, the years or the hazard is out of range or of the wrong kind; otherwise as in
        `separation`.

    Notes
    -----
    A motion with pounding at an intensity and without pounding at a higher one counts for the former
    only. Motions of the same intensity differ as samples of a random process; the larger difference
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

    def of_cell(ground: Ground, **structures: AnyStructure) -> xr.Dataset:
        motion = duration, envelope, scatter, paths, seed, progress
        return SimulatedRisk(structures, ground, hazard, *motion).of_gap(gap, years)

    return _over_cells(of_cell, standing(first, second), ground, duration)


@checked
def required_gap(
    first: AnyStructure,
    second: AnyStructure | None,
    ground: Ground,
    hazard: Hazard,
    duration: Duration,
    *,
    risk: str | float,
    envelope: Envelope | None = None,
    scatter: Scatter = 0.0,
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
        Over the dimensions of the parameters: ``required_gap`` [m] with its 95 % interval,
        ``target_rate`` [1/yr], and ``annual_rate`` [1/yr] with this gap, with its standard error.

    Raises
    ------
    ValueError, TypeError
        If the risk cannot be read or is out of range, or is not between the smallest and the largest
        annual frequency of the hazard; otherwise as in `pounding_risk`.

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

    def of_cell(ground: Ground, **structures: AnyStructure) -> xr.Dataset:
        motion = duration, envelope, scatter, paths, seed, progress
        return SimulatedRisk(structures, ground, hazard, *motion).gap_of(risk)

    return _over_cells(of_cell, standing(first, second), ground, duration)


def _over_cells(
    of_cell: Callable[..., xr.Dataset], structures: dict[str, Any], ground: Ground, duration: float
) -> xr.Dataset:
    """``of_cell`` for every cell of structures and ground; NaN if a period exceeds the duration."""
    both = {role: median_of(structure) for role, structure in structures.items()}
    check_duration(duration, both)
    long_enough = reduce(and_, (first_period(structure) <= duration for structure in both.values()))
    return over_cells(of_cell, {**structures, "ground": ground}, long_enough)


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
        raise ValueError(
            f'risk = {brief(risk)}; allowed: a text as "2 % in 50 years" of more than 0 % and less than '
            "100 %, or an annual frequency [1/yr]"
        )
    return -np.log1p(-share) / years, years


def check_target(hazard: Hazard, risk: str | float) -> float:
    """The annual frequency of a risk [1/yr]; a ValueError if it is outside of those of the hazard."""
    target, _ = allowed_rate(risk)
    rarest, commonest = (float(hazard.frequency(im)) for im in simulated_at(hazard)[[-1, 0]])
    if not rarest < target < commonest:
        raise ValueError(
            f"risk = {brief(risk)} is {target:.3g} a year; allowed: between {rarest:.3g} and "
            f"{commonest:.3g} a year, the rarest and the most frequent shaking of the hazard; give "
            "a hazard that reaches it"
        )
    return target


def simulated_at(hazard: Hazard) -> Array:
    """Simulated intensities, over the table of the hazard or over the range of `RETURN_PERIODS`."""
    if isinstance(hazard, HazardCurve):
        ends = hazard.intensities
    else:
        ends = tuple(float(hazard.intensity(years)) for years in RETURN_PERIODS)
        (least, most), (low, high), (short, long) = OF_HAZARD, ends, RETURN_PERIODS
        if not least < low * (1 + NARROWEST) < high < most:
            raise ValueError(
                f"hazard: {hazard.describe()} has intensities of {low:.4g} and {high:.4g} "
                f"{UNITS[hazard.measure]} at return periods of {short:g} and {long:g} years; allowed: "
                f"two that differ, from {least:g} to {most:g}; k is usually 2 to 4, so correct k0 or k"
            )
    return np.geomspace(ends[0], ends[-1], POINTS)


@dataclass(frozen=True)
class SimulatedRisk:
    """Simulated motions of structures at a site, from which the risk of any gap follows."""

    structures: Mapping[str, AnyStructure]  # by the names of their arguments
    ground: Ground
    hazard: Hazard
    duration: float
    envelope: Envelope | None
    scatter: float
    paths: int
    seed: int
    progress: Progress | None

    @cached_property
    def motions(self) -> SeparationsByIntensity:
        """Separations in the same motions at all intensities.

        Raises an error for a duration shorter than a period, or too much work.
        """
        both = {role: median_of(structure) for role, structure in self.structures.items()}
        ground, levels = median_of(self.ground), simulated_at(self.hazard)
        check_duration(self.duration, both)
        check_repeated(list(both.values()), ground, self.duration, self.paths, POINTS)
        pair = [
            applied(lambda s: strength_in_metres(s, ground), each) for each in self.structures.values()
        ]
        power = 0.5 if self.hazard.measure == "intensity" else 1.0
        factors = (
            self._ground_of_one(ground) / float(ground.arrays()["intensity"]) * levels ** (2 * power)
        )
        motion: dict[str, Any] = {"duration": self.duration, "envelope": self.envelope}
        motion |= {"paths": self.paths, "seed": self.seed, "scatter": self.scatter}
        return simulated_separations(pair, self.ground, levels, factors, power, self.progress, **motion)

    def _ground_of_one(self, ground: Ground) -> float:
        """``S0`` [m^2/s^3] of motions with the intensity 1 in the measure of the hazard."""
        if self.hazard.measure == "intensity":
            return 1.0
        goal: dict[str, Any] = {self.hazard.measure: 1.0, "period": self.hazard.period}
        scaled = scale_ground(ground, self.duration, self.envelope, seed=self.seed, **goal)
        return float(scaled.arrays()["intensity"])

    def _frequency(self, intensity: Array) -> Array:
        """Annual frequency of exceedance [1/yr]; constant below a table of the hazard, zero beyond."""
        known, top = intensity, np.inf
        if isinstance(self.hazard, HazardCurve):
            least, top = self.hazard.intensities[0], self.hazard.intensities[-1]
            known = np.clip(intensity, least, top)
        frequencies = np.asarray(self.hazard.frequency(xr.DataArray(known)))
        if (lost := np.isinf(frequencies)).any():
            raise ValueError(
                f"hazard: {self.hazard.describe()} gives annual frequencies beyond the range of numbers "
                f"for {known[lost].min():.3g} {UNITS[self.hazard.measure]}, at which motions still "
                "count; allowed: a smaller k; usual are 2 to 4"
            )
        return np.where(intensity > top * (1 + ROUNDING), 0.0, frequencies)

    def of_gap(self, gap: float, years: float) -> xr.Dataset:
        """The result of `pounding_risk`."""
        motions = self.motions
        by_path = rates(motions, gap, self._frequency)
        rate, error = mean_with_error(by_path.sum(axis=1))
        self._warn_of_weak(gap)
        spared = float((motions.separation[:, -1] <= gap).mean())
        table = xr.Dataset(
            {
                "annual_rate": rate,
                "annual_rate_standard_error": error,
                "annual_rate_unseen": spared * float(self._frequency(motions.intensity[-1:])[0]),
                **_in_years(rate, error, years),
                **_by_intensity(motions, by_path, gap, self.hazard.measure),
            }
        )
        return self._labelled(table.assign_attrs(years=float(years), gap_m=float(gap)), "pounding_risk")

    def gap_of(self, risk: str | float) -> xr.Dataset:
        """The result of `required_gap`."""
        target = check_target(self.hazard, risk)
        separation = self.motions.separation
        least = 1e-3 * float(separation.min() or 1e-6)
        most = 2 * float(separation.max(where=separation < np.inf, initial=least))

        def rate(gap: float) -> tuple[float, float]:
            return mean_with_error(rates(self.motions, gap, self._frequency).sum(axis=1))

        def gap_at(errors: float) -> float:
            """Gap [m] for which the rate, and so many standard errors, equal the target."""

            def excess(gap: float) -> float:
                mean, error = rate(gap)
                return mean + errors * error - target

            if excess(most) > 0:  # of motions in which a structure falls
                return np.inf
            if excess(least) <= 0:
                return 0.0
            ends = np.log(least), np.log(most)
            return float(np.exp(scipy.optimize.brentq(lambda x: excess(np.exp(x)), *ends, xtol=CLOSE)))

        gap = gap_at(0.0)
        mean, error = rate(gap) if gap else (np.nan, np.nan)
        table = xr.Dataset(
            {
                "required_gap": gap,
                "required_gap_lower": gap_at(-CERTAIN),
                "required_gap_upper": gap_at(CERTAIN),
                "target_rate": target,
                "annual_rate": mean,
                "annual_rate_standard_error": error,
            }
        )
        return self._labelled(table.assign_attrs(risk=brief(risk)), "required_gap")

    def _labelled(self, table: xr.Dataset, call: str) -> xr.Dataset:
        """The table with units and run information."""
        models: dict[str, Any] = {**self.structures, "ground": self.ground, "hazard": self.hazard}
        alone = len(self.structures) == 1
        what = "one structure crossing its property line" if alone else "pounding of two structures"
        return labels.with_run_information(
            labels.label(table).assign_attrs(
                paths=self.paths,
                seed=self.seed,
                duration_s=float(self.duration),
                envelope="none" if self.envelope is None else self.envelope.describe(),
                measure=self.hazard.measure,
                **({"pga_step_s": PGA_STEP} if self.hazard.measure == "pga" else {}),
                **labels.of_scatter(self.scatter),
            ),
            f"Risk of {what}, {median_of(self.ground).name} ground",
            f"{call}(duration={self.duration:g}, paths={self.paths}, seed={self.seed})",
            models,
            REFERENCES,
        )

    def _warn_of_weak(self, gap: float) -> None:
        """Warn if pounding is likely also below the lowest intensity of the hazard."""
        motions, hazard = self.motions, self.hazard
        share = float((motions.separation[:, 0] > gap).mean())
        if isinstance(hazard, HazardCurve) and share > WEAKEST:
            met = "it crosses" if len(self.structures) == 1 else "they pound"
            warnings.warn(
                f"hazard: it begins at {motions.intensity[0]:.3g} {UNITS[hazard.measure]}, where {met} "
                f"in {100 * share:.0f} % of the motions; weaker shaking, which is not in the hazard, "
                "is left out: start the hazard at lower intensities",
                DoubtfulInput,
                stacklevel=5,
            )


def _by_intensity(
    motions: SeparationsByIntensity, by_path: Array, gap: float, measure: str
) -> dict[str, xr.DataArray]:
    """Pounding probability at each intensity, and the part of the rate of each interval."""
    attrs = {"units": UNITS[measure], "long_name": f"intensity, {measure}"}
    axis = {"intensity": ("intensity", motions.intensity, attrs)}
    samples = xr.DataArray(motions.separation, dims=("path", "intensity"), coords=axis)
    columns = {f"pounding_{name}": array for name, array in exceedance(samples, gap).items()}
    begin = {"from_intensity": ("from_intensity", np.append(0.0, motions.intensity), attrs)}
    by_interval = xr.DataArray(by_path.mean(axis=0), dims="from_intensity", coords=begin)
    return columns | {"annual_rate_by_intensity": by_interval}


def _in_years(rate: float, error: float, years: float) -> dict[str, float]:
    ends = {"": 0.0, "_lower": -CERTAIN, "_upper": CERTAIN}
    return {
        f"probability_in_years{end}": float(-np.expm1(-max(rate + times * error, 0.0) * years))
        for end, times in ends.items()
    }
