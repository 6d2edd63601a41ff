"""A building as it was read, in plain words and short numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from stochlin.models.buildings.base import GRAVITY
from stochlin.views.shared.blocks import Items, TableBlock, TextBlock, ViewSection
from stochlin.views.shared.words import NBSP, TURNS_IN_PLAN, along, counted, length, per_cent

if TYPE_CHECKING:
    from collections.abc import Iterator

    import xarray as xr

    from stochlin.models.buildings.modal import ModalBuilding

MOST_COLUMNS = 6  # modes whose shapes are printed


def building_sections(
    table: xr.Dataset, building: ModalBuilding, ideal: xr.Dataset | None = None
) -> list[ViewSection]:
    """The sections of ``stochlin building``; ``ideal`` is the idealized pushover curve."""
    height = float(table["level"][-1])
    mass = float(table["mass"].sum()) / 1000
    modes = counted(table.sizes["mode"], "mode")
    floors = counted(table.sizes["floor"], "floor")
    along_axis = f" along {table.attrs['direction']}" if "direction" in table.attrs else ""
    head = (
        f"{table.attrs['source']}: {modes}{along_axis} of {floors}, {height:.4g}{NBSP}m high, "
        f"{mass:.5g}{NBSP}t."
    )
    whole = per_cent(float(table["mass_share"].sum()), 1)
    moves = "Floors, with their displacements over that of each mode's oscillator"
    taken = [*_assumed(table, building), *_strength(table, building, ideal)]
    return [
        ViewSection("", [TextBlock(head)]),
        ViewSection(
            "Modes", [_modes(table), TextBlock(f"Effective modal masses together: {whole}.")]
        ),
        ViewSection(moves, [_floors(table)]),
        ViewSection("Taken and assumed", [Items(taken)]),
    ]


def _modes(table: xr.Dataset) -> TableBlock:
    so_far = np.cumsum(table["mass_share"].values)
    rows = [
        [
            str(mode["mode"].item()),
            f"{float(mode['period']):.4g}",
            f"{100 * float(mode['mass_share']):.1f}",
            f"{100 * together:.1f}",
            f"{float(mode['floor_move'][-1]):.3f}",
        ]
        for mode, together in zip(along(table, "mode"), so_far, strict=True)
    ]
    return TableBlock.of(["mode", "period [s]", "mass [%]", "up to it [%]", "roof"], rows)


def _floors(table: xr.Dataset) -> TableBlock:
    """From the roof down, as buildings are drawn."""
    shown = table.isel(mode=slice(MOST_COLUMNS))
    rows = [
        [
            str(floor["floor"].item()),
            f"{float(floor['level']):.4g}",
            f"{float(floor['height']):.4g}",
            f"{float(floor['mass']) / 1000:.5g}",
            *(f"{move:.3f}" for move in floor["floor_move"].values),
        ]
        for floor in along(shown.isel(floor=slice(None, None, -1)), "floor")
    ]
    heads = ["floor", "level [m]", "storey [m]", "mass [t]"]
    return TableBlock.of([*heads, *(f"mode {mode}" for mode in shown["mode"].values)], rows)


def _assumed(table: xr.Dataset, building: ModalBuilding) -> Iterator[str]:
    """What the numbers are from, and what is not in the file."""
    if building.modal_masses is None:
        yield "Participation factors and modal masses are computed from shapes and floor masses."
    else:
        yield (
            "Participation factors and modal masses are those of the file: the building turns, or "
            "other masses move, too. Storey shears above the first storey are not known."
        )
    if "left_out" in table.attrs:
        left_out = table.attrs["left_out"]
        yield f"Left out, with less than 0.1{NBSP}% of the mass along the gap: mode {left_out}."
    if table.sizes["mode"] > MOST_COLUMNS:
        yield f"Shapes are shown of the first {MOST_COLUMNS} modes; --out saves all."
    if "turning" in table.attrs:
        yield TURNS_IN_PLAN.format(building=table.attrs["source"])
    if "below_ground" in table.attrs:
        count = counted(table.attrs["below_ground"], "floor")
        yield (
            f"Left out: {count} at or below the ground, with whose mass the lowest floor is shown."
        )
    yield "Only the motion along the gap is described; that across it is neglected."


def _strength(
    table: xr.Dataset, building: ModalBuilding, ideal: xr.Dataset | None
) -> Iterator[str]:
    """The strength of the first mode by a pushover curve, if there is one."""
    if ideal is None:
        yield "Strength: none, so that the building stays elastic. --pushover gives it."
        return
    first = building.oscillator()
    force = float(ideal["yield_force"])
    share = force / (GRAVITY * float(table["mass"].sum()))
    yield (
        f"Strength of mode 1 by the pushover curve {ideal['base_shear'].attrs['source']}, "
        f"idealized by ASCE 41: yield at {force / 1e3:.5g}{NBSP}kN, "
        f"{per_cent(share, 1)} of the weight, and {length(float(ideal['yield_displacement']))} of "
        f"the roof; hardening ratio {float(ideal['hardening']):.3g}. The other modes stay elastic."
    )
    yield (
        f"Mode 1 with the curve: period {building.mode_periods()[0].item():.4g}{NBSP}s up to "
        "yield, yield displacement of its oscillator "
        f"{length(first.arrays()['yield_displacement'].item())}."
    )
