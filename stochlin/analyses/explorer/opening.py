"""A case file opened in the explorer, from a folder or uploaded by a browser."""

from __future__ import annotations

import copy
import os
import tempfile
import warnings
from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np

from stochlin.analyses.cases.buildings import AnyBuilding
from stochlin.analyses.cases.case import Case, read_case
from stochlin.analyses.cases.files.design import OF_DESIGN
from stochlin.analyses.cases.files.keys import Key
from stochlin.analyses.cases.files.modes import MODES, OF_READING, in_tables, modes_of
from stochlin.analyses.cases.files.quantities import Quantity, in_si, is_uncertain
from stochlin.analyses.cases.files.schema import (
    BUILDING,
    FILE,
    HEIGHTS,
    MOST_STOREYS,
    NUMBER,
    OF_PUSHOVER,
    OSCILLATOR,
    PUSHOVER,
    REGULAR,
    SHEARS,
)
from stochlin.analyses.cases.files.sections import Section, read_sections
from stochlin.analyses.cases.site import FITTED, NONE, PARALLEL
from stochlin.analyses.cases.sites.strength import GOALS, HAZARD
from stochlin.analyses.cases.storeys import StoreyBuilding
from stochlin.analyses.explorer.form import (
    BUILDINGS,
    ENVELOPE,
    GROUND,
    OF_FILE,
    PGA,
    PLAIN_FLOORS,
    S0,
    SA,
    SECOND,
    STRENGTHS,
    Form,
    NumberControl,
    Place,
    keys_of,
    numbers,
    written,
)
from stochlin.analyses.sites.suites import table_rows
from stochlin.analyses.tables.inputs import only_within
from stochlin.messages import DoubtfulInput, brief, listed
from stochlin.models.arguments import Whole
from stochlin.models.buildings.base import MODE
from stochlin.models.envelopes import ENVELOPES
from stochlin.models.grounds import GROUNDS, Ground, ParallelGround
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.parameters import Model, Range
from stochlin.models.systems import elastic_period
from stochlin.models.uncertain import median_of

LONGEST_NAME = 255  # bytes, of a file on most systems
MEDIAN = "gaps by rules without simulation are those of the median strength"
BY_FACTOR, BY_DISPLACEMENT = STRENGTHS
# Keys of which there are controls for storeys of a file, and those of a regular building without more.
OF_CONTROLS = ("name", "period", "damping", "hardening", "strength_factor")
PLAINLY = {*("name", "period", "storeys", "storey_height", "floor_mass", "damping", "hardening")} | {
    *("base_shear_coefficient", "elastic")
}


def first_form() -> Form:
    """What the controls say where no file says anything."""
    values: dict[Place, Any] = {number.place: _start(number) for number in numbers()}
    values |= {
        GROUND: "firm",
        ENVELOPE: "amin_ang",
        ("site", "measure"): S0,
        ("site", "soil"): "C",
        ("site", "type"): 1,
    }
    for name in BUILDINGS:
        values |= {
            (name, "described"): OSCILLATOR,
            (name, "yields"): True,
            (name, "strength"): BY_FACTOR,
        }
    return Form(values, rest={name: {REGULAR: PLAIN_FLOORS} for name in BUILDINGS})


def _start(number: NumberControl) -> float:
    second = SECOND if number.place[0] == BUILDINGS[1] else {}
    start = second.get(number.key.name, number.slider.start)
    return start if isinstance(number.key.kind, Whole) else start * number.key.unit_size


def open_case(files: Mapping[str, bytes]) -> tuple[Form, list[str]]:
    """The form of a case file, and remarks on what of the file it does not contain.

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
                _to_subfolders(read_sections(path), files, path.parent)
                form, notes = opened(read_case(path))
            except (OSError, ValueError) as error:
                raise ValueError(_without(folder, error)) from error
    return form, [*(str(doubt.message) for doubt in doubts), *notes]


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


def _to_subfolders(whole: Section, files: Mapping[str, bytes], folder: Path) -> None:
    """Move uploaded files to the subfolders of ``folder`` where the case looks for them."""
    for text in {*_texts(whole.values), *_of_tables(files)}:
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


def opened(case: Case) -> tuple[Form, list[str]]:
    """The form of a case, and remarks on what of the file it does not contain.

    What would have to be sought again for other values is taken as numbers: a ground fitted to a
    record, a strength by ductility, the intensity of a return period. Raises a ValueError if a number
    is out of the range of the explorer.
    """
    tables: dict[str, Any] = copy.deepcopy(dict(case.whole.values))
    notes: list[str] = []
    pair = dict(zip(BUILDINGS, case.pair, strict=True))
    for name, building in pair.items():
        if MODES in tables[name]:
            modes = modes_of(case.whole.section(name), case.inputs[0].parent, case.of_site.known)
            if building.strength == PUSHOVER:  # it changes the period of the first mode
                modes = modes.assign(period=(MODE, building.structure.arrays()["periods"].to_numpy()))
            kept = {key: value for key, value in tables[name].items() if key not in OF_READING}
            if isinstance(file := kept[MODES], str):
                notes.append(f"The modes of {building.name} are kept as tables here, and not in {file}.")
            tables[name] = kept | in_tables(modes)
    for name in ("site", *BUILDINGS):
        _at_medians(case, name, tables[name])
    choices = _open_site(case, tables["site"], notes)
    choices |= _open_motion(case, tables["motion"])
    if case.gap is not None:
        tables["separation"]["existing"] = _one(tables["separation"]["existing"])
    rest = {}
    for name, building in pair.items():
        shown, rest[name] = _open_building(case, name, building, tables[name], notes)
        choices |= {(name, key): value for key, value in shown.items()}
    first = first_form()
    form = Form({**first.values, **choices}, tables, rest, case.inputs[0], case.of_site.known)
    form = form.changed(_numbers(case, form))
    of_form = form.case()  # what does not fit is refused here
    if form[GROUND] == FILE:
        of_form.of_site.take(case.of_site.shaking)
    if case.gap is None:
        start = first["separation", "existing"]
        notes.append(f"The file has no existing gap: the page starts from {100 * start:g} cm.")
    if case.uncertain:
        notes.append(
            f"Uncertain parameters ({listed(case.uncertain)}) are taken at their medians here, and in a "
            "case file saved here."
        )
    if case.scatter:
        of_file = "scatter" in case.whole.values["motion"]
        source = "as in the file" if of_file else "the usual scatter of records, since the file has none"
        notes.append(f"Motions scatter by {case.scatter:g}, {source}; {MEDIAN}.")
    return form, notes


def _numbers(case: Case, form: Form) -> dict[Place, Any]:
    """The numbers of the file for those controls that it has."""
    said = {}
    for number in numbers():
        name, key = number.place[0], number.key
        if key.name in form.file.get(name, {}) and form.uses(number.place):
            section = Section(case.file, (name,), form.file[name], case.whole.lines)
            value = _read(section, key)
            limits = number.slider.limits
            if isinstance(limits, Whole) and not limits.contains(value):
                allowed = f"{limits.lowest} to {limits.highest}"
                raise section.error(key.name, f"is out of range in the explorer; allowed: {allowed}")
            if isinstance(limits, Range) and not limits.contains(value):
                units = key.kind.units if isinstance(key.kind, Quantity) else "1"
                unit = "" if units == "1" else f", in {units}"
                raise section.error(
                    key.name, f"is out of range in the explorer; allowed: {limits}{unit}"
                )
            said[number.place] = value
    return said


def _read(section: Section, key: Key) -> Any:
    if isinstance(key.kind, Whole):
        return section.whole(key.name, key.kind)
    assert isinstance(key.kind, Quantity)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DoubtfulInput)  # the warning was given when the file was read
        return section.number(key.name, key.kind)


def _one(existing: Any) -> Any:
    return existing[0] if isinstance(existing, list) else existing


def _at_medians(case: Case, name: str, table: dict[str, Any]) -> None:
    """Put the medians of the uncertain numbers of a table in their place."""
    section = Section(case.file, (name,), dict(table), case.whole.lines)
    for key in keys_of(name).values():
        value = table.get(key.name)
        each = value if isinstance(value, list) else [value]
        if isinstance(key.kind, Quantity) and any(map(is_uncertain, each)):
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", DoubtfulInput)
                median = np.asarray(median_of(section.parameter_or_list(key.name, key.kind)))
            texts = [written(key, number, {}) for number in median.ravel().tolist()]
            table[key.name] = texts if median.ndim else texts[0]


def _open_site(case: Case, site: dict[str, Any], notes: list[str]) -> dict[Place, Any]:
    """What the choices of the site say; what was fitted or scaled is put into its table as numbers."""
    if "spectrum" in site:
        if case.spectrum is not None and "code" not in case.spectrum.attrs:
            unscaled = case.of_site.spectrum
            assert unscaled is not None
            site["scale"] = float((case.spectrum / unscaled)[0]) * site.get("scale", 1.0)
            for key in (*GOALS, "intensity"):
                if key != HAZARD:
                    site.pop(key, None)
            return {GROUND: FILE}
        said = {key: site[key] for key in ("soil", "type") if key in site}
        return {GROUND: site["spectrum"], **{("site", key): value for key, value in said.items()}}
    if site["ground"] == FITTED:
        notes.append(
            f"The ground is fitted to {next(iter(case.records))}. The page keeps the fitted parameters."
        )
        for key in ("model", "estimator", "filters", *(goal for goal in GOALS if goal != HAZARD)):
            site.pop(key, None)
        site |= _ground(case.ground)
    elif "return_period" in site:
        del site["return_period"]
        site["intensity"] = _ground(case.ground)["intensity"]
    measure = next((way for way, key in ((PGA, "pga"), (SA, "sa")) if key in site), S0)
    return {GROUND: site["ground"], ("site", "measure"): measure}


def _ground(ground: Ground) -> dict[str, Any]:
    """A ground as a table of a case file."""
    if isinstance(ground, ParallelGround):
        parts = [_ground(part) for part in ground.grounds]
        intensity = float(ground.arrays()["intensity"])
        return {"ground": PARALLEL, "intensity": f"{intensity!r} m^2/s^3", "grounds": parts}
    return {"ground": _kind(ground, GROUNDS), **_texts_of(ground)}


def _open_motion(case: Case, motion: dict[str, Any]) -> dict[Place, Any]:
    """What the choice of the envelope says; a fitted one is put into its table as numbers."""
    if motion.get("envelope") == FITTED:
        motion |= {"duration": f"{case.duration!r} s", **_texts_of(case.envelope)}
    motion["scatter"] = case.scatter
    return {ENVELOPE: NONE if case.envelope is None else _kind(case.envelope, ENVELOPES)}


def _kind(model: Model, kinds: Mapping[str, type[Model]]) -> str:
    return next(name for name, kind in kinds.items() if type(model) is kind)


def _texts_of(model: Any) -> dict[str, Any]:
    """The parameters of a model as they are written in a file."""
    values = {name: float(value) for name, value in model.arrays().items()}
    units = {name: model.units(name) for name in values}
    return {n: v if units[n] == "1" else f"{v!r} {units[n]}" for n, v in values.items()}


def _open_building(
    case: Case, name: str, building: AnyBuilding, table: dict[str, Any], notes: list[str]
) -> tuple[dict[str, Any], dict[str, dict[str, Any]]]:
    """What the controls of a building say besides its keys, and its rest for each way to describe it."""
    shown: dict[str, Any] = {"yields": building.structure.yields}
    if building.strength == PUSHOVER:
        _in_numbers(building, table)
        notes.append(f"What a pushover curve says of {building.name} is kept as numbers here.")
    if isinstance(building, StoreyBuilding):
        return _open_storeys(case, building, table, shown)
    structure = building.structure
    if not isinstance(structure, Bilinear):
        raise ValueError(
            f"{case.file}: {building.name} is a {type(structure).__name__}; allowed in the "
            "explorer: bilinear buildings; 'stochlin gap' and 'stochlin probability' accept every law"
        )
    if building.strength == "ductility":
        del table["ductility"]
        table["reduction_factor"] = float(structure.arrays()["reduction_factor"])
        notes.append(
            f"The strength of {building.name}, given by ductility, is kept as a reduction factor "
            "here: another ground or period changes its yield displacement."
        )
    by_displacement = building.strength in ("yield_displacement", PUSHOVER)
    shown |= {
        "described": OSCILLATOR,
        "strength": BY_DISPLACEMENT if by_displacement else BY_FACTOR,
        **_storeys_to_begin_with(building),
    }
    kept = {key: table[key] for key in ("mass", "height", "storeys") if key in table}
    return shown, {OSCILLATOR: kept | _noted(table), REGULAR: PLAIN_FLOORS | _noted(table)}


def _in_numbers(building: AnyBuilding, table: dict[str, Any]) -> None:
    """Put the numbers that a building has from a pushover curve in place of the name of its file."""
    names = ["period", "yield_displacement"]
    if isinstance(building, StoreyBuilding):
        of_storeys = ["masses", "stiffnesses", "heights", "yield_drifts"]
        names = ["yield_displacements"] if MODES in table else of_storeys
        for key in ("period", "floor_mass", "storeys", "storey_height", "strength_factor"):
            table.pop(key, None)
    for key in (PUSHOVER, *OF_PUSHOVER):
        table.pop(key, None)
    values, structure = building.structure.arrays(), building.structure
    for name in names:
        texts = [f"{number!r} {structure.units(name)}" for number in np.ravel(values[name]).tolist()]
        table[name] = texts if values[name].ndim else texts[0]
    table["hardening"] = values["hardening"].item()


def _open_storeys(
    case: Case, building: StoreyBuilding, table: dict[str, Any], shown: dict[str, Any]
) -> tuple[dict[str, Any], dict[str, dict[str, Any]]]:
    """The same for a building with storeys, regular or as in the file."""
    if building.storeys > MOST_STOREYS:
        raise ValueError(
            f"{case.file}: {building.name} has {building.storeys} storeys; allowed in the explorer: 1 "
            f"to {MOST_STOREYS}; 'stochlin gap' and 'stochlin probability' accept more"
        )
    structure, noted = building.structure, _noted(table)
    floors = {"height": f"{building.height!r} m", "storeys": building.storeys}
    rest = {OSCILLATOR: floors | noted, REGULAR: noted}
    shear = table.get("base_shear_coefficient", 0.0)
    if {*table} - {*noted} <= PLAINLY and SHEARS.contains(in_si(shear, NUMBER) or SHEARS.upper):
        rest[REGULAR] = {"floor_mass": table["floor_mass"], **noted}
        return shown | {"described": REGULAR}, rest
    mean = float(structure.arrays()["masses"].mean())
    rest[REGULAR] = {"floor_mass": f"{mean!r} kg", **noted}
    rest[OF_FILE] = {key: value for key, value in table.items() if key not in OF_CONTROLS}
    shown |= {"described": OF_FILE, "period": elastic_period(structure)}
    return shown | _storeys_to_begin_with(building), rest


def _storeys_to_begin_with(building: AnyBuilding) -> dict[str, Any]:
    """Where the controls of a regular building begin: near the storeys of another description."""
    count, height = building.storeys, building.storey_height
    if not count or count > MOST_STOREYS:
        return {}
    fits = height is not None and bool(HEIGHTS.contains(height))
    return {"storeys": count, **({"storey_height": height} if fits else {})}


def _noted(table: Mapping[str, Any]) -> dict[str, Any]:
    """What is kept of a building however it is described."""
    noted = {name for name, key in BUILDING.items() if key.noted}
    return {key: value for key, value in table.items() if key in noted or key in OF_DESIGN}
