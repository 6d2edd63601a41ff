"""Modes of a building in a case file: of a file beside it, or one table for each mode."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import xarray as xr

from stochlin.analyses.buildings.modes import read_modes
from stochlin.analyses.cases.files.known import Known
from stochlin.analyses.cases.files.quantities import Quantity
from stochlin.analyses.cases.files.sections import Section
from stochlin.models.buildings import ModalBuilding
from stochlin.models.buildings.base import FLOOR, MODE

MODES = "modes"
OF_READING = ("direction", "points", "tower", "mass_units", "length_units")  # go with a file
OF_TABLES = ("masses", "heights")  # go with tables, since a file has its own
FACTORS = ("participation", "modal_mass")
EXAMPLE = '"tower.csv", or a table [[{name}]] with period and shape for each mode'


def modes_of(section: Section, folder: Path, known: Known) -> xr.Dataset:
    """The modes as `read_modes` returns them; files that are known are not read again."""
    value = section.need(MODES, EXAMPLE.format(name=section.name(MODES)))
    beside = OF_TABLES if isinstance(value, str) else OF_READING
    for key in beside:
        if key in section:
            what = (
                "stands beside a file of modes, which has its own; leave it out"
                if isinstance(value, str)
                else 'belongs to a file of modes, as modes = "tower.csv"; leave it out'
            )
            raise section.error(key, what)
    return _of_file(section, folder, known) if isinstance(value, str) else _of_tables(section)


def _of_file(section: Section, folder: Path, known: Known) -> xr.Dataset:
    options: dict[str, Any] = {
        key: section.texts(key) if key == "points" else section.read(key)
        for key in OF_READING
        if key in section
    }
    path = folder / section.text(MODES)
    with section.naming(MODES, "cannot be read"):
        return known.of(MODES, [section.text(MODES), options], lambda: read_modes(path, **options))


def _of_tables(section: Section) -> xr.Dataset:
    """A table for each mode; masses and heights are keys of the building."""
    if not (modes := section.sections(MODES)):
        raise section.error(MODES, f"is empty; allowed: {EXAMPLE.format(name=section.name(MODES))}")
    floors = {key: section.numbers(key, Quantity.declared(ModalBuilding, key)) for key in OF_TABLES}
    masses, heights = floors.values()
    if len(heights) != len(masses):
        raise section.error(
            "heights",
            f"has {len(heights)} values for {len(masses)} masses; allowed: one for each floor",
        )
    shapes, factors = [], [key for key in FACTORS if key in modes[0]]
    for mode in modes:
        mode.only(*mode.keys)
        shapes.append(mode.numbers("shape", Quantity.declared(ModalBuilding, "shapes")))
        if len(shapes[-1]) != len(masses):
            raise mode.error(
                "shape",
                f"has {len(shapes[-1])} numbers for {len(masses)} masses; allowed: one for each floor",
            )
        if len(factors) == 1 or [key for key in FACTORS if key in mode] != factors:
            what = "belong together; allowed: both in every mode, or in none"
            raise mode.error("", f"{' and '.join(FACTORS)} {what}")
    own = {key: (MODE, [mode.read(key) for mode in modes]) for key in ("period", *factors)}
    return xr.Dataset(
        {
            **own,
            "shape": ((MODE, FLOOR), shapes),
            "mass": (FLOOR, masses),
            "height": (FLOOR, heights),
        }
    )
