"""Scene of a case file, from a folder or uploaded by a browser."""

from __future__ import annotations

import dataclasses
import os
import tempfile
import warnings
from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np

from stochlin.analyses.cases.buildings import Building
from stochlin.analyses.cases.case import Case, read_case
from stochlin.analyses.cases.files.known import Known
from stochlin.analyses.cases.files.schema import ACCELERATION, TIME
from stochlin.analyses.cases.files.sections import Section, read_sections
from stochlin.analyses.cases.site import FITTED, NONE, PARALLEL
from stochlin.analyses.cases.sites.design_spectrum import SPECTRUM, design_spectrum
from stochlin.analyses.cases.storeys import StoreyBuilding
from stochlin.analyses.explorer.buildings import OF_FILE, REGULAR, StoreysOfFile
from stochlin.analyses.explorer.scene import (
    BY_DISPLACEMENT,
    COEFFICIENT,
    MOST_STOREYS,
    STOREY_HEIGHT,
    CaseFile,
    Scene,
)
from stochlin.analyses.explorer.sites import PGA, SA, MeasuredAcceleration, spectrum_of
from stochlin.analyses.sites.suites import table_rows
from stochlin.analyses.tables.inputs import only_within
from stochlin.messages import DoubtfulInput, brief, listed
from stochlin.models.envelopes import ENVELOPES
from stochlin.models.grounds import GROUNDS
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.parameters import Model
from stochlin.models.rules.codes import IN_COMMON

LONGEST_NAME = 255  # bytes, of a file on most systems
MEDIAN = "gaps by rules without simulation are those of the median strength"


def open_case(files: Mapping[str, bytes]) -> tuple[Scene, list[str]]:
    """Scene of a case file, and remarks on what of the file it does not contain.

    ``files`` are the contents of the case file and of the files that it names, by name; no other files
    are read. Raises the errors of `read_case`; its warnings are among the remarks.
    """
    cases = [name for name in files if name.endswith(".toml")]
    if len(cases) != 1:
        raise ValueError(
            f"{len(cases)} case files are chosen; allowed: one, its name ends in .toml, together with "
            "the files that it names, such as records"
        )
    for name in files:
        _check_name(name)
    with tempfile.TemporaryDirectory() as folder, only_within(Path(folder)):
        for name, data in files.items():
            (Path(folder) / name).write_bytes(data)
        path = Path(folder) / cases[0]
        with warnings.catch_warnings(record=True) as doubts:
            warnings.simplefilter("always", DoubtfulInput)
            try:
                _to_subfolders(read_sections(path).section("site", needed=False), files, path.parent)
                scene, notes = scene_of(read_case(path))
            except (OSError, ValueError) as error:
                raise ValueError(_without(folder, error)) from error
    return scene, [*(str(doubt.message) for doubt in doubts), *notes]


def _check_name(name: str) -> None:
    """Raise a ValueError unless an uploaded file can be kept under its name."""
    if name.strip(".") and not set(name) & {"/", "\\", "\0"} and len(name.encode()) <= LONGEST_NAME:
        return
    raise ValueError(
        f"the file name {brief(name)} cannot be used; allowed: a name of 1 to {LONGEST_NAME} bytes, not "
        "of dots alone, and without slashes; rename the file, and choose it again"
    )


def _without(folder: str, error: Exception) -> str:
    """Message of an error without the path of the temporary folder."""
    message = str(error).replace(f"{folder}{os.sep}", "")
    absent = isinstance(error.__cause__, FileNotFoundError)
    return (
        f"{message}; choose the case file together with the files that it names" if absent else message
    )


def _to_subfolders(site: Section, files: Mapping[str, bytes], folder: Path) -> None:
    """Move uploaded files to the subfolders of ``folder`` where the case looks for them."""
    for text in {*_texts(site.values), *_of_tables(files)}:
        chosen, there = folder / PurePosixPath(text).name, folder / text
        inside = ".." not in there.parts and there.is_relative_to(folder)
        if inside and there.name in files and not there.exists():
            there.parent.mkdir(parents=True, exist_ok=True)
            chosen.rename(there)


def _texts(values: Any) -> Iterator[str]:
    """All texts in nested tables and lists."""
    if isinstance(values, str):
        yield values
    elif isinstance(values, (dict, list)):
        for value in values.values() if isinstance(values, dict) else values:
            yield from _texts(value)


def _of_tables(files: Mapping[str, bytes]) -> Iterator[str]:
    """Names of the files in tables of records."""
    for name, content in files.items():
        with suppress(ValueError):  # it is no table of records
            yield from (row[1] for row in table_rows(content.decode("utf-8-sig", "replace"), name))


def scene_of(case: Case) -> tuple[Scene, list[str]]:
    """Scene of a case, and remarks on what of the file it does not contain.

    Raises a ValueError if a number is out of the range of the explorer.
    """
    whole, notes = read_sections(case.inputs[0]), []
    site = whole.section("site")
    names, numbers = case.ground.beside_structures(), _numbers(case.ground)
    of_site = site.text("ground") if "ground" in site else ""
    if of_site == FITTED:
        of_site = _kind_of(case)
        notes.append(
            f"The ground is fitted to {next(iter(case.records))}. The page keeps the fitted parameters."
        )
    values: dict[str, Any] = {name: numbers[own] for name, own in names.items() if own in numbers}
    if of_site not in GROUNDS:  # a named ground has the parameter intensity only
        values = {"intensity": numbers["intensity"]} if of_site else {}
    values["ground_of_file"] = case.ground if of_site == PARALLEL else None
    values |= {"site": of_site} | spectrum_of(case, _scale(case, site))
    for number, building in enumerate(case.pair, start=1):
        shown, remarks = _shown(case, building)
        values |= {f"{name}_{number}": value for name, value in shown.items()}
        notes += remarks
    values |= _motion(case)
    if case.gap is None:
        notes.append(f"The file has no existing gap: the page starts from {Scene.gap:g} m.")
    if case.uncertain:
        notes.append(
            f"Uncertain parameters ({listed(case.uncertain)}) are taken at their medians here, and in a "
            "case file saved here."
        )
    if case.scatter:
        of_file = "scatter" in whole.section("motion")
        source = "as in the file" if of_file else "the usual scatter of records, since the file has none"
        notes.append(f"Motions scatter by {case.scatter:g}, {source}; {MEDIAN}.")
    first, second = case.pair
    scene = Scene(
        case_file=CaseFile(case.inputs[0], case.records, whole.values),
        names=(first.name, second.name),
        heights=(first.height, second.height),
        storeys=(first.storeys, second.storeys),
        floor_masses=(_floor_mass(first), _floor_mass(second)),
        storeys_of_file=(_storeys_of(first), _storeys_of(second)),
        numbers=tuple(case.numbers.items()),
        **values,
    )
    return _as_measured(scene, site), notes


def _motion(case: Case) -> dict[str, Any]:
    """Parameters of the scene for the motion, the gap and the options of the case."""
    names = ("title", "confidence", "duration", "scatter", *IN_COMMON, "zone", "unverified")
    values: dict[str, Any] = {name: getattr(case, name) for name in (*names, "paths", "seed")}
    values["envelope"] = NONE
    if case.envelope is not None:
        values["envelope"] = next(n for n, kind in ENVELOPES.items() if type(case.envelope) is kind)
        values |= _numbers(case.envelope)
    return values if case.gap is None else values | {"gap": case.gap}


def _scale(case: Case, site: Section) -> float:
    """Factor on the spectrum of the file in the case."""
    if case.spectrum is None or "code" in case.spectrum.attrs:
        return 1.0
    values = {key: value for key, value in site.values.items() if key != "scale"}
    alone = dataclasses.replace(site, values=values)
    return float((case.spectrum / design_spectrum(alone, case.inputs[0].parent, Known()))[0])


def _as_measured(scene: Scene, site: Section) -> Scene:
    """The scene, with its intensity given by a mean acceleration of the motions if the file does so."""
    key, measure = ("pga", PGA) if "pga" in site else ("sa", SA)
    if key not in site or SPECTRUM in site:
        return scene
    value = site.number(key, ACCELERATION)
    period = site.number("sa_period", TIME) if measure == SA else scene.sa_period
    values: dict[str, Any] = {key: value, "sa_period": period}
    scene = dataclasses.replace(scene, measure=measure, **values)
    return dataclasses.replace(
        scene, measured=MeasuredAcceleration(scene.motions, value / scene.intensity**0.5)
    )


def _kind_of(case: Case) -> str:
    """Name of the kind of ground of a case."""
    return next((name for name, kind in GROUNDS.items() if type(case.ground) is kind), PARALLEL)


def _shown(case: Case, building: Building | StoreyBuilding) -> tuple[dict[str, Any], list[str]]:
    """Parameters of the scene for a building, and remarks on what they do not contain."""
    notes = []
    if isinstance(building, StoreyBuilding):
        shown = _shown_storeys(case, building)
    else:
        shown = _shown_oscillator(case, building)
        if building.strength == "ductility":
            notes.append(
                f"The strength of {building.name}, given by ductility, is kept as a reduction factor "
                "here: another ground or period changes its yield displacement."
            )
    return shown | {"yields": building.structure.yields}, notes


def _shown_oscillator(case: Case, building: Building) -> dict[str, Any]:
    """Parameters of the scene for a building without storeys."""
    structure = building.structure
    if not isinstance(structure, Bilinear):
        raise ValueError(
            f"{case.file}: {building.name} is a {type(structure).__name__}; allowed in the "
            "explorer: bilinear buildings; 'stochlin gap' and 'stochlin probability' accept every law"
        )
    shown: dict[str, Any] = _numbers(structure)
    shown = {name: value for name, value in shown.items() if name not in ("peak_factor", "mass")}
    if building.strength == "yield_displacement":
        shown["strength_by"] = BY_DISPLACEMENT
    if (
        building.storeys and building.storeys <= MOST_STOREYS
    ):  # initial values for a description by storeys
        shown["storey_count"] = building.storeys
        if building.storey_height and STOREY_HEIGHT.contains(building.storey_height):
            shown["storey_height"] = building.storey_height
    return shown


def _shown_storeys(case: Case, building: StoreyBuilding) -> dict[str, Any]:
    """Parameters of the scene for a building with storeys, regular or as in the file."""
    if building.storeys > MOST_STOREYS:
        raise ValueError(
            f"{case.file}: {building.name} has {building.storeys} storeys; allowed in the explorer: 1 "
            f"to {MOST_STOREYS}; 'stochlin gap' and 'stochlin probability' accept more"
        )
    structure, arguments = building.structure, building.regular
    shown: dict[str, Any] = {"storey_count": structure.storeys, "damping": structure.damping}
    if structure.yields:
        shown["hardening"] = structure.hardening
    if arguments is not None and _plainly_regular(arguments):
        names = ("period", "storey_height", "base_shear_coefficient")
        return (
            shown
            | {"description": REGULAR}
            | {name: arguments[name] for name in names if name in arguments}
        )
    return shown | {"description": OF_FILE, "period": StoreysOfFile.of(structure).period}


def _storeys_of(building: Building | StoreyBuilding) -> StoreysOfFile | None:
    """Storeys of a building that is not regular; None for other buildings."""
    if isinstance(building, Building):
        return None
    arguments = building.regular
    regular = arguments is not None and _plainly_regular(arguments)
    return None if regular else StoreysOfFile.of(building.structure)


def _plainly_regular(arguments: Mapping[str, Any]) -> bool:
    """Whether the parameters of the scene describe a regular building completely."""
    return (
        np.ndim(arguments["storey_height"]) == 0
        and arguments["law"] == "bilinear"
        and not arguments["p_delta"]
        and not np.any(arguments.get("dampers", 0.0))
        and bool(COEFFICIENT.contains(arguments.get("base_shear_coefficient", COEFFICIENT.upper)))
    )


def _floor_mass(building: Building | StoreyBuilding) -> float:
    if isinstance(building, Building):
        return Scene.floor_masses[0]
    return float(building.structure.arrays()["masses"].mean())


def _numbers(model: Model) -> dict[str, float]:
    return {name: float(value) for name, value in model.arrays().items()}
