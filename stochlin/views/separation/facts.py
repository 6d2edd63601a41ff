"""The small print of the page: the case as it was read, its uncertainties, a statement to sign."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

import numpy as np

from stochlin.analyses.cases.files.design import OF_DESIGN
from stochlin.analyses.cases.storeys import StoreyBuilding
from stochlin.analyses.records.files import METRES
from stochlin.analyses.tables.toml import toml_text
from stochlin.messages import hyphenated
from stochlin.models.buildings import ModalBuilding, MultistoreyBuilding, ShearBuilding
from stochlin.views.separation.risk import risk_sentences
from stochlin.views.separation.subjects import subject_of
from stochlin.views.separation.verdict import existing, headline, needed, verdict
from stochlin.views.separation.words import confidence, ductilities, rows
from stochlin.views.shared.blocks import Term, Terms, Text
from stochlin.views.shared.descriptions import site_in_words, source_in_words
from stochlin.views.shared.uncertain import contained
from stochlin.views.shared.words import SPACE, length, per_cent, scatter, shaking, valued

if TYPE_CHECKING:
    import xarray as xr

    from stochlin.analyses.cases.buildings import AnyBuilding
    from stochlin.analyses.cases.case import Case
    from stochlin.analyses.cases.separation import CaseAnswer

TOLD = {
    "floors_align": "floors align",
    "same_property": "on one property",
    "same_system": "same structural system",
}
LINE = (
    "The property line: it is on one side of the building, and nothing beyond it is in the model. Two "
    "neighbours that each stay on their own side cannot meet; if the neighbour stands nearer to the "
    "line, compute the gap between both buildings."
)
KNOWN = "All parameters are taken as known; their errors are not in the answer."
SIGNED = ("Date", "Prepared by", "Checked by")  # by hand: the same case makes the same page


def uncertainties(answer: CaseAnswer) -> list[str]:
    """The uncertainties of the answer, for the page."""
    case, table = answer.case, answer.separation
    modelled, first = models(case)
    sentences = [
        f"Sampling: the interval covers the sampling of {case.paths} motions only. Four times as many "
        "motions would halve it.",
        "The ground: it is a stationary random motion with an envelope, and its spectrum and intensity "
        "are taken as given. The strength of the next earthquake is the largest unknown and not in the "
        f"interval{f'; a scatter of {case.scatter:g} about that strength' if case.scatter else ''}"
        f"{' is in the answer' if case.scatter else ''}.",
        f"{subject_of(case).the_buildings.capitalize()}: {modelled}. {first}, torsion of irregular "
        f"plans, soil under the foundations, and loss of strength are left out, and so is "
        f"{_of_parameters(case)}.",
        f"The rules: formulas and combinations use the simulated peaks of {_whose(case)} peaks, and not "
        "how an engineer computes these peaks; only a code as you apply it uses displacements of a "
        "design. Load factors and minimum distances of codes are left out.",
    ]
    if case.alone:
        sentences.append(LINE)
    if any(building.strength == "ductility" for building in case.buildings):
        sentences.append(
            "Strength from ductility: it is found by linearization for a stationary motion; the "
            f"simulated mean peak ductilities in this motion are {ductilities(table)}."
        )
    if case.fitted:
        sentences.append(f"The fit: it uses one record and one estimator. {source_in_words(case)}.")
    doubtful = [row.label for row in rows(answer) if "M" in row.mark]
    if doubtful:
        sentences.append(f"Not compared with their sources: {', '.join(doubtful)}.")
    return sentences


def _whose(case: Case) -> str:
    """The building or buildings, and the subject of the comparison of rules."""
    if case.alone:
        return "this building, so that the table compares how they use"
    return "these buildings, so that the table compares how they combine"


def _of_parameters(case: Case) -> str:
    """The uncertainty of the parameters that were given."""
    if case.uncertain:
        return (
            "the error of all parameters given as known; the uncertainty of the others is in the answer"
        )
    return "the error of the given periods and damping ratios"


def models(case: Case) -> tuple[str, str]:
    """The models of the buildings, and the first effect that they leave out."""
    laws = [_law(building).replace("Bilinear", "bilinear") for building in case.buildings]
    storeys = [isinstance(building, StoreyBuilding) for building in case.buildings]
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


def _kind(building: AnyBuilding, law: str) -> str:
    """The model of a building: storeys, modes, or one oscillator."""
    structure = building.structure
    if isinstance(structure, ModalBuilding):
        count = structure.modes
        return f"a sum of {count} modes, each a {law} oscillator" if count > 1 else f"one {law} mode"
    return f"a row of {law} storeys" if isinstance(building, StoreyBuilding) else f"one {law} oscillator"


def _law(building: AnyBuilding) -> str:
    """Name of the law of an oscillator, or of the storeys."""
    structure = building.structure
    law = structure.element_law if isinstance(structure, MultistoreyBuilding) else structure
    return hyphenated(type(law).__name__)


def facts(answer: CaseAnswer) -> list[Terms]:
    """The case as it was read, with units, in groups."""
    case = answer.case
    acceleration = answer.rms_acceleration / METRES["g"]
    rms = f"{acceleration:.2g}{SPACE}g" if np.isfinite(acceleration) else "unbounded (white noise)"
    ground = [("ground", site_in_words(case)), *_parameters(case.ground)]
    ground.append(("rms acceleration in the strong part", rms))
    if source := source_in_words(case):
        ground.append(("source", source))
    motion = [("duration", f"{case.duration:g}{SPACE}s")]
    motion.append(("envelope", hyphenated(type(case.envelope).__name__) if case.envelope else "none"))
    motion += _parameters(case.envelope) if case.envelope else []
    motion.append(("scatter from motion to motion", f"{case.scatter:g}"))
    answered = [(label, "yes" if getattr(case, name) else "no") for name, label in TOLD.items()]
    wanted = [
        ("confidence", per_cent(case.confidence, 1)),
        (f"existing {subject_of(case).gap}", "none" if case.gap is None else length(case.gap)),
        *([] if case.alone else answered),
        ("zone of Mexico City", case.zone or "not given"),
        *([("design PGA", f"{pga / METRES['g']:.3g}{SPACE}g")] if (pga := case.given_pga) else []),
        ("simulated motions", f"{case.paths}, seed {case.seed}"),
    ]
    groups = {"Site": ground, "Motion": motion}
    for n, building in enumerate(case.buildings, start=1):
        groups[f"Building {n}"] = _building(building, answer.separation, n)
        groups[f"Building {n}"] += _noted(case, f"building_{n}")
    groups["Separation"] = wanted
    return [Terms([Term(*fact) for fact in members], group) for group, members in groups.items()]


def case_file(case: Case) -> list[Text]:
    """The tables of the case file, from which the same case can be typed again."""
    beside = ", ".join(path.name for path in case.inputs[1:])
    words = "With the same version of stochlin it gives the same numbers."
    needs = f" It needs these files beside it: {beside}." if beside else ""
    return [Text(words + needs), Text(toml_text(case.whole.values), "file")]


def _noted(case: Case, table: str) -> list[tuple[str, str]]:
    """What a table of the case file says that no simulation depends on."""
    section = case.whole.section(table)
    return [
        (key.label.lower(), ", ".join(np.ravel(section.values[name]).astype(str)))
        for name, key in section.keys.items()
        if (key.noted or name in OF_DESIGN) and name in section
    ]


def _building(building: AnyBuilding, table: xr.Dataset, number: int) -> list[tuple[str, str]]:
    structure = building.structure
    parameters = _parameters(structure)
    if (law := _law(building)) != "Bilinear":
        parameters = [("hysteresis law", law), *parameters]
    of = ""
    if isinstance(structure, MultistoreyBuilding):
        of = " of the first mode"
        parameters = [(f"period{of}", f"{building.period:.4g}{SPACE}s"), *parameters]
        parameters += [
            (name, valued(value, "1")) for name, value in (structure.law_parameters or {}).items()
        ]
        if isinstance(structure, ShearBuilding) and structure.p_delta:
            parameters += [("weight softens storeys (P-delta)", "yes")]
        if isinstance(structure, ShearBuilding) and structure.damping_modes:
            modes = "modes {} and {} (Rayleigh, initial stiffness)".format(*structure.damping_modes)
            parameters += [("this damping ratio in", modes)]
    if structure.yields:
        shown = {f"reduction factor{of}": f"{float(table[f'reduction_factor_{number}']):.3g}"}
        shown[f"yield displacement{of}"] = length(float(table[f"yield_displacement_{number}"]))
        parameters = [fact for fact in parameters if fact[0] not in shown] + list(shown.items())
    else:
        parameters = [fact for fact in parameters if fact[0] != "peak factor"]
    height = "not given" if building.height is None else f"{building.height:g}{SPACE}m"
    strength = building.strength.replace("_", " ")
    falls = table.get(f"collapse_probability_{number}")
    fallen = [] if falls is None else [("falls in", f"{valued(100 * float(falls), '%')} of the motions")]
    return [
        ("name", building.name),
        *parameters,
        ("strength given by", strength),
        *fallen,
        ("mean peak displacement", length(float(table[f"peak_mean_{number}"]))),
        ("height", height),
        ("storeys", "not given" if building.storeys is None else str(building.storeys)),
    ]


def _parameters(model: object) -> list[tuple[str, str]]:
    """Parameters of a model by their declared names and units."""
    facts = []
    for field in dataclasses.fields(model):  # type: ignore[arg-type]
        value = getattr(model, field.name)
        if "units" in field.metadata and value is not None:
            facts.append((field.metadata["long_name"], valued(value, field.metadata["units"])))
    return facts


def statement(answer: CaseAnswer) -> list[Term]:
    """What was asked, by which method, with what result and error, and by which program."""
    case, table, about = answer.case, answer.separation, subject_of(answer.case)
    site = ": ".join(filter(None, (site_in_words(case), source_in_words(case))))
    said = [
        ("Result", headline(answer)),
        (
            "Criterion",
            f"{about.kept.capitalize()} in {confidence(case)} of the motions of the site, if the "
            f"{about.gap} is at least this result.",
        ),
        (
            "Error",
            f"The 95{SPACE}% interval of the {about.gap} is {needed(answer)}. It covers the "
            f"sampling of {case.paths} motions; 'Limits of this answer' lists what it leaves out.",
        ),
        (
            "Method",
            f"Nonlinear time-history simulation of {about.the_buildings} in {case.paths} random ground "
            f"motions of {case.duration:g}{SPACE}s, Gaussian filtered noise with an envelope: "
            f"{models(case)[0]}.",
        ),
        ("Site", f"{site}. {shaking(answer.shaking, case)} {scatter(case)}".strip()),
        ("Uncertainty", contained(case, f"the {about.gap} is that") or KNOWN),
        ("Inputs", f"They are listed under 'The case' and 'The case file', as read from {case.file}."),
        (
            "Program",
            f"stochlin {table.attrs['stochlin_version']}, seed {case.seed}. The same file and version "
            "give the same numbers.",
        ),
    ]
    if sentences := risk_sentences(answer):
        said.insert(3, ("Risk", " ".join(sentences)))
    if answer.existing is not None:
        said.insert(3, (f"Existing {about.gap}", f"{existing(answer)} {verdict(answer)}"))
    return [Term(name, text) for name, text in said]
