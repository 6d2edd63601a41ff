"""The text of a case file from a scene: what `read_case` reads."""

from __future__ import annotations

import json

from stochlin.analyses.explorer.scene import Scene
from stochlin.models.envelopes import ENVELOPES
from stochlin.models.grounds import GROUNDS
from stochlin.models.parameters import Model

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
    site = GROUNDS.get(scene.site, GROUNDS["white_noise"])  # a named ground has its intensity alone
    lines = [f"title = {_written(scene.title)}", "", "[site]", f"ground = {_written(scene.site)}"]
    lines += _numbers(site, scene.site_parameters())
    lines += [
        "",
        "[motion]",
        f'duration = "{scene.duration!r} s"',
        f"envelope = {_written(scene.envelope)}",
    ]
    if scene.envelope in ENVELOPES:
        lines += _numbers(ENVELOPES[scene.envelope], scene.envelope_parameters())
    for number in (1, 2):
        lines += ["", *_building(scene, number)]
    lines += ["", "[separation]", f"confidence = {scene.confidence!r}", f'existing = "{scene.gap!r} m"']
    lines += [f"floors_align = {_written(scene.floors_align)}"]
    lines += [f"zone = {_written(scene.zone)}"] if scene.zone else []
    lines += [f"unverified = {_written(scene.unverified)}"]
    lines += ["", "[simulation]", f"paths = {scene.paths}", f"seed = {scene.seed}", ""]
    return HEAD + "\n".join(lines)


def _building(scene: Scene, number: int) -> list[str]:
    structure = scene.structure(number)
    names = ("period", "damping", "hardening", "reduction_factor")
    values = {name: getattr(structure, name) for name in names}
    lines = [f"[building_{number}]", f"name = {_written(scene.names[number - 1])}"]
    lines += _numbers(type(structure), {k: v for k, v in values.items() if v is not None})
    lines += [] if structure.yields else ["elastic = true"]
    height, storeys = scene.heights[number - 1], scene.storeys[number - 1]
    lines += [f'height = "{height!r} m"'] if height is not None else []
    return lines + ([f"storeys = {storeys}"] if storeys is not None else [])


def _numbers(kind: type[Model], values: dict[str, float]) -> list[str]:
    """Lines of a model's parameters, with the units that it declares."""
    return [
        f"{name} = {value!r}" if kind.units(name) == "1" else f'{name} = "{value!r} {kind.units(name)}"'
        for name, value in values.items()
    ]


def _written(value: str | bool) -> str:
    """As TOML has it; texts and truth values are those of JSON."""
    return json.dumps(value, ensure_ascii=False)
