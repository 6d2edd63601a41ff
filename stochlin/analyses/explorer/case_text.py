"""The text of a case file from a scene: what `read_case` reads."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from stochlin.analyses.cases.site import PARALLEL
from stochlin.analyses.explorer.buildings import REGULAR
from stochlin.analyses.explorer.scene import Scene
from stochlin.analyses.explorer.sites import EUROCODE_8
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


def case_text(scene: Scene) -> str:
    """Text of the case file that describes a scene, every number to its last digit.

    Examples
    --------
    >>> from stochlin.analyses.explorer.scene import Scene
    >>> case_text(Scene(site="soft")).splitlines()[5:7]
    ['ground = "soft"', 'intensity = "0.01 m^2/s^3"']
    """
    site = GROUNDS.get(scene.site, GROUNDS["white_noise"])  # any other has its intensity alone
    lines = [f"title = {_written(scene.title)}", "", "[site]"]
    ground = scene.ground()
    if scene.shape is not None:
        lines += [f"spectrum = {_written(scene.site)}", *_of_code(scene)]
    else:
        values = scene.site_parameters() | {"intensity": ground.arrays()["intensity"].item()}
        lines += [f"ground = {_written(scene.site)}", *_numbers(site, values)]
    if scene.site == PARALLEL and isinstance(ground, ParallelGround):
        for part in ground.grounds:
            kind = next(name for name, one in GROUNDS.items() if type(part) is one)
            lines += ["", "[[site.grounds]]", f"ground = {_written(kind)}"]
            lines += _numbers(type(part), _given(part, part.parameter_names()))
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
    lines += [f"floors_align = {_written(scene.for_codes()['floors_align'])}"]
    lines += [f"zone = {_written(scene.zone)}"] if scene.zone else []
    lines += [f"unverified = {_written(scene.unverified)}"]
    lines += ["", "[simulation]", f"paths = {scene.paths}", f"seed = {scene.seed}", ""]
    return HEAD + "\n".join(lines)


def _of_code(scene: Scene) -> list[str]:
    """What says the spectrum of a code, and of how many filters its ground is."""
    ground = scene.ground()
    filters = f"filters = {len(ground.grounds) if isinstance(ground, ParallelGround) else 1}"
    if scene.site == EUROCODE_8:
        return [
            f"ag = {_quantity(scene.ag, 'm/s^2')}",
            f"soil = {_written(scene.soil)}",
            f"type = {scene.spectrum_type}",
            filters,
        ]
    values = ((name, Scene.units(name)) for name in ("sds", "sd1", "tl"))
    return [*(f"{name} = {_quantity(getattr(scene, name), units)}" for name, units in values), filters]


def _building(scene: Scene, number: int) -> list[str]:
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
    names = ("period", "damping", "hardening", "reduction_factor")
    lines = _numbers(Bilinear, _given(scene.structure(number), names))
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
    """Those parameters that are set."""
    return {name: value for name in names if (value := getattr(structure, name)) is not None}


def _numbers(kind: type[Model], values: dict[str, Any]) -> list[str]:
    """Lines of a model's parameters, with the units that it declares."""
    return [f"{name} = {_quantity(value, kind.units(name))}" for name, value in values.items()]


def _quantity(value: Any, unit: str = "1") -> str:
    """A number, or a list of them, with a unit if it has one."""
    if np.ndim(value):
        return f"[{', '.join(_quantity(one, unit) for one in np.asarray(value).tolist())}]"
    return f"{value!r}" if unit == "1" else f'"{value!r} {unit}"'


def _written(value: str | bool) -> str:
    """As TOML has it; texts and truth values are those of JSON."""
    return json.dumps(value, ensure_ascii=False)
