"""Case files in TOML, which describe a site, buildings in a row and a motion."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any

import xarray as xr

from stochlin.analyses.cases.buildings import (
    AnyBuilding,
    Building,
    building_keys,
    files_of_buildings,
    read_buildings,
    read_gaps,
)
from stochlin.analyses.cases.contacts import read_amplification_limit, read_contact, read_measures
from stochlin.analyses.cases.files.design import read_codes
from stochlin.analyses.cases.files.known import Known, name_of
from stochlin.analyses.cases.files.quantities import Quantity
from stochlin.analyses.cases.files.schema import WALL
from stochlin.analyses.cases.files.sections import Section, read_sections
from stochlin.analyses.cases.site import FITTED, CaseSite, read_scatter, read_site
from stochlin.analyses.cases.sites.strength import HAZARD_EXAMPLE
from stochlin.analyses.cases.storeys import SlabOnColumn, StoreyBuilding, slabs_of_row
from stochlin.analyses.risk.risk import check_target
from stochlin.analyses.sites.motion_fit import UsualScatter
from stochlin.analyses.tables.inputs import input_path
from stochlin.kernels.simulation.stepping import whole_groups
from stochlin.models.arguments import checked
from stochlin.models.contacts import Contact
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground
from stochlin.models.hazards import Hazard
from stochlin.models.measures import Measure
from stochlin.models.parameters import POSITIVE
from stochlin.models.plausible import PLAUSIBLE
from stochlin.models.rules.codes import CODE_RULES
from stochlin.models.uncertain import UncertainModel

TOUCHING = 1e-6  # m, in place of a gap of 0: any motion towards each other closes it, and formulas hold
TABLES = ("site", "motion", "separation", "simulation", "contact", "measures", "mitigation")


@dataclass(frozen=True, eq=False)
class Case:
    """Content of a case file in SI units; ``gaps`` [m] are the existing gaps.

    The ground is fitted and scaled to the wanted strength, where the file asks for this, when it is
    first needed. ``inputs`` are the paths of the file and of the files of its records, which results
    must not overwrite. ``paths`` is the number of motions that are simulated, in whole groups of 32.

    ``buildings`` are in a row from left to right, oscillators and buildings with storeys. Analyses of
    two buildings use ``pair``, ``first``, ``second`` and ``gap``; analyses that also take one building
    beside its property line use ``one_or_two``.
    """

    whole: Section
    inputs: tuple[Path, ...]
    title: str
    of_site: CaseSite
    described: tuple[AnyBuilding, ...]  # as written, see `buildings`
    scatter: float
    confidence: float
    gaps: tuple[float, ...]
    floors_align: bool
    same_property: bool
    same_system: bool
    codes: tuple[str, ...]  # rules that the engineer applies
    zone: str | None
    given_pga: float | None  # of the design [m/s^2], see `design_pga`
    numbers: Mapping[str, float]
    unverified: bool
    paths: int
    seed: int
    contact: Contact | None
    measures: Mapping[str, Measure]
    amplification_limit: float | None
    risk: str | float | None = None  # allowed risk, as in `required_gap`

    def __eq__(self, other: object) -> bool:
        """Whether the other is a case of the same file with the same text."""
        return isinstance(other, Case) and (self.file, self._text) == (other.file, other._text)

    def __hash__(self) -> int:
        """Hash of the text."""
        return hash(self._text)

    @cached_property
    def _text(self) -> str:
        return name_of(str(self.inputs[0]), self.whole.values)

    @property
    def file(self) -> str:
        """Name of the file."""
        return self.whole.file

    @property
    def site(self) -> str:
        """Ground or spectrum as written in the file."""
        return self.of_site.name

    @property
    def ground(self) -> Ground:
        """The ground, with its uncertain parameters at their medians."""
        return self.of_site.shaking.ground

    @property
    def uncertain_ground(self) -> UncertainModel | None:
        """The ground with its uncertain parameters, if there are any."""
        return self.of_site.shaking.uncertain

    @property
    def spectrum(self) -> xr.DataArray | None:
        """Elastic spectrum to which the ground is fitted."""
        return self.of_site.shaking.spectrum

    @property
    def design_pga(self) -> float | None:
        """Peak ground acceleration of the design [m/s^2], as given or of the spectrum of the site."""
        spectrum = self.spectrum if self.given_pga is None else None
        if spectrum is None or spectrum.period[0] > 0:
            return self.given_pga
        return float(spectrum[0])

    @property
    def of_codes(self) -> dict[str, Any]:
        """Zone, peak ground acceleration and storeys for rules of building codes, by name."""
        storeys = {f"storeys_{n}": b.storeys for n, b in enumerate(self.one_or_two, start=1)}
        return {"zone": self.zone, "design_pga": self.design_pga, **storeys}

    @property
    def duration(self) -> float:
        """Duration of the motions [s]."""
        return self.of_site.course.duration

    @property
    def envelope(self) -> Envelope | None:
        """Envelope of the motions; None for stationary ones."""
        return self.of_site.course.envelope

    @property
    def records(self) -> Mapping[str, xr.DataArray]:
        """Recorded motions by name."""
        return self.of_site.records

    @property
    def hazard(self) -> Hazard | None:
        """Hazard of the site, if the file has one."""
        return self.of_site.hazard

    @cached_property
    def buildings(self) -> tuple[AnyBuilding, ...]:
        """The buildings from left to right; a strength by ductility is that on the ground."""
        return tuple(
            building.on(self.ground)
            if isinstance(building, Building) and building.ductility is not None
            else building
            for building in self.described
        )

    @property
    def periods(self) -> list[float]:
        """Periods of the buildings, from left to right [s]."""
        return [building.period for building in self.buildings]

    @property
    def sampled_ground(self) -> Any:
        """The ground with its uncertain parameters, for simulations that sample them."""
        return self.uncertain_ground or self.ground

    @property
    def uncertain(self) -> dict[str, UncertainModel]:
        """Buildings and ground with uncertain parameters, by name."""
        models = {building.name: building.uncertain for building in self.buildings}
        models["ground"] = self.uncertain_ground
        return {name: model for name, model in models.items() if model is not None}

    @property
    def fitted(self) -> bool:
        """Whether the ground is fitted to the first record."""
        return self.site == FITTED

    @property
    def usual_scatter(self) -> UsualScatter:
        """The scatter by default, if the file has none, and where it is from."""
        return self.of_site.usual_scatter

    @property
    def pair(self) -> tuple[AnyBuilding, AnyBuilding]:
        """The two buildings from left to right; an error if there are more or fewer."""
        if self.alone:
            raise ValueError(
                f"{self.file}: building_2 is missing; this command needs two buildings: write a line "
                "[building_2] and its keys below it; only 'stochlin gap' and 'stochlin pound' accept "
                "one building alone"
            )
        first, second = self.one_or_two
        return first, second

    @property
    def one_or_two(self) -> tuple[AnyBuilding, ...]:
        """The two buildings, or one beside its property line; an error if there are more."""
        if len(self.buildings) > 2:
            raise ValueError(
                f"{self.file}: describes {len(self.buildings)} buildings; this command needs two, "
                "building_1 and building_2, so leave the others out; 'stochlin pound' accepts more"
            )
        return self.buildings

    @property
    def alone(self) -> bool:
        """Whether there is only one building."""
        return len(self.buildings) == 1

    @property
    def slabs_on_columns(self) -> tuple[SlabOnColumn, ...]:
        """Slabs that meet columns of the neighbour, from left to right and from the ground up."""
        return slabs_of_row(self.buildings)

    @property
    def walls(self) -> tuple[AnyBuilding, ...]:
        """Buildings whose structural system is a wall."""
        return tuple(
            building
            for number, building in enumerate(self.buildings, start=1)
            if self.whole.section(f"building_{number}").read("system") == WALL
        )

    @property
    def motion(self) -> dict[str, Any]:
        """Arguments of the analyses that describe the simulated motions, by name."""
        names = ("duration", "envelope", "scatter", "confidence", "paths", "seed")
        return {name: getattr(self, name) for name in names}

    @property
    def unlike_storeys(self) -> tuple[AnyBuilding, AnyBuilding] | None:
        """Neighbours with different mean storey heights, whose floor levels are not all known."""
        for building, other in pairwise(self.buildings):
            if isinstance(building, StoreyBuilding) and isinstance(other, StoreyBuilding):
                continue
            left, right = building.storey_height, other.storey_height
            if left is not None and right is not None and abs(left - right) > 0.01 * left:
                return building, other
        return None

    @property
    def first(self) -> AnyBuilding:
        """The left one of two buildings."""
        return self.pair[0]

    @property
    def second(self) -> AnyBuilding:
        """The right one of two buildings."""
        return self.pair[1]

    @property
    def gap(self) -> float | None:
        """Existing gap of two buildings, or distance of one from its property line [m], if given.

        Between buildings that touch it is `TOUCHING`.
        """
        return (self.gaps[0] or TOUCHING) if self.one_or_two and self.gaps else None


@checked
def read_case(path: str | os.PathLike[str]) -> Case:
    """Read a case file.

    Parameters
    ----------
    path : str or path
        Path of the case file, TOML as ``stochlin gap --example`` prints it. Values with a unit are texts
        such as ``"0.8 s"``; paths of other files are relative to it. Nothing in the file is evaluated as
        code.

    Returns
    -------
    Case
        The case. Its attributes ``ground``, ``first`` and ``second`` (each with its ``structure``, an
        oscillator or a `ShearBuilding`), ``duration`` [s], ``envelope``, ``scatter`` [-], ``records``,
        ``confidence`` [-], ``gap`` [m] and others are arguments of `separation`; ``buildings`` and
        ``gaps`` [m] of a longer row or of one building, ``contact``, ``measures`` and
        ``amplification_limit`` [-] are arguments of `pound` and `mitigate`; ``hazard`` and ``risk`` are
        arguments of `required_gap`.

    Raises
    ------
    OSError
        If the file cannot be read.
    ValueError
        If the file is not valid TOML; if a key is unknown or missing, a unit is missing or unknown, or a
        value is not a number or out of range; if a building has no strength or two, or keys of both an
        oscillator and a building with storeys; if there are too many or too few gaps, or a link ties a
        floor that does not exist; if there are too many or too few displacements of a design, or a code
        to be applied lacks one of its factors; or if a record cannot be read or fitted. The message
        names the file, the line, the key and what is allowed.

    Warns
    -----
    UserWarning
        If a value is allowed but implausible: a gap above 3 m, floors lighter than 5 t, a reduction
        factor below 0.6 or above 20, a base shear coefficient above 1, a yield displacement above 2 m, a
        yield drift above a tenth of the storey height, a behaviour factor above 12, a confidence below
        0.01, a motion that ends before its strong part, shaking that is not felt or was never recorded,
        a hazard that exceeds a PGA of 1 g once in 150 years, an allowed risk above 0.01 per year, or
        floors that are stated to align and do not.

    Examples
    --------
    >>> import pathlib, tempfile, stochlin as sl
    >>> lines = '''
    ...     site = {ground = "firm", intensity = "0.01 m^2/s^3"}
    ...     motion = {duration = "20 s", envelope = "none"}
    ...     separation = {confidence = 0.9, existing = "5 cm"}
    ...     building_1 = {period = "1 s", damping = 0.05, elastic = true}
    ...     building_2 = {period = "0.6 s", damping = 0.05, elastic = true}
    ... '''
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "case.toml"
    >>> _ = path.write_text(lines, encoding="utf-8")
    >>> case = sl.read_case(path)
    >>> case.second.structure.period, case.gap
    (0.6, 0.05)
    """
    path = input_path("path", path)
    return case_of(read_sections(path), path, Known())


def case_of(whole: Section, path: Path, known: Known) -> Case:
    """The case of a file with these tables; files that are known are not read again."""
    if "hazard" in whole:
        raise whole.error("hazard", "is of the site; write [site.hazard], below all else of the site")
    keys = building_keys(whole, "title", *TABLES)
    site, motion, wanted = (whole.section(key) for key in ("site", "motion", "separation"))
    wanted.only(*wanted.keys, "numbers")
    of_site = read_site(site, motion, path.parent, known)
    buildings = read_buildings(whole, keys, path.parent, known)
    align = wanted.read("floors_align")
    slabs = slabs_of_row(buildings)
    if align and slabs:
        wanted.doubt("floors_align", f"is not so: {slabs[0]}; codes are asked as if it were false")
    simulated = whole.section("simulation", needed=False)
    simulated.only(*simulated.keys)
    *others, last = (building.name for building in buildings)
    before = ", ".join(others)
    return Case(
        whole=whole,
        inputs=(path, *of_site.inputs, *files_of_buildings(whole, keys, path.parent)),
        title=whole.read("title") or " and ".join(filter(None, [before, last])),
        of_site=of_site,
        described=buildings,
        scatter=read_scatter(motion, of_site.usual_scatter.scatter),
        confidence=wanted.read("confidence"),
        gaps=read_gaps(wanted, len(buildings)),
        floors_align=align and not slabs,
        same_property=wanted.read("same_property"),
        same_system=wanted.read("same_system"),
        codes=read_codes(wanted, [building.design for building in buildings], of_site.spectrum),
        zone=wanted.read("zone"),
        given_pga=wanted.read("design_pga"),
        numbers=_numbers(wanted.section("numbers", needed=False)),
        unverified=wanted.read("unverified"),
        paths=whole_groups(simulated.read("paths")),
        seed=simulated.read("seed"),
        contact=read_contact(whole.section("contact")) if "contact" in whole else None,
        measures=read_measures(whole, buildings),
        amplification_limit=read_amplification_limit(whole),
        risk=_risk(wanted, of_site.hazard),
    )


def _risk(wanted: Section, hazard: Hazard | None) -> str | float | None:
    """The allowed risk, if it is given."""
    risk: str | float | None = wanted.values.get("risk")
    if risk is None:
        return None
    if hazard is None:
        raise wanted.error("risk", f"needs a hazard; {HAZARD_EXAMPLE}")
    with wanted.naming("risk"):
        check_target(hazard, risk)
    if not isinstance(risk, str) and not PLAUSIBLE["risk"].holds(risk):
        usual = f'{PLAUSIBLE["risk"].usually}; or write, for instance, risk = "2 % in 50 years"'
        wanted.doubt("risk", f"is doubtful: it is once in {1 / risk:.3g} years, and {usual}")
    return risk if isinstance(risk, str) else float(risk)


def _numbers(section: Section) -> dict[str, float]:
    """Numbers of code rules in place of their defaults, by name."""
    known = {name: rule.number.units for name, rule in CODE_RULES.items() if rule.number}
    section.only(*known)
    return {name: section.number(name, Quantity(known[name], POSITIVE)) for name in section.values}
