"""The case as it was read, and what its answer does not know: the small print of the page."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

import numpy as np

from stochlin.analyses.cases.storeys import StoreyBuilding
from stochlin.analyses.records.files import METRES
from stochlin.models.buildings import ShearBuilding
from stochlin.views.separation.words import ductilities, rows
from stochlin.views.shared.words import length, per_cent

if TYPE_CHECKING:
    import numpy.typing as npt
    import xarray as xr

    from stochlin.analyses.cases.buildings import AnyBuilding
    from stochlin.analyses.cases.case import Case
    from stochlin.analyses.cases.separation import CaseAnswer


LARGE = {"kg": ("t", 1e-3), "N/m": ("MN/m", 1e-6), "N s/m": ("MN s/m", 1e-6)}


def uncertainties(answer: CaseAnswer) -> list[str]:
    """What the answer does not know, for the page."""
    case, table = answer.case, answer.separation
    sentences = [
        f"Chance: the interval covers the sampling of {case.paths} motions only. Four times as many "
        "would halve it.",
        "The ground: a stationary random motion with an envelope, its spectrum and intensity taken as "
        "given. How strong the next earthquake will be is the largest unknown, and not in the interval"
        f"{f'; a scatter of {case.scatter:g} about that is in the answer' if case.scatter else ''}.",
        f"The buildings: {_models(case)}, torsion, soil under the foundations, and loss of strength are "
        "left out, and so is the error of the periods and dampings that you gave.",
        "The rules: all are fed with the simulated peaks of these buildings, so that the table judges "
        "how they combine peaks, not how an engineer would get those peaks. Building codes have "
        "displacements, load factors and least distances of their own in mind.",
    ]
    if any(building.strength == "ductility" for building in case.pair):
        sentences.append(
            "Strength from ductility: found by linearization, for a motion without end; the simulated "
            f"mean peaks of this one are {ductilities(table)}."
        )
    if case.fitted:
        sentences.append(f"The fit: one record, one estimator. {case.ground.source}.")
    doubtful = [row.label for row in rows(answer) if "M" in row.mark]
    if doubtful:
        sentences.append(f"From memory, not compared with their sources: {', '.join(doubtful)}.")
    return sentences


def _models(case: Case) -> str:
    """What the buildings are taken for, and the first of what that leaves out."""
    laws = [_law(building).replace("Bilinear", "bilinear") for building in case.pair]
    storeys = [isinstance(building, StoreyBuilding) for building in case.pair]
    if not any(storeys):
        kinds = " or ".join(dict.fromkeys(laws))
        return f"each is one {kinds} oscillator, at the level where they could meet. Higher modes"
    told = [
        f"{building.name} is {f'a row of {law} storeys' if known else f'one {law} oscillator'}"
        for building, law, known in zip(case.pair, laws, storeys, strict=True)
    ]
    return f"{', '.join(told)}. Floors are stiff and storeys shear alone. Bending as a whole"


def _law(building: AnyBuilding) -> str:
    """Name of the law of an oscillator, or of the storeys."""
    structure = building.structure
    return type(structure.storey_law if isinstance(structure, ShearBuilding) else structure).__name__


def facts(answer: CaseAnswer) -> list[tuple[str, str, str]]:
    """The case as it was read: group, name, value with units."""
    case = answer.case
    acceleration = answer.rms_acceleration / METRES["g"]
    rms = f"{acceleration:.2g} g" if np.isfinite(acceleration) else "unbounded (white noise)"
    ground = [("Site", "ground", f"{case.site}, {case.ground.name}")]
    ground += [("Site", *fact) for fact in _parameters(case.ground)]
    ground.append(("Site", "rms acceleration in the strong part", rms))
    if case.ground.source:
        ground.append(("Site", "source", case.ground.source))
    motion = [("Motion", "duration", f"{case.duration:g} s")]
    motion.append(("Motion", "envelope", type(case.envelope).__name__ if case.envelope else "none"))
    motion += [("Motion", *fact) for fact in (_parameters(case.envelope) if case.envelope else [])]
    motion.append(("Motion", "scatter from motion to motion", f"{case.scatter:g}"))
    wanted = [
        ("confidence", per_cent(case.confidence, 1)),
        ("existing gap", "none" if case.gap is None else length(case.gap)),
        ("floors align", "yes" if case.floors_align else "no"),
        ("zone of Mexico City", case.zone or "not given"),
        ("simulated motions", f"{case.paths}, seed {case.seed}"),
    ]
    both = [
        (f"Building {n}", *fact)
        for n, building in enumerate(case.pair, start=1)
        for fact in _building(building, answer.separation, n)
    ]
    return [*ground, *motion, *both, *(("Separation", *fact) for fact in wanted)]


def _building(building: AnyBuilding, table: xr.Dataset, number: int) -> list[tuple[str, str]]:
    structure = building.structure
    found = _parameters(structure)
    if (law := _law(building)) != "Bilinear":
        found = [("hysteresis law", law), *found]
    of = ""
    if isinstance(structure, ShearBuilding):
        of = " of the first mode"
        found = [(f"period{of}", f"{building.period:.4g} s"), *found]
        found += [(name, _shown(value)) for name, value in (structure.law_parameters or {}).items()]
        found += [("weight softens storeys (P-delta)", "yes")] if structure.p_delta else []
    if structure.yields:
        shown = {f"reduction factor{of}": f"{float(table[f'reduction_factor_{number}']):.3g}"}
        shown[f"yield displacement{of}"] = length(float(table[f"yield_displacement_{number}"]))
        found = [fact for fact in found if fact[0] not in shown] + list(shown.items())
    else:
        found = [fact for fact in found if fact[0] != "peak factor"]
    height = "not given" if building.height is None else f"{building.height:g} m"
    given = building.strength.replace("_", " ")
    return [
        ("name", building.name),
        *found,
        ("strength given by", given),
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
            units, scale = LARGE.get(field.metadata["units"], (field.metadata["units"], 1.0))
            units = units.replace("^2", "²").replace("^3", "³")
            shown = f"{_shown(scale * np.asarray(value))} {units if units != '1' else ''}".strip()
            facts.append((field.metadata["long_name"], shown))
    return facts


def _shown(value: npt.ArrayLike) -> str:
    """Storey by storey where they differ."""
    each = [f"{one:.4g}" for one in np.atleast_1d(value)]
    return ", ".join(each if len(set(each)) > 1 else each[:1])
