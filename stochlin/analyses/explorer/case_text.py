"""Text of a case file from a scene, for `read_case`."""

from __future__ import annotations

import json
import re
import tomllib
import warnings
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from stochlin.analyses.cases.buildings import building_keys, read_buildings
from stochlin.analyses.cases.contacts import read_measures
from stochlin.analyses.cases.files.sections import Section
from stochlin.analyses.cases.site import PARALLEL
from stochlin.analyses.cases.sites.records import SCALE_TO, SUITE
from stochlin.analyses.cases.sites.strength import HAZARD
from stochlin.analyses.explorer.buildings import REGULAR
from stochlin.analyses.explorer.scene import STRENGTHS, Scene
from stochlin.analyses.explorer.sites import EUROCODE_8, OF_FILE, PGA, S0, G
from stochlin.analyses.sites.spectra import USUAL_DAMPING
from stochlin.messages import DoubtfulInput
from stochlin.models.buildings import RegularBuilding, ShearBuilding
from stochlin.models.envelopes import ENVELOPES
from stochlin.models.grounds import GROUNDS, Ground, ParallelGround
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.parameters import Model
from stochlin.models.structures import Structure
from stochlin.models.systems import AnyStructure

HEAD = """\
# A case for 'stochlin gap', saved by 'stochlin explore'. Lengths in m, times in s; 'stochlin gap
# --example' explains every line.
"""
SPECTRUM_FILE = ("spectrum", "units", "damping", "column", "period_column")
PARTS = ("contact", "measures", "mitigation")  # tables of a file without controls in the explorer
BARE = re.compile(r"[A-Za-z0-9_-]+")


def case_text(scene: Scene) -> str:
    """Text of the case file of a scene, with all digits of its numbers.

    Parts of the original case file without controls are copied, except those of `left_out`.

    Examples
    --------
    >>> from stochlin.analyses.explorer.scene import Scene
    >>> case_text(Scene(site="soft")).splitlines()[5:7]
    ['ground = "soft"', 'intensity = "0.01 m^2/s^3"']
    """
    site = GROUNDS.get(
        scene.site, GROUNDS["white_noise"]
    )  # a named ground has the parameter intensity only
    lines = [f"title = {_written(scene.title)}", "", "[site]"]
    ground = scene.ground()
    if scene.shape is not None:
        lines += _of_spectrum(scene)
    else:
        values = scene.site_parameters() | {"intensity": ground.arrays()["intensity"].item()}
        lines += [f"ground = {_written(scene.site)}", *_numbers(site, values), *_remark(scene)]
    if scene.site == PARALLEL and isinstance(ground, ParallelGround):
        for part in ground.grounds:
            kind = next(name for name, ground_class in GROUNDS.items() if type(part) is ground_class)
            lines += ["", "[[site.grounds]]", f"ground = {_written(kind)}"]
            lines += _numbers(type(part), _given(part, part.parameter_names()))
    lines += _of_site(scene)
    lines += [
        "",
        "[motion]",
        f'duration = "{scene.duration!r} s"',
        f"scatter = {scene.scatter!r}",
        f"envelope = {_written(scene.envelope)}",
    ]
    if scene.envelope in ENVELOPES:
        lines += _numbers(ENVELOPES[scene.envelope], scene.envelope_parameters())
    for number in (1, 2):
        lines += ["", *_building(scene, number)]
    lines += ["", "[separation]", f"confidence = {scene.confidence!r}", f'existing = "{scene.gap!r} m"']
    lines += [f"{name} = {_written(value)}" for name, value in vars(scene.neighbours).items()]
    lines += [f"zone = {_written(scene.zone)}"] if scene.zone else []
    lines += [f"unverified = {_written(scene.unverified)}"]
    lines += _pairs(_said(scene, "separation"), ("risk", "numbers"))
    lines += ["", "[simulation]", f"paths = {scene.paths}", f"seed = {scene.seed}"]
    for table in PARTS:
        if table != "measures" or not _unfit(scene):
            lines += _table(table, _said(scene, table))
    return HEAD + "\n".join([*lines, ""])


def left_out(scene: Scene) -> list[str]:
    """Remarks on parts of the original case file that do not fit the values of the scene any more."""
    remarks = []
    if unfit := _unfit(scene):
        remarks.append(f"The measures of the file are left out; they do not fit the buildings: {unfit}.")
    if _scaled_to_nothing(scene):
        remarks.append(
            "The suite of records is left out; it is scaled to a spectrum, which the site lacks."
        )
    return remarks


def files_named(scene: Scene) -> list[str]:
    """Names of the files to which the case file of a scene refers, relative to the original one."""
    site = _said(scene, "site")
    names = [record["path"] for record in site.get("records", [])]
    if scene.site == OF_FILE:
        names.append(site["spectrum"])
    if SUITE in site and not _scaled_to_nothing(scene):
        names.append(site[SUITE]["path"])
    if "file" in site.get(HAZARD, {}):
        names.append(site[HAZARD]["file"])
    return names


def _said(scene: Scene, *place: str) -> Mapping[str, Any]:
    """A table of the original case file of a scene; empty if there is none."""
    values: Mapping[str, Any] = scene.case_file.values if scene.case_file else {}
    for key in place:
        values = values.get(key, {})
    return values


def _scaled_to_nothing(scene: Scene) -> bool:
    """Whether the suite of records is scaled to a spectrum, although the site has none."""
    return scene.shape is None and SCALE_TO in _said(scene, "site", SUITE)


def _unfit(scene: Scene) -> str:
    """Reason why the measures of the file do not fit the buildings of the scene; empty if they do."""
    if scene.case_file is None:
        return ""
    text = "\n".join(line for number in (1, 2) for line in _building(scene, number))
    values = tomllib.loads(text) | {"measures": _said(scene, "measures")}
    whole = Section(scene.case_file.file.name, (), values, {})
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DoubtfulInput)  # the warning was shown when the file was read
        try:
            read_measures(whole, read_buildings(whole, building_keys(whole, "measures")))
        except ValueError as error:
            return str(error)
    return ""


def _of_site(scene: Scene) -> list[str]:
    """Lines of the records and the hazard of the original case file."""
    said, lines = _said(scene, "site"), []
    for record in said.get("records", []):
        lines += ["", "[[site.records]]", *_pairs(record)]
    if not _scaled_to_nothing(scene):
        lines += _table(f"site.{SUITE}", said.get(SUITE, {}))
    return lines + _table(f"site.{HAZARD}", said.get(HAZARD, {}))


def _remark(scene: Scene) -> list[str]:
    """Comment line with the mean acceleration that the intensity was found for."""
    if scene.measure == S0:
        return []
    at = "" if scene.measure == PGA else f" at {scene.sa_period:.4g} s"
    return [f"# so that the mean {scene.measure} of the motions is {scene.strength / G:.4g} g{at}"]


def _of_spectrum(scene: Scene) -> list[str]:
    """Lines of the design spectrum, with the number of filters of its ground."""
    ground = scene.ground()
    filters = f"filters = {len(ground.grounds) if isinstance(ground, ParallelGround) else 1}"
    if scene.site == OF_FILE:
        kept = _pairs(_said(scene, "site"), SPECTRUM_FILE)
        return [*kept, f"scale = {scene.spectrum_scale!r}", filters]
    named = f"spectrum = {_written(scene.site)}"
    if scene.site == EUROCODE_8:
        usual = scene.spectrum_damping == USUAL_DAMPING
        return [
            named,
            f"ag = {_quantity(scene.ag, 'm/s^2')}",
            f"soil = {_written(scene.soil)}",
            f"type = {scene.spectrum_type}",
            *([] if usual else [f"damping = {scene.spectrum_damping!r}"]),
            filters,
        ]
    values = ((name, Scene.units(name)) for name in ("sds", "sd1", "tl"))
    lines = (f"{name} = {_quantity(getattr(scene, name), units)}" for name, units in values)
    return [named, *lines, filters]


def _building(scene: Scene, number: int) -> list[str]:
    """Lines of building 1 or 2."""
    structure = scene.structure(number)
    lines = [f"[building_{number}]", f"name = {_written(scene.names[number - 1])}"]
    if isinstance(structure, Structure):
        lines += _oscillator(scene, number)
    elif getattr(scene, f"description_{number}") == REGULAR:
        lines += _regular(scene, number, structure)
    else:
        lines += _numbers(ShearBuilding, _given(structure, ShearBuilding.parameter_names()))
        lines += [f"law = {_written(str(structure.law))}", f"p_delta = {_written(structure.p_delta)}"]
        own: Mapping[str, Any] = structure.law_parameters or {}
        lines += [f"{name} = {_quantity(value)}" for name, value in own.items()]
    return lines + ([] if structure.yields else ["elastic = true"])


def _oscillator(scene: Scene, number: int) -> list[str]:
    names = ("period", "damping", "hardening", *STRENGTHS.values())
    lines = _numbers(Bilinear, _given(scene.structure(number), names))
    lines += _pairs(_said(scene, f"building_{number}"), ("mass",))
    height, storeys = scene.heights[number - 1], scene.storeys[number - 1]
    lines += [f'height = "{height!r} m"'] if height is not None else []
    return lines + ([f"storeys = {storeys}"] if storeys is not None else [])


def _regular(scene: Scene, number: int, structure: ShearBuilding) -> list[str]:
    names = ["period", "storey_height", *(["base_shear_coefficient"] if structure.yields else [])]
    few = {name: getattr(scene, f"{name}_{number}") for name in names}
    lines = [f"storeys = {structure.storeys}", *_numbers(RegularBuilding, few)]
    lines += [f'floor_mass = "{scene.floor_masses[number - 1]!r} kg"']
    return lines + _numbers(ShearBuilding, _given(structure, ("damping", "hardening")))


def _given(structure: AnyStructure | Ground, names: Iterable[str]) -> dict[str, Any]:
    """Parameters that are not None, by name."""
    return {name: value for name in names if (value := getattr(structure, name)) is not None}


def _numbers(kind: type[Model], values: dict[str, Any]) -> list[str]:
    """Lines of the parameters of a model, with their units."""
    return [f"{name} = {_quantity(value, kind.units(name))}" for name, value in values.items()]


def _quantity(value: Any, unit: str = "1") -> str:
    """Text of a number or a list of numbers, with the unit unless it is 1."""
    if np.ndim(value):
        return f"[{', '.join(_quantity(number, unit) for number in np.asarray(value).tolist())}]"
    return f"{value!r}" if unit == "1" else f'"{value!r} {unit}"'


def _table(name: str, values: Mapping[str, Any]) -> list[str]:
    """Lines of a table of the original case file; none for an empty table."""
    inner = {key: value for key, value in values.items() if isinstance(value, dict)}
    if inner and len(inner) == len(values):  # a table of tables, such as that of the measures
        return [line for key, value in inner.items() for line in _table(f"{name}.{_key(key)}", value)]
    return ["", f"[{name}]", *_pairs(values)] if values else []


def _pairs(values: Mapping[str, Any], names: Iterable[str] | None = None) -> list[str]:
    """Lines of the entries of a table, all or those with the given names."""
    chosen = values if names is None else [name for name in names if name in values]
    return [f"{_key(name)} = {_written(values[name])}" for name in chosen]


def _key(name: str) -> str:
    return name if BARE.fullmatch(name) else _written(name)


def _written(value: Any) -> str:
    """Text of a value in TOML; texts and truth values are written as in JSON."""
    if isinstance(value, dict):
        return f"{{ {', '.join(_pairs(value))} }}"
    if isinstance(value, list):
        return f"[{', '.join(map(_written, value))}]"
    return json.dumps(value, ensure_ascii=False) if isinstance(value, (str, bool)) else repr(value)
