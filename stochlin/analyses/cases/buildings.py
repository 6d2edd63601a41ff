"""The buildings of a case file in a row from left to right, and the existing gaps between them."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from typing import Any

from stochlin.analyses.cases.files.design import Design, read_design
from stochlin.analyses.cases.files.known import Known
from stochlin.analyses.cases.files.modes import MODES
from stochlin.analyses.cases.files.pushover import check_pushover, pushed
from stochlin.analyses.cases.files.quantities import Quantity
from stochlin.analyses.cases.files.schema import GAP, OSCILLATOR, PUSHOVER, keys_of_way
from stochlin.analyses.cases.files.sections import Section
from stochlin.analyses.cases.storeys import (
    OF_STOREYS,
    StoreyBuilding,
    law_of,
    read_storeys,
    storey_keys,
    strength_key,
)
from stochlin.analyses.linearization.drift_map import calibrated_closure
from stochlin.analyses.linearization.strength import DuctilityTarget, strength_for_ductility
from stochlin.models.grounds import Ground
from stochlin.models.plausible import PLAUSIBLE
from stochlin.models.structures import Structure
from stochlin.models.uncertain import UncertainModel, applied, median_of

STRENGTHS = ("reduction_factor", "yield_displacement", "ductility", PUSHOVER, "elastic")
MOST_BUILDINGS = 100
MOST_SHOWN = 5  # gaps in an example
_NUMBERED = re.compile(r"building_([1-9]\d{0,5})")


@dataclass(frozen=True)
class Building:
    """A building of a case as an oscillator.

    ``strength`` is the key by which the file gives its strength. ``height`` [m] and ``storeys`` may be
    unknown. ``uncertain`` is the model with its uncertain parameters, if there are any; ``structure``
    has them at their medians.
    """

    name: str
    structure: Structure
    strength: str
    height: float | None
    storeys: int | None
    uncertain: UncertainModel | None = None
    design: Design = field(default_factory=Design)
    turning: str = ""  # as in `StoreyBuilding`
    ductility: float | None = None  # for which the strength is sought, where it is given so
    section: Section | None = field(default=None, compare=False, repr=False)  # of the file, for messages

    def on(self, ground: Ground) -> Building:
        """The building with the strength that gives it its ductility on this ground."""
        if self.ductility is None or self.section is None:
            return self
        closure = calibrated_closure(self.structure, ground)
        try:
            solution = strength_for_ductility(self.structure, ground, self.ductility, closure=closure)
        except ArithmeticError as error:
            what = f"has no strength ({error}); give another one"
            raise self.section.error("ductility", what) from error
        factor = float(solution.reduction_factor)
        described = applied(lambda s: dataclasses.replace(s, reduction_factor=factor), self.sampled)
        uncertain = described if isinstance(described, UncertainModel) else None
        return dataclasses.replace(self, structure=median_of(described), uncertain=uncertain)

    @property
    def sampled(self) -> Any:
        """The structure with its uncertain parameters, for simulations that sample them."""
        return self.uncertain or self.structure

    @property
    def period(self) -> float:
        """Period of small oscillations [s]."""
        return float(self.structure.arrays()["period"])

    @property
    def weighed(self) -> bool:
        """Whether its mass is known."""
        return self.structure.mass is not None

    @property
    def storey_height(self) -> float | None:
        """Mean storey height [m], if it is known."""
        return self.height / self.storeys if self.height and self.storeys else None


AnyBuilding = Building | StoreyBuilding


def building_keys(whole: Section, *others: str) -> list[str]:
    """The keys ``building_1``, ``building_2`` and so on, beside which there are only ``others``."""
    keys = [key for key in whole.values if _NUMBERED.fullmatch(key)]
    keys.sort(key=lambda key: int(key.partition("_")[2]))
    number, missing = next((n, key) for n in count(1) if (key := f"building_{n}") not in whole)
    whole.only(*others, missing, *keys)
    if number <= len(keys):
        raise whole.error(
            keys[number - 1],
            f"is given, but {missing} is missing; did you mean {missing}? allowed: building_1, "
            "building_2 and so on, from left to right, none left out",
        )
    if len(keys) > MOST_BUILDINGS:
        raise whole.error(keys[MOST_BUILDINGS], f"is given; allowed: {MOST_BUILDINGS} buildings")
    return keys or [missing]


def read_buildings(
    whole: Section, keys: Sequence[str], folder: Path, known: Known
) -> tuple[AnyBuilding, ...]:
    """All buildings; those with a strength by ductility are still elastic, until they are on a ground.

    A building with any key of `OF_STOREYS` has storeys; any other is an oscillator. Files of modes
    and pushover curves are in the folder, and are not read again if they are known.
    """
    return tuple(
        (read_storeys if storey_keys(section) else _oscillator)(section, number, folder, known)
        for number, section in enumerate(map(whole.section, keys), start=1)
    )


def files_of_buildings(whole: Section, keys: Sequence[str], folder: Path) -> list[Path]:
    """Paths of the files of modes and of pushover curves, each once."""
    named = (whole.section(key).values.get(of) for key in keys for of in (MODES, PUSHOVER))
    return [folder / name for name in dict.fromkeys(n for n in named if isinstance(n, str))]


def read_gaps(wanted: Section, count: int) -> tuple[float, ...]:
    """The existing gaps between ``count`` buildings [m]; empty if they are not given.

    For one building it is the distance from its property line.
    """
    key = "existing"
    if key not in wanted:
        return ()
    listed = isinstance(wanted.values[key], list)
    gaps = wanted.numbers(key, GAP) if listed else [wanted.number(key, GAP)]
    if len(gaps) != max(count - 1, 1):
        if count == 1:
            raise wanted.error(
                key,
                f"has {len(gaps)} gaps, but there is only one building; allowed: its distance from its "
                f'property line, as {key} = "5 cm"',
            )
        each = ", ".join(['"5 cm"'] * min(count - 1, MOST_SHOWN)) + ", ..." * (count - 1 > MOST_SHOWN)
        example = each if count == 2 else f"[{each}]"
        raise wanted.error(
            key,
            f"has {len(gaps)} gap{'s' * (len(gaps) > 1)} for {count} buildings; allowed: one between "
            f"each two, {count - 1} in all, as {key} = {example}",
        )
    return tuple(gaps)


def _oscillator(section: Section, number: int, folder: Path, known: Known) -> Building:
    _, law = law_of(section)
    section.only(*keys_of_way(OSCILLATOR), *law.own_parameters(), elsewhere=OF_STOREYS)
    strength = strength_key(
        section,
        STRENGTHS,
        'reduction_factor = 4, yield_displacement = "3 cm", ductility = 4, pushover = "push.csv", '
        "elastic = true",
    )
    check_pushover(section)
    names = ("period", "damping", *(() if strength in (PUSHOVER, "elastic") else ("hardening",)))
    if strength in ("reduction_factor", "yield_displacement"):
        names = (*names, strength)
    # Parameters of the law with a default, which is an attribute of the class, may be missing.
    own = [name for name in law.own_parameters() if name in section or not hasattr(law, name)]
    names = (*names, *(["mass"] if "mass" in section else []), *own)
    described = section.described(law, names)
    if strength == PUSHOVER:
        described = pushed(section, described, folder, known)
    structure: Structure = median_of(described)
    quantity = Quantity.declared(DuctilityTarget, "ductility")
    ductility = section.number("ductility", quantity) if strength == "ductility" else None
    storeys = section.read("storeys")
    mass, plausible = structure.mass, PLAUSIBLE["mass"]
    if mass and storeys and plausible.holds(mass) and not plausible.holds(mass / storeys):
        of_each = f"is doubtful: it is {mass / storeys:.6g} kg for each of {storeys} storeys"
        section.doubt("mass", f"{of_each}, and {plausible.usually}")
    return Building(
        name=section.read("name") or f"Building {number}",
        structure=structure,
        uncertain=described if isinstance(described, UncertainModel) else None,
        strength=strength,
        height=section.read("height"),
        storeys=storeys,
        design=read_design(section, 1, is_oscillator=True),
        ductility=ductility,
        section=section if ductility else None,
    )
