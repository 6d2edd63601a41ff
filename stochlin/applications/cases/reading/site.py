"""The tables [site] and [motion] of a case file: ground, spectrum, strength, records, envelope."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from itertools import islice
from typing import Any, ClassVar, NamedTuple

import xarray as xr

from stochlin.applications.cases.reading.kinds import (
    COLUMN_OF_FILE,
    TEXT,
    TRUTH,
    Inner,
    Integer,
    Key,
    ListOf,
    WithUnit,
    Word,
    key,
    keys_of,
    keys_of_model,
    of,
)
from stochlin.applications.cases.reading.records import (
    HAZARDS,
    PGA,
    POSITIVE_NUMBER,
    RESPONSE,
    RETURN_PERIOD,
    SA_PERIOD,
    SITE,
    Record,
    Suite,
    read_records_of,
)
from stochlin.applications.cases.reading.tables import Form, TomlTable
from stochlin.applications.records.ground_fit import fitted_grounds
from stochlin.applications.risk.rates import times_intensity
from stochlin.applications.sites.design_spectra import asce_7, eurocode_8
from stochlin.applications.sites.elastic_spectra import TAKEN_AS, marked, pga_of
from stochlin.applications.sites.ground_fit import fit_ground
from stochlin.applications.sites.intensity import paths_for, scale_ground
from stochlin.applications.sites.motion_fit import (
    FILTERS,
    between_components,
    checked_components,
    energy_ratio,
    fit_motion,
)
from stochlin.applications.sites.spectra import INTERPOLATIONS, read_spectrum
from stochlin.messages import hint, listed
from stochlin.models.arguments import SCATTER
from stochlin.models.envelopes import ENVELOPES, Envelope
from stochlin.models.grounds import (
    GROUNDS,
    MOST_FILTERS,
    OTHER_COMPONENT,
    SCATTER_OF_SPECTRUM,
    Ground,
    UsualScatter,
    WhiteNoise,
    ground_names,
    named_ground,
)
from stochlin.models.hazards import Hazard
from stochlin.models.parameters import POSITIVE, Range
from stochlin.models.plausible import PLAUSIBLE, unquestioned
from stochlin.models.uncertain import UncertainModel, median_of

FITTED = "fitted"
NO_ENVELOPE = "none"
STRENGTH_KEYS = ("intensity", "pga", "sa", "return_period")
AG = WithUnit("m/s^2", POSITIVE, PLAUSIBLE["ag"])
SDS = WithUnit("m/s^2", POSITIVE, PLAUSIBLE["sds"])
FROM_ZERO = WithUnit("s", Range(0.0, include_lower=True))
DIVIDED_BY = WithUnit("1", Range(1.0, include_lower=True), PLAUSIBLE["divided_by"])
LOG_SPREAD = WithUnit("1", SCATTER.allowed, PLAUSIBLE["scatter"])  # of a logarithm
SPECTRUM_DAMPING = WithUnit("1", Range(0.0, 1.0), PLAUSIBLE["damping"])
MOTION_DURATION = WithUnit("s", POSITIVE, PLAUSIBLE["duration"])
LONG_PERIOD = WithUnit("s", POSITIVE, PLAUSIBLE["tl"])
USUAL_ENERGY_RATIOS = 0.8, 1.25  # energies of motions over that of a record, without a warning


class Course(NamedTuple):
    """Duration [s] and envelope of motions, and their ground if it is fitted together with them."""

    duration: float
    envelope: Envelope | None
    ground: Ground | None = None


# --- the table [motion] ---


class MotionForm(Form):
    """Duration and envelope of the motions."""

    envelope: str = key(Word(lambda: [*ENVELOPES, NO_ENVELOPE, FITTED]), "Envelope", NO_ENVELOPE)
    duration: float = key(MOTION_DURATION, "Duration")
    scatter: float | None = key(LOG_SPREAD, "Scatter of the strength between earthquakes", None)

    @classmethod
    def keys(cls, table: TomlTable) -> dict[str, Key]:
        """With the parameters of the envelope."""
        return keys_of(cls) | keys_of_model(ENVELOPES.get(str(table.values.get("envelope"))))

    def course(self) -> Course:
        """The duration and the envelope."""
        if self.envelope == NO_ENVELOPE:
            return Course(self.duration, None)
        envelope: Envelope = self.table.made(ENVELOPES[self.envelope], **self.more)
        if warning := envelope.doubt(self.duration):
            self.table.warn("duration", f"is doubtful: {warning}")
        return Course(self.duration, envelope)


class MotionOfRecord(Form):
    """A motion that is fitted to the first records, together with the ground."""

    envelope: str = key(Word((FITTED,)), "Envelope")
    components: int = key(Integer(1, 2), "Number of components that are fitted to", 1)
    scatter: float | None = key(LOG_SPREAD, "Scatter of the strength between earthquakes", None)


MOTIONS = (MotionForm, MotionOfRecord)

# --- the table [site] ---


class OfSite(Form):
    """Keys of every site."""

    records: list[Record] = key(Inner((Record,), several=True), "Recorded motions", ())
    suite: Suite | None = key(Inner((Suite,)), "A suite of records", None)
    hazard: Any = key(Inner(HAZARDS), "Hazard", None)


class Scaled(OfSite):
    """A site whose strength may be that of its motions."""

    one_of: ClassVar[Any] = {"": STRENGTH_KEYS}
    goes_with = (("sa", "sa_period"), ("sa_period", "sa"))

    pga: float | None = key(PGA, "Peak acceleration, mean of the motions", None)
    sa: float | None = key(RESPONSE, "Spectral acceleration, mean of the motions", None)
    sa_period: float | None = key(SA_PERIOD, "Its period", None)
    return_period: float | None = key(
        RETURN_PERIOD, "Return period of the shaking, from the hazard", None
    )

    def goal(self, hazard: Hazard | None) -> dict[str, Any]:
        """The wanted strength, as arguments of `scale_ground`, or the intensity of an S0 hazard."""
        strength = self.values_of("pga", "sa")
        period = self.sa_period
        if self.return_period is not None:
            if hazard is None:
                raise self.table.error(
                    "return_period", "needs a hazard; allowed: with [site.hazard]"
                )
            with self.table.naming("return_period", "is not in the hazard: "):
                strength = {hazard.measure: float(hazard.intensity(self.return_period))}
            period = hazard.period
        return strength if period is None else strength | {"period": period}


class ByParameters(Scaled):
    """A ground by its name, or by its kind and its parameters."""

    one_of: ClassVar[Any] = {"strength of the shaking": STRENGTH_KEYS}

    ground: str = key(
        Word(lambda: [*ground_names(), *GROUNDS, FITTED]), "Name or kind of the ground"
    )
    intensity: Any = of(WhiteNoise, "intensity", "Intensity S0", None)

    @classmethod
    def keys(cls, table: TomlTable) -> dict[str, Key]:
        """With the parameters of the kind of ground."""
        kind = GROUNDS.get(str(table.values.get("ground")))
        return keys_of_model(kind, uncertain=True) | keys_of(cls)

    def described(self) -> Any:
        """The ground, which may be uncertain; of intensity 1 if it is scaled."""
        values = {"intensity": 1.0 if self.intensity is None else self.intensity, **self.more}
        kind = GROUNDS.get(self.ground)
        return self.table.asked(
            self.table.made(kind or partial(named_ground, self.ground), **values)
        )


class OfRecord(Scaled):
    """A ground that is fitted to the first record."""

    ground: str = key(Word((FITTED,)), "Kind of the ground")
    model: str = key(Word(fitted_grounds), "Kind of the ground that is fitted", "kanai_tajimi")


class WithMotionOfRecord(OfSite):
    """A ground that is fitted to the first records together with the envelope."""

    ground: str = key(Word((FITTED,)), "Kind of the ground")
    filters: int = key(Integer(1, MOST_FILTERS), "Number of filters", FILTERS)


class Spectrum(OfSite):
    """Keys of every site by its design spectrum."""

    described_as = "a site by its spectrum"

    spectrum: str = key(TEXT, "Code or file of a design spectrum, in place of a ground")
    filters: int | None = key(Integer(1, MOST_FILTERS), "Number of filters of the ground", None)


class Eurocode8(Spectrum):
    """The elastic spectrum of EN 1998-1."""

    ag: float = key(AG, "Acceleration ag")
    soil: str = key(Word(tuple("ABCDE")), "Ground type")
    type: int = key(Integer(1, 2), "Type of spectrum", 1)
    damping: float = key(SPECTRUM_DAMPING, "Damping ratio", 0.05)

    def target(self) -> xr.DataArray:
        """The spectrum of the code."""
        return self.table.made(eurocode_8, **self.values_of("ag", "soil", "type", "damping"))


class Asce7(Spectrum):
    """The design spectrum of ASCE 7."""

    sds: float = key(SDS, "SDS")
    sd1: float = key(RESPONSE, "SD1")
    tl: float = key(LONG_PERIOD, "TL")

    def target(self) -> xr.DataArray:
        """The spectrum of the code."""
        with self.table.asking("sd1"):
            return self.table.made(asce_7, sds=self.sds, sd1=self.sd1, tl=self.tl)


class Divisors(Form):
    """By what a spectrum is divided, where that depends on the period."""

    periods: list[float] = key(ListOf(FROM_ZERO), "Periods of the factors, linear between them")
    factors: list[float] = key(ListOf(DIVIDED_BY), "By what the ordinates are divided there")

    def table_of_factors(self) -> xr.DataArray:
        """The factors over the period."""
        if len(self.periods) != len(self.factors):
            what = f"are {len(self.factors)}; allowed: as many as periods, {len(self.periods)}"
            raise self.table.error("factors", what)
        return xr.DataArray(self.factors, dims="period", coords={"period": self.periods})


class SpectrumFile(Spectrum):
    """A spectrum from a file, with a factor."""

    one_of: ClassVar[Any] = {"": ("elastic", "divided_by")}

    elastic: bool | None = key(TRUTH, "Whether the spectrum in the file is elastic", None)
    divided_by: Any = key(DIVIDED_BY, "By what it is divided, R or q, or a table of that", None)
    units: str | None = key(TEXT, "Unit of the accelerations in the file", None)
    period_column: str | int | None = key(COLUMN_OF_FILE, "Column of the periods", None)
    column: str | int | None = key(COLUMN_OF_FILE, "Column of the accelerations", None)
    site: Any = key(SITE, "Site in a file of OpenQuake, its number or its coordinates", None)
    between: str | None = key(Word(INTERPOLATIONS), "What the spectrum is between its points", None)
    scale: float = key(POSITIVE_NUMBER, "Scale of the spectrum", 1.0)
    damping: float | None = key(SPECTRUM_DAMPING, "Damping ratio", None)

    @classmethod
    def keys(cls, table: TomlTable) -> dict[str, Key]:
        """What the spectrum is divided by is a number or a table."""
        keys = keys_of(cls)
        if isinstance(table.values.get("divided_by"), dict):
            keys["divided_by"] = keys["divided_by"]._replace(kind=Inner((Divisors,)))
        return keys

    def target(self) -> xr.DataArray:
        """The spectrum of the file, as an elastic one."""
        path = self.table.path("spectrum")
        if not path.exists():
            allowed = f"{hint(path.name, CODES)}allowed: {', '.join(CODES)}, or such a file"
            raise self.table.error(
                "spectrum", f"is neither a code nor a file beside this one; {allowed}"
            )
        if not (self.elastic or self.divided_by):
            lines = "the line elastic = true, or divided_by = 4 if it is divided by R or q = 4"
            raise self.table.error(
                "spectrum", f"does not say whether it is elastic; allowed: {lines}"
            )
        options = self.values_of(
            "units", "period_column", "column", "site", "between", "damping", "elastic"
        )
        if self.divided_by:
            of_table = isinstance(self.divided_by, Divisors)
            divisor = self.divided_by.table_of_factors() if of_table else self.divided_by
            options |= {"elastic": None, "divided_by": divisor}
        with self.table.naming("spectrum"), self.table.asking("spectrum"):
            spectrum = read_spectrum(path, **options)
        scaled = spectrum.copy(data=self.scale * spectrum.values)
        return marked(scaled, spectrum.attrs[TAKEN_AS])


CODES = {"eurocode_8": Eurocode8, "asce_7": Asce7}
SITES = (ByParameters, OfRecord, WithMotionOfRecord, *CODES.values(), SpectrumFile)


def _form_of(table: TomlTable, with_motion: bool) -> Any:
    """The form of the table [site]; with a motion of records the ground is theirs as well."""
    if with_motion:
        return table.read(WithMotionOfRecord)
    if "spectrum" in table:
        return table.read(CODES.get(table.value("spectrum", TEXT), SpectrumFile))
    return table.read(OfRecord if table.values.get("ground") == FITTED else ByParameters)


@dataclass(frozen=True)
class CaseSite:
    """Ground and motions of a case; what has to be fitted or scaled is so when it is first needed.

    ``described`` is the ground of the file, None if it is fitted, and ``goal`` has the wanted
    strength as arguments of `scale_ground`.
    """

    form: Any
    motion: MotionForm | MotionOfRecord
    records: Mapping[str, xr.DataArray]
    hazard: Hazard | None
    goal: Mapping[str, Any]
    spectrum: xr.DataArray | None = field(repr=False)
    described: Any

    @property
    def name(self) -> str:
        """Ground or spectrum as written in the file."""
        return str(self.form.ground if self.spectrum is None else self.form.spectrum)

    @property
    def pga(self) -> float | None:
        """Peak ground acceleration of a spectrum [m/s^2]; None without one that begins with it."""
        return None if self.spectrum is None else pga_of(self.spectrum)

    @property
    def components(self) -> dict[str, xr.DataArray]:
        """The first record, or the first two, to which ground and motion are fitted."""
        return dict(islice(self.records.items(), getattr(self.motion, "components", 1)))

    @cached_property
    def course(self) -> Course:
        """Duration and envelope, which may be fitted to records together with the ground."""
        if isinstance(self.motion, MotionForm):
            return self.motion.course()
        table = self.motion.table
        what = f"cannot be fitted to {listed(self.components)}: "
        with table.naming("envelope", what), table.asking("envelope"):
            fitted = fit_motion(self.components, filters=self.form.filters)
        return Course(fitted.duration, fitted.envelope, fitted.ground)

    @cached_property
    def usual_scatter(self) -> UsualScatter:
        """Scatter by default: 0 for a ground by name or by parameters, else that of its use."""
        if self.described is not None:
            return UsualScatter(0.0, "")
        if len(self.components) == 2:
            return between_components(checked_components(self.components))
        return OTHER_COMPONENT if self.name == FITTED else SCATTER_OF_SPECTRUM

    @property
    def scatter(self) -> float:
        """Scatter of the strength between motions [-], of the file or by default."""
        return float(
            self.usual_scatter.scatter if self.motion.scatter is None else self.motion.scatter
        )

    @property
    def leaves_out_scatter(self) -> bool:
        """Whether motions have no scatter between earthquakes, and the file does not say so."""
        return self.motion.scatter is None and not self.scatter

    @property
    def ground(self) -> Ground:
        """The ground, with its uncertain parameters at their medians."""
        ground: Ground = median_of(self.sampled_ground)
        return ground

    @cached_property
    @unquestioned()
    def sampled_ground(self) -> Any:
        """The ground as strong as it is wanted, with its uncertain parameters."""
        described = self.course.ground or self.described or self._fitted()
        if not self.goal:
            return described
        ground = median_of(described)
        duration, envelope, _ = self.course
        if "intensity" in self.goal:  # from a hazard of S0
            scaled = replace(ground, **self.goal)
        else:
            key = next(name for name in STRENGTH_KEYS if name in self.form.table)
            with self.form.table.naming(key, "cannot be met: "):
                paths = paths_for(duration)
                scaled = scale_ground(ground, duration, envelope, **self.goal, paths=paths)
        if not isinstance(described, UncertainModel):
            return scaled
        factor = float(scaled.intensity / ground.intensity)
        return described.changed(partial(times_intensity, factor=factor))

    def _fitted(self) -> Ground:
        """The ground that is fitted to the spectrum, or to the first record."""
        duration, envelope, _ = self.course
        if self.spectrum is not None:
            options = {"duration": duration, "envelope": envelope, "filters": self.form.filters}
            with self.form.table.naming("spectrum"), self.form.table.asking("spectrum"):
                return fit_ground(self.spectrum, **options)
        record = next(iter(self.records.values()))
        with self.form.table.naming("ground", f"cannot be fitted to {listed(self.components)}: "):
            ground = fit_ground(record, self.form.model)
        ratio = energy_ratio(record, ground, envelope, duration)
        if not USUAL_ENERGY_RATIOS[0] <= ratio <= USUAL_ENERGY_RATIOS[1]:
            of_record = (
                f"times the energy of the record; for equal energy write envelope = {FITTED!r}"
            )
            what = f"and the duration give motions with {ratio:.2g} {of_record}, without a duration"
            self.motion.table.warn("envelope", what)
        return ground


def read_site(table: TomlTable, of_motion: TomlTable) -> CaseSite:
    """The tables [site] and [motion] with their files; nothing is fitted or simulated yet."""
    with_motion = of_motion.values.get("envelope") == FITTED
    motion: Any = of_motion.read(MotionOfRecord if with_motion else MotionForm)
    form = _form_of(table, with_motion)
    least = getattr(motion, "components", 1)
    if getattr(form, "ground", "") == FITTED and len(form.records) < least:
        raise table.error(
            "ground", f"needs a record to be fitted to; allowed: {least} [[site.records]]"
        )
    spectrum = form.target() if "spectrum" in table else None
    records = read_records_of(form.records, form.suite, spectrum)
    hazard = form.hazard and form.hazard.hazard()
    for text in hazard.doubts() if hazard else ():
        form.hazard.table.warn(form.hazard.stated, f"is doubtful: {text}")
    goal = form.goal(hazard) if isinstance(form, Scaled) else {}
    described = form.described() if isinstance(form, ByParameters) else None
    site = CaseSite(form, motion, records, hazard, goal, spectrum, described)
    if not with_motion:
        _ = site.course
    return site
