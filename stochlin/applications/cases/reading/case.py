"""A case file: what it says of a site, of buildings in a row and of what is wanted."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from stochlin.applications.cases.reading.buildings import (
    Building,
    SlabOnColumn,
    read_building,
    slabs_of_row,
)
from stochlin.applications.cases.reading.codes import Simulated, Wanted
from stochlin.applications.cases.reading.kinds import TEXT, Inner, Key, key, keys_of
from stochlin.applications.cases.reading.measures import OfContact, read_measures
from stochlin.applications.cases.reading.site import Site, read_site
from stochlin.applications.cases.reading.tables import Form, Table, read_table
from stochlin.models.arguments import checked
from stochlin.models.contacts import Contact
from stochlin.models.measures import Measure
from stochlin.models.uncertain import UncertainModel
from stochlin.solver.tables.inputs import input_path

MOST_BUILDINGS = 100
NUMBERED = re.compile(r"building_([1-9]\d{0,5})")
TABLE = Inner()


@dataclass(frozen=True, kw_only=True)
class Whole(Form):
    """The tables of a file; ``more`` are the buildings from left to right."""

    title: str = key(TEXT, "Title of all results", "")
    site: Table = key(TABLE, "Ground and records")
    motion: Table = key(TABLE, "Duration and envelope")
    separation: Table = key(TABLE, "What is wanted")
    simulation: Table | None = key(TABLE, "Simulated motions", None)
    contact: Table | None = key(TABLE, "Contact between the buildings", None)
    measures: Table | None = key(TABLE, "Measures against pounding, each with its name", None)
    mitigation: Table | None = key(TABLE, "What measures have to achieve", None)

    @classmethod
    def keys(cls, table: Table) -> dict[str, Key]:
        """With the buildings, none left out, and the next one, which a wrong name may mean."""
        count = max(1, sum(1 for name in table.values if NUMBERED.fullmatch(name)))
        names = [f"building_{n}" for n in range(1, min(count, MOST_BUILDINGS) + 1)]
        after = next((name for name in names if name not in table), f"building_{count + 1}")
        keys = {after: Key(TABLE, "A building", None)}
        return keys_of(cls) | keys | dict.fromkeys(names, Key(TABLE, "A building"))


@dataclass(frozen=True)
class Case:
    """What a case file says, in SI units.

    ``described`` are the buildings as the file has them, and ``buildings`` have the strength that gives
    them their ductility on the ground. ``codes`` are the rules that the engineer applies.
    """

    whole: Whole
    site: Site = field(compare=False, repr=False)
    described: tuple[Building, ...] = field(compare=False, repr=False)
    wanted: Wanted = field(compare=False)
    simulated: Simulated = field(compare=False)
    codes: tuple[str, ...] = field(compare=False)
    contact: Contact | None = field(compare=False)
    measures: Mapping[str, Measure] = field(compare=False)

    @property
    def title(self) -> str:
        """Title of all results."""
        *others, last = (building.name for building in self.described)
        return self.whole.title or " and ".join(filter(None, [", ".join(others), last]))

    @property
    def alone(self) -> bool:
        """Whether there is one building, beside its property line."""
        return len(self.described) == 1

    @property
    def files(self) -> list[Path]:
        """The case file and those that it names."""
        return self.whole.table.source.files

    @property
    def periods(self) -> list[float]:
        """Periods of the buildings [s], of small oscillations."""
        return [building.period for building in self.buildings]

    @property
    def slabs(self) -> tuple[SlabOnColumn, ...]:
        """Floor slabs that meet columns of a neighbour."""
        return slabs_of_row(self.described)

    @property
    def uncertain(self) -> dict[str, UncertainModel]:
        """Buildings and ground with uncertain parameters, by name."""
        models = {building.name: building.sampled for building in self.buildings}
        models["ground"] = self.site.sampled_ground
        return {name: model for name, model in models.items() if isinstance(model, UncertainModel)}

    @cached_property
    def buildings(self) -> tuple[Building, ...]:
        """The buildings from left to right."""
        return tuple(building.on(self.site) for building in self.described)


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
        What the file says. Of its parts ``site`` has ``ground``, ``spectrum``, ``records``, ``hazard``,
        ``scatter`` [-] and ``course``, the duration [s] and the envelope; each of its ``buildings`` has
        its ``structure``, which is an argument of the functions, and ``sampled`` with its uncertain
        parameters; ``wanted`` has the ``existing`` gaps [m], the ``confidence`` [-] and the ``risk``;
        ``simulated`` the ``paths`` and the ``seed``; ``contact`` and ``measures`` are arguments of
        `pound` and `mitigate`.

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
        an allowed risk above 0.01 per year, or floors that are stated to align and do not.

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
    >>> [building.structure.period for building in case.buildings], case.wanted.existing
    ([1.0, 0.6], [0.05])
    """
    return case_of(read_table(input_path("path", path)))


def case_of(table: Table) -> Case:
    """The case of a file."""
    whole = table.read(Whole)
    site = read_site(whole.site, whole.motion)
    row = range(1, len(whole.more) + 1)
    buildings = tuple(read_building(whole.more[f"building_{n}"], n) for n in row)
    wanted = whole.separation.read(Wanted)
    wanted.check(len(buildings), site.hazard)
    if wanted.floors_align and (slabs := slabs_of_row(buildings)):
        what = f"is not so: {slabs[0].words}; codes are asked as if it were false"
        wanted.table.warn("floors_align", what)
    return Case(
        whole=whole,
        site=site,
        described=buildings,
        wanted=wanted,
        simulated=table.table("simulation").read(Simulated),
        codes=wanted.applied_codes(buildings, site.spectrum),
        contact=whole.contact.read(OfContact).contact() if whole.contact else None,
        measures=read_measures(table.table("measures"), buildings),
    )
