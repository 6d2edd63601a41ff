"""The tables [site] and [motion] of a case file: ground, fitted motion, envelope and scatter."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from itertools import islice
from pathlib import Path
from typing import Any, NamedTuple

import xarray as xr

from stochlin.analyses.cases.files.known import Known, name_of
from stochlin.analyses.cases.files.quantities import Quantity
from stochlin.analyses.cases.files.sections import Section
from stochlin.analyses.cases.sites.design_spectrum import (
    SPECTRUM,
    design_spectrum,
    ground_of_design,
    spectrum_file,
)
from stochlin.analyses.cases.sites.records import SUITE, read_suite, recorded_motions, scaled_suite
from stochlin.analyses.cases.sites.strength import (
    EXAMPLE,
    GOALS,
    HAZARD,
    INTENSITY,
    Goal,
    as_strong_as_asked,
    doubtful_hazard,
    hazard_file,
    read_goal,
    read_hazard_of,
)
from stochlin.analyses.records.ground_fit import fitted_grounds
from stochlin.analyses.records.spectra import ESTIMATORS
from stochlin.analyses.sites.ground_fit import fit_ground
from stochlin.analyses.sites.motion_fit import (
    FILTERS,
    OTHER_COMPONENT,
    USES,
    FittedMotion,
    UsualScatter,
    between_components,
    checked_components,
    energy_ratio,
    fit_motion,
)
from stochlin.kernels.basics.parallel import Progress
from stochlin.models.arguments import SCATTER
from stochlin.models.envelopes import ENVELOPES, Envelope
from stochlin.models.grounds import GROUNDS, Ground, ParallelGround, WhiteNoise
from stochlin.models.grounds.named import ground_names, named_ground
from stochlin.models.hazards import Hazard
from stochlin.models.uncertain import UncertainModel, median_of

FITTED, NONE, PARALLEL = "fitted", "none", "parallel"
# Keys to which the accelerations of a code are proportional; of a file it is its scale.
STRENGTHS = {"eurocode_8": "ag", "asce_7": ""}
RECORDS = ("records", SUITE)
_LIKE = 0.8, 1.25  # range of the energy of motions over that of a record without a warning


class Course(NamedTuple):
    """Duration [s] and envelope of the motions of a case."""

    duration: float
    envelope: Envelope | None


class Shaking(NamedTuple):
    """Ground of a case, its model with uncertain parameters if there are any, and its spectrum."""

    ground: Ground
    uncertain: UncertainModel | None
    spectrum: xr.DataArray | None

    def times(self, factor: float) -> Shaking:
        """The shaking with its accelerations multiplied by a factor."""
        if factor == 1.0:
            return self
        grown = partial(_with_intensity, factor=factor**2)
        uncertain = self.uncertain.changed(grown) if self.uncertain else None
        spectrum = self.spectrum
        if spectrum is not None:
            spectrum = (factor * spectrum).assign_attrs(spectrum.attrs)
        return Shaking(grown(self.ground), uncertain, spectrum)


@dataclass(frozen=True)
class CaseSite:
    """The tables [site] and [motion]; grounds are fitted and scaled when they are first needed.

    ``given`` is the ground by name or by parameters, and ``written`` the course of the motions; each is
    None where it is fitted. ``spectrum`` is as written, without the wanted strength; ``goal`` is this.
    """

    site: Section
    motion: Section
    inputs: tuple[Path, ...]
    single_records: Mapping[str, xr.DataArray]
    suite: dict[str, xr.DataArray]
    hazard: Hazard | None
    goal: Goal | None
    spectrum: xr.DataArray | None
    given: Any
    written: Course | None
    known: Known = field(default_factory=Known, repr=False)

    @property
    def name(self) -> str:
        """Ground or spectrum as written in the file."""
        return self.site.text("ground" if self.spectrum is None else SPECTRUM)

    @property
    def components(self) -> dict[str, xr.DataArray]:
        """The first record, or the first two, to which ground and course are fitted."""
        return dict(islice(self.single_records.items(), self.motion.read("components")))

    @cached_property
    def fitted_motion(self) -> FittedMotion:
        """Ground and course fitted to the first records, where the file asks for both."""
        try:
            return fit_motion(self.components, filters=_filters(self.site))
        except (ArithmeticError, ValueError) as error:
            names = " and ".join(self.components)
            raise self.motion.error("envelope", f"cannot be fitted to {names}: {error}") from error

    @cached_property
    def usual_scatter(self) -> UsualScatter:
        """Default scatter: 0 for one ground by name or by parameters, else that of its use."""
        if self.name in (*ground_names(), *GROUNDS):
            return UsualScatter(0.0, "")
        if self.written is None and len(self.components) == 2:
            return between_components(checked_components(self.components))
        return USES[OTHER_COMPONENT if self.name == FITTED else SPECTRUM]

    @cached_property
    def course(self) -> Course:
        """Duration and envelope of the motions."""
        if self.written is None:
            return Course(self.fitted_motion.duration, self.fitted_motion.envelope)
        return self.written

    @cached_property
    def shaking(self) -> Shaking:
        """The ground as strong as it is wanted, and the spectrum with its strength."""
        return self.settled() if self._sought else self._shaking()

    def settled(self, progress: Progress | None = None) -> Shaking:
        """The same for a ground that is sought; ``progress`` is called with the share that is done."""
        shaking, strength = self.known.of(
            *self._shape, lambda: (self._shaking(progress), self.stated_strength[1])
        )
        return shaking.times(self.stated_strength[1] / strength)

    @property
    def waits(self) -> bool:
        """Whether the ground has to be fitted or scaled by simulation when it is first needed."""
        return self._sought and name_of(*self._shape) not in self.known

    @property
    def _sought(self) -> bool:
        """Whether the ground is not given by its parameters alone."""
        return self.given is None or self.goal is not None

    @property
    def _strength_key(self) -> str:
        """The key to whose value the accelerations are proportional; empty if there is none."""
        if self.goal is not None:
            return self.goal.key if self.goal.key in ("pga", "sa") else ""
        return "" if self.spectrum is None else STRENGTHS.get(self.name, "scale")

    @property
    def by_intensity(self) -> bool:
        """Whether the file states the strength by S0."""
        return INTENSITY in self.site

    @property
    def stated_strength(self) -> tuple[str, float]:
        """The key with its value that accelerations are proportional to; 1 for what has no such key."""
        key = self._strength_key
        return key, float(self.site.read(key)) if key in self.site else 1.0

    @property
    def _shape(self) -> tuple[str, Any]:
        """All of which a fit or a simulation depends but the strength."""
        site = {key: value for key, value in self.site.values.items() if key != self._strength_key}
        motion = {key: value for key, value in self.motion.values.items() if key != "scatter"}
        return "shaking", [self._strength_key, site, motion]

    def _shaking(self, progress: Progress | None = None) -> Shaking:
        """The shaking, fitted and scaled now."""
        described = self._described(progress)
        ground = median_of(described)
        scaled, spectrum = as_strong_as_asked(
            *(self.site, self.goal, ground, self.spectrum, *self.course), progress
        )
        if not isinstance(described, UncertainModel):
            return Shaking(scaled, None, spectrum)
        old, new = (float(each.arrays()["intensity"]) for each in (ground, scaled))
        return Shaking(scaled, described.changed(partial(_with_intensity, factor=new / old)), spectrum)

    def _described(self, progress: Progress | None) -> Any:
        """The ground before it is scaled to the wanted strength."""
        if self.written is None:
            return self.fitted_motion.ground
        if self.spectrum is not None:
            return ground_of_design(self.site, self.spectrum, *self.written, progress)
        if self.given is not None:
            return self.given
        name, record = next(iter(self.single_records.items()))
        try:
            ground = fit_ground(record, _model(self.site), _estimator(self.site))
        except ValueError as error:
            raise self.site.error("ground", f"cannot be fitted to {name}: {error}") from error
        _doubt_energy(self.motion, record, ground, self.written)
        return ground

    @property
    def recorded(self) -> bool:
        """Whether there are records; none of them has to be scaled to say so."""
        return bool(self.single_records or self.suite)

    @cached_property
    def records(self) -> Mapping[str, xr.DataArray]:
        """The single records followed by those of the suite, which are scaled to its goal."""
        spectrum = self.spectrum if self.goal is None or not self.suite else self.shaking.spectrum
        return {**self.single_records, **scaled_suite(self.site, self.suite, spectrum)}


def read_site(site: Section, motion: Section, folder: Path, known: Known) -> CaseSite:
    """The tables [site] and [motion], with the records and other files of the site.

    Nothing is fitted or simulated yet, and no file is read that is known. A ValueError names what is not
    valid.
    """
    values = site.values
    records = known.of("records", values.get("records"), lambda: recorded_motions(site, folder))
    spectrum = design_spectrum(site, folder, known) if SPECTRUM in site else None
    given, written = None, None
    if motion.values.get("envelope") == FITTED:
        _check_fitted_motion(site, motion, records)
    else:
        envelope = read_envelope(motion)
        written = Course(motion.read("duration"), envelope)
        if envelope and (doubt := envelope.doubt(written.duration)):
            motion.doubt("duration", f"is doubtful: {doubt}")
        if spectrum is None:
            given = read_ground(site, records)
        else:
            site.read("filters")
    hazard = known.of(HAZARD, values.get(HAZARD), lambda: read_hazard_of(site, folder))
    if hazard is not None and (doubt := doubtful_hazard(hazard)):
        site.doubt(HAZARD, f"is doubtful: {doubt}")
    suite, of_suite = known.of(
        SUITE, values.get(SUITE), lambda: read_suite(site, folder, records, spectrum)
    )
    inputs = (
        *spectrum_file(site, folder),
        *hazard_file(site, folder),
        *(folder / record.text("path") for record in site.sections("records")),
        *of_suite,
    )
    goal = read_goal(site, hazard)
    return CaseSite(site, motion, inputs, records, suite, hazard, goal, spectrum, given, written, known)


def read_ground(site: Section, records: Mapping[str, xr.DataArray]) -> Any:
    """The ground by name or by parameters, or several in parallel; None if it is fitted to a record.

    It is an uncertain model if parameters are uncertain.
    """
    kinds = (*ground_names(), *GROUNDS, FITTED, PARALLEL)
    name = site.text("ground", kinds)
    if name == FITTED:
        site.only("ground", *RECORDS, "model", "estimator", *GOALS)
        _model(site)
        _estimator(site)
        if not records:
            raise site.error("ground", "needs a record to be fitted to; allowed: a [[site.records]]")
        return None
    if name == PARALLEL:
        site.only("ground", *RECORDS, INTENSITY, "grounds", *GOALS)
        for part in site.sections("grounds"):
            part.text("ground", (*ground_names(), *GROUNDS))
        quantity = Quantity.declared(ParallelGround, INTENSITY)
        whole = {INTENSITY: site.parameter(INTENSITY, quantity)} if INTENSITY in site else {}
        parts = [_part(part) for part in site.sections("grounds")]
        return site.made(ParallelGround, {"grounds": parts, **whole})
    names = GROUNDS[name].parameter_names() if name in GROUNDS else (INTENSITY,)
    site.only("ground", *RECORDS, *names, *GOALS)
    if not any(key in site for key in (INTENSITY, *GOALS) if key != HAZARD):
        raise site.error(INTENSITY, f"is missing; write, for instance, intensity = {EXAMPLE}")
    kind = GROUNDS.get(name, WhiteNoise)
    own = [each for each in names if each in site or each != INTENSITY]
    values: dict[str, Any] = {INTENSITY: 1.0}
    values |= {each: site.parameter(each, Quantity.declared(kind, each)) for each in own}
    return site.made(kind, values) if name in GROUNDS else named_ground(name, **values)


def _part(site: Section) -> Ground:
    """One of several parallel grounds."""
    described = read_ground(site, {})
    if isinstance(described, UncertainModel):
        raise site.error(
            next(iter(described.uncertain)),
            "cannot be uncertain in one of several grounds; allowed: one number, or an uncertain "
            "intensity of all of them together in [site]",
        )
    ground: Ground = described
    return ground


def _model(site: Section) -> str:
    """Kind of the ground that is fitted to a record."""
    return site.text("model", tuple(fitted_grounds()), "kanai_tajimi")


def _estimator(site: Section) -> str:
    """What the fit to a record minimizes."""
    return site.text("estimator", tuple(ESTIMATORS), "psd")


def _filters(site: Section) -> int:
    """Number of filters of a ground that is fitted together with its envelope."""
    return site.read("filters") or FILTERS


def _check_fitted_motion(site: Section, motion: Section, records: Mapping[str, xr.DataArray]) -> None:
    """Raise a ValueError for keys that do not go with a ground and an envelope fitted together."""
    if site.values.get("ground") != FITTED or not records:
        raise motion.error(
            "envelope",
            'goes with a ground that is fitted as well; allowed: ground = "fitted" in [site], and a '
            "[[site.records]]",
        )
    motion.only("envelope", "components", "scatter")  # the duration is that of the record
    if motion.read("components") > len(records):
        raise motion.error("components", "needs two [[site.records]], both components of one station")
    with motion.naming("components" if "components" in motion else "envelope"):
        checked_components(dict(islice(records.items(), motion.read("components"))))
    site.only("ground", "records", "filters", HAZARD)
    _filters(site)


def _doubt_energy(motion: Section, record: xr.DataArray, ground: Ground, course: Course) -> None:
    """Warn if motions on a fitted ground have much less or more energy than its record."""
    ratio = energy_ratio(record, ground, course.envelope, course.duration)
    if not _LIKE[0] <= ratio <= _LIKE[1]:
        motion.doubt(
            "envelope",
            f"and the duration give motions with {ratio:.2g} times the energy of the record that the "
            f'ground is fitted to; for equal energy write envelope = "{FITTED}", without a duration',
        )


def _with_intensity(ground: Any, factor: float) -> Any:
    """The ground with its intensity multiplied by a factor."""
    return replace(ground, intensity=ground.intensity * factor)


def read_envelope(motion: Section) -> Envelope | None:
    """The envelope of the motion, or None."""
    name = motion.text("envelope", (*ENVELOPES, NONE, FITTED), NONE)
    names = () if name == NONE else ENVELOPES[name].parameter_names()
    motion.only("duration", "envelope", "scatter", *names)
    return None if name == NONE else motion.model(ENVELOPES[name], names)


def read_scatter(motion: Section, usual: float) -> float:
    """Scatter of the ground acceleration between motions [-], or its default."""
    scatter = motion.values.get("scatter", usual)
    try:
        SCATTER("scatter", scatter)
    except ValueError as error:
        raise motion.error("scatter", f"cannot be used: {error}") from error
    return float(scatter)
