"""The small print of the page: the case as it was read, and what the answer leaves out."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

from stochlin.analyses.tables.toml import toml_text
from stochlin.messages import hyphenated
from stochlin.models.buildings import ModalBuilding, MultistoreyBuilding, ShearBuilding
from stochlin.views.separation.subjects import subject_of
from stochlin.views.shared.blocks import Term, Terms, Text
from stochlin.views.shared.words import site_in_words, valued

if TYPE_CHECKING:
    from stochlin.analyses.cases.reading.buildings import Building
    from stochlin.analyses.cases.reading.case import Case

KNOWN = "the error of all parameters given as known; the uncertainty of the others is in the answer"
PERIODS = "the error of the given periods and damping ratios"
LINE = (
    "The property line: it is on one side of the building, and nothing beyond it is in the model. Two "
    "neighbours that each stay on their own side cannot meet; if the neighbour stands nearer to the "
    "line, compute the gap between both buildings."
)


def uncertainties(case: Case) -> list[str]:
    """The uncertainties of the answer, for the page."""
    (modelled, first), scatter = models(case), case.site.scatter
    whose = "this building, so that the table compares how they use"
    if not case.alone:
        whose = "these buildings, so that the table compares how they combine"
    sentences = [
        f"Sampling: the interval covers the sampling of {case.simulated.motions} motions only. "
        "Four times as many motions would halve it.",
        "The ground: it is a stationary random motion with an envelope, and its spectrum and intensity "
        "are taken as given. The strength of the next earthquake is the largest unknown and not in the "
        f"interval{f'; a scatter of {scatter:g} about that strength' if scatter else ''}"
        f"{' is in the answer' if scatter else ''}.",
        f"{subject_of(case).the_buildings.capitalize()}: {modelled}. {first}, torsion of irregular "
        f"plans, soil under the foundations, and loss of strength are left out, and so is "
        f"{KNOWN if case.uncertain else PERIODS}.",
        f"The rules: formulas and combinations use the simulated peaks of {whose} peaks, and not "
        "how an engineer computes these peaks; only a code as you apply it uses displacements of a "
        "design. Load factors and minimum distances of codes are left out.",
    ]
    if case.alone:
        sentences.append(LINE)
    if any(building.strength == "ductility" for building in case.buildings):
        sentences.append(
            "Strength from ductility: it is found by linearization for a stationary motion."
        )
    if case.site.name == "fitted":
        sentences.append("The fit: it uses one record and one estimator.")
    return sentences


def models(case: Case) -> tuple[str, str]:
    """The models of the buildings, and the first effect that they leave out."""
    laws = [_law(building).replace("Bilinear", "bilinear") for building in case.buildings]
    storeys = [building.has_storeys for building in case.buildings]
    if not any(storeys):
        kinds = " or ".join(dict.fromkeys(laws))
        if case.alone:
            return f"it is one {kinds} oscillator, at the level of its roof", "Higher modes"
        return f"each is one {kinds} oscillator, at the level where they could meet", "Higher modes"
    descriptions = [
        f"{building.name} is {_kind(building, law)}"
        for building, law in zip(case.buildings, laws, strict=True)
    ]
    said = ", ".join(descriptions)
    if not any(isinstance(building.structure, ShearBuilding) for building in case.buildings):
        return f"{said}. The yielding of one mode does not affect the others", "Modes that are not given"
    return f"{said}. Floors are rigid and storeys deform in shear only", "Bending as a whole"


def _kind(building: Building, law: str) -> str:
    """The model of a building: storeys, modes, or one oscillator."""
    structure = building.structure
    if isinstance(structure, ModalBuilding):
        count = structure.modes
        return f"a sum of {count} modes, each a {law} oscillator" if count > 1 else f"one {law} mode"
    return f"a row of {law} storeys" if building.has_storeys else f"one {law} oscillator"


def _law(building: Building) -> str:
    """Name of the law of an oscillator, or of the storeys."""
    structure = building.structure
    law = structure.element_law if isinstance(structure, MultistoreyBuilding) else structure
    return hyphenated(type(law).__name__)


def facts(case: Case) -> Terms:
    """The models as they were read, in the units of their parameters."""
    ground = case.site.ground
    site = [text for text in (site_in_words(case), ground.source, *_parameters(ground)) if text]
    terms = [Term("Site", "; ".join(site))]
    if envelope := case.site.course.envelope:
        shape = [hyphenated(type(envelope).__name__), *_parameters(envelope)]
        terms.append(Term("Envelope", "; ".join(shape)))
    terms += [Term(building.name, "; ".join(_building(building))) for building in case.described]
    return Terms(terms)


def case_file(case: Case) -> list[Text]:
    """The tables of the case file, from which the same case can be typed again."""
    beside = ", ".join(path.name for path in case.files[1:])
    words = "With the same version of stochlin the case file gives the same numbers."
    needs = f" It needs these files beside it: {beside}." if beside else ""
    return [Text(words + needs), Text(toml_text(case.whole.table.values), "file")]


def _building(building: Building) -> list[str]:
    """The law and the parameters as the file gives them."""
    structure = building.structure
    parts = [_law(building), *_parameters(structure)]
    if isinstance(structure, MultistoreyBuilding):
        own = structure.law_parameters or {}
        parts += [f"{name} {valued(value, '1')}" for name, value in own.items()]
    if building.strength == "ductility":
        parts.append(f"ductility {building.form.ductility:g}")
    return parts


def _parameters(model: object) -> list[str]:
    """Parameters of a model by their declared names and units."""
    parts = []
    for field in dataclasses.fields(model):  # type: ignore[arg-type]
        value = getattr(model, field.name)
        if "units" in field.metadata and value is not None:
            parts.append(f"{field.metadata['long_name']} {valued(value, field.metadata['units'])}")
    return parts
