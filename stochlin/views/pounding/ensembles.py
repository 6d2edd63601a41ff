"""Pounding in many motions: in words, and as a picture of exceedance frequencies."""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from scipy import constants

from stochlin.analyses.cases.pounding import is_oscillator
from stochlin.analyses.cases.shaking import doubts
from stochlin.analyses.tables.labels import VALUE_AND_ENDS
from stochlin.views.pounding.floors import ALONE as THIN
from stochlin.views.pounding.floors import LINE, NAME, WIDTH, levels_of, looks_of, profile
from stochlin.views.pounding.pictures import caption_of
from stochlin.views.pounding.words import ALONE, JUMPS
from stochlin.views.shared.blocks import Table, Text, ViewSection, texts
from stochlin.views.shared.descriptions import site_in_words
from stochlin.views.shared.screen import cut
from stochlin.views.shared.style import AS_GIVEN, CURVES, describe, legend_above, styled
from stochlin.views.shared.uncertain import at_medians
from stochlin.views.shared.words import (
    MISSING,
    along,
    floors,
    in_g,
    left_out,
    opening,
    per_cent,
    scatter,
    shaking,
    short,
    with_interval,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from stochlin.analyses.cases.reading.case import Case

SHOWN = 0.84  # the quantile of profiles
ERRORS = (
    "Mean: with its standard error. The 95 % intervals of the quantiles are in brackets; over: the "
    "motions are too few for the upper end of the interval."
)
FORCES = "Alone: without pounding. In motions without an impact, forces count as 0."
STOREYS = (
    "Displacements are those of the roof; accelerations are those of the floor with the largest "
    "acceleration in pounding, with and without pounding."
)
STOREYS_ALONE = (
    "Displacements are those of the roof; accelerations are those of the floor with the largest "
    "acceleration."
)
FAILED = (
    "{} of {} motions FAILED and are left out: {}. These are probably strong motions, so the "
    "quantiles are too small."
)
HEAD, PANEL, BETWEEN, AXIS, KEY = 0.35, 2.2, 0.55, 0.62, 0.45  # inches, of the picture
LEFT, RIGHT, APART = 0.09, 0.98, 0.1  # of its width


def ensemble_sections(case: Case, table: xr.Dataset) -> list[ViewSection]:
    """How often buildings meet, and means and quantiles of what that does."""
    over = str(table.status.dims[0])
    simulated, meets = over == "path", "neighbours" in table.dims
    count, good = table.sizes[over], int((table.status == 0).sum())
    strongest = table[["peak_ground_acceleration"]].max()
    peaks = tuple(map(float, table.peak.max({*table.peak.dims} - {"structure"})))
    motions = f"{count} records"
    if simulated:
        length = f"{case.site.course.duration:.4g} s"
        motions = f"{count} simulated motions of {length}, {site_in_words(case)}"
    about = [
        f"{motions}: {_shares(table) if meets else ALONE}",
        _beside_gap(case, count) if simulated and meets else "",
        *((shaking(table, case), scatter(case)) if simulated else (_strengths(table),)),
        at_medians(case),
    ]
    why = next((str(text) for text in table.missing.values if text), "")
    failed = FAILED.format(count - good, count, why) if good < count else ""
    columns = _columns_met(table) if "column_force_quantile" in table else ""
    heads = ["", "mean", *(per_cent(level) for level in table["quantile"].values)]
    rows: list[list[str]] = []
    for of_pair in along(table, "neighbours") if meets else ():
        rows += _gap_rows(of_pair, heads)
    for building in along(table, "structure"):
        rows += _building_rows(building, heads)
    notes = [f"{ERRORS} {FORCES}" if meets else ERRORS]
    notes += [STOREYS if meets else STOREYS_ALONE] * ("floor" in table.dims)
    notes += [JUMPS] * (meets and bool(table.hardest_force_between_mean.isnull().any()))
    return [
        opening(case, doubts(strongest, case.buildings, peaks=peaks)),
        ViewSection("", texts([floors(case), *left_out(case)])),
        ViewSection("", texts(about)),
        *(ViewSection("", texts([text])) for text in (failed, columns)),
        ViewSection("", [Table.of(heads, rows), Text(" ".join(notes))]),
    ]


def _strengths(table: xr.Dataset) -> str:
    """From the weakest record to the strongest."""
    low, high = (in_g(float(end)) for end in table.peak_ground_acceleration.quantile([0.0, 1.0]))
    return f"The shaking: PGA {low} to {high}."


def _shares(table: xr.Dataset) -> str:
    """The share of the motions in which neighbours meet."""
    shares = []
    for of_pair in along(table, "neighbours"):
        share, low, high = map(per_cent, with_interval(of_pair, "pounding_probability"))
        left, right = str(of_pair.neighbours.item()).split(" | ")
        shares.append(f"buildings {left} and {right} hit in {share} of them ({low} to {high})")
    return f"{'; '.join(shares)}."


def _beside_gap(case: Case, count: int) -> str:
    """Whether 'stochlin gap' has the same motions, and so the same share of them with contact."""
    motions = case.simulated.motions
    if len(case.buildings) > 2:
        return ""
    if case.uncertain:
        return (
            "'stochlin gap' takes a sample of the uncertain parameters in each of its "
            f"{motions} motions, so that its share of motions with contact is another."
        )
    if count == motions:
        return "These are the motions of 'stochlin gap': its share of motions with contact is the same."
    return (
        f"The first {min(count, motions)} of them are also the first of the {motions} motions of "
        "'stochlin gap': its share of motions with contact differs by the other motions."
    )


def _columns_met(table: xr.Dataset) -> str:
    most = table.column_force_quantile.isel(quantile=-1)
    contact = table.isel(contact=int(most.fillna(0.0).argmax("contact")))
    struck, level = int(contact[str(contact.column.item())]), float(table["quantile"][-1])
    return (
        f"SLABS FACE COLUMNS: the floors are not level. Hit hardest, {float(contact.level):.4g} m up, "
        f"are the columns of storey {int(contact.storey)} of building {struck}: with at most "
        f"{short(1e-6 * float(contact.column_force_quantile[-1]))} MN in {per_cent(level)} of the "
        "motions."
    )


def _gap_rows(table: xr.Dataset, heads: list[str]) -> list[list[str]]:
    pair = str(table.neighbours.item())
    gap = 100 * float(table.gap.values[table.left.values == int(pair.split(" | ", maxsplit=1)[0])][0])
    kinds = {
        "impacts": ("impacts_between", 1.0),
        "largest force [MN]": ("hardest_force_between", 1e-6),
        "energy lost [kJ]": ("contact_energy_between", 1e-3),
    }
    rows = [_row(f"  {name}", table, stem, scale) for name, (stem, scale) in kinds.items()]
    return [[f"Gap {pair}, {gap:.3g} cm", *[""] * (len(heads) - 1)], *rows]


def _building_rows(table: xr.Dataset, heads: list[str]) -> list[list[str]]:
    top = shaken = table
    at_floor, meets = "", "neighbours" in table.dims
    if "floor" in table.dims:
        top = table.sel(floor=int(table.storeys))
        times = table.peak_acceleration_mean / (table.peak_acceleration_alone_mean if meets else 1.0)
        shaken = table.isel(floor=int(times.argmax("floor")))
        at_floor = "" if is_oscillator(table) else f", floor {int(shaken.floor)}"
    rows = []
    for name, place, stem, scale in (
        ("displacement [cm]", top, "peak", 100.0),
        (f"acceleration [g]{at_floor}", shaken, "peak_acceleration", 1 / constants.g),
        ("base shear [MN]", table, "peak_base_shear", 1e-6),
    ):
        rows.append(_row(f"  {name}", place, stem, scale))
        rows += [_row("    alone", place, f"{stem}_alone", scale)] * meets
    named = f"{int(table.structure)}  {cut(str(table.building.item()), NAME)}"
    return [[named, *[""] * (len(heads) - 1)], *rows]


def _row(name: str, table: xr.Dataset, stem: str, scale: float) -> list[str]:
    """Mean with its error, and quantiles with their intervals."""
    mean, error = (scale * float(table[f"{stem}_mean{end}"]) for end in ("", "_standard_error"))
    cells = [MISSING if np.isnan(mean) else f"{_digits(mean)} +- {error:.2g}"]
    ends = (scale * table[f"{stem}_quantile{end}"].values for end in VALUE_AND_ENDS)
    for value, low, high in zip(*ends, strict=True):
        between = f"{_digits(low)}-{_digits(high)}" if np.isfinite(high) else f"over {_digits(low)}"
        cells.append(MISSING if np.isnan(value) else f"{_digits(value)} ({between})")
    return [name, *cells]


def _digits(value: float) -> str:
    """Three digits, below one two: the intervals are wider."""
    return short(value) if value >= 1 else f"{value:.2g}"


@styled(AS_GIVEN)
def draw_ensemble(dataset: xr.Dataset) -> Figure:
    """Draw pounding in many motions, as ``stochlin pound --motions`` computes it.

    Parameters
    ----------
    dataset : xarray.Dataset
        As `stochlin.charts.pound_motions` makes it, from memory or from file.

    Returns
    -------
    matplotlib.figure.Figure
        The share of the motions with more impacts, and with a larger force, across each gap, if there is
        one; and the accelerations and displacements with pounding and without: of oscillators how often
        they are exceeded, of buildings with storeys a quantile over height.

    Raises
    ------
    ValueError
        If the dataset is another one.
    """
    from matplotlib.figure import Figure

    if "peak_quantile" not in dataset or "building" not in dataset.coords:
        raise ValueError(
            f"dataset has the dimensions {tuple(dataset.dims)}; allowed: one that 'stochlin pound' "
            "saves of many motions"
        )
    caption = caption_of(dataset)
    foot = AXIS + LINE * (caption.count("\n") + 1)
    lows = [foot + PANEL + KEY + BETWEEN, foot] if "neighbours" in dataset.dims else [foot]
    height = HEAD + KEY + PANEL + lows[0]
    figure = Figure(figsize=(WIDTH, height))
    wide = (RIGHT - LEFT - APART) / 2
    panels = [
        figure.add_axes((LEFT + n * (wide + APART), low / height, wide, PANEL / height))
        for low in lows
        for n in range(2)
    ]
    if "neighbours" in dataset.dims:
        _gaps(panels[0], panels[1], dataset)
    storeys = "floor" in dataset.dims
    for axes, stem, scale, name in (
        (panels[-2], "peak_acceleration", 1 / constants.g, "acceleration [g]"),
        (panels[-1], "peak", 100.0, "displacement [cm]"),
    ):
        (_over_height if storeys else _exceeded)(axes, dataset, stem, scale)
        label = f"{name}, not exceeded in {100 * _level(dataset):.3g} %" if storeys else name
        axes.set(xlim=(0, None), xlabel=label)
    panels[-2].set_ylabel("height [m]" if storeys else "share of motions with more")
    for axes, ncols in ((panels[0], 4), (panels[-2], 3)):
        legend_above(axes, ncols, 8)
    describe(figure, LEFT, foot - AXIS, dataset.attrs["title"], caption)
    return figure


def _gaps(left: Axes, right: Axes, dataset: xr.Dataset) -> None:
    """The number of impacts and their forces across each gap."""
    forces = bool(dataset.hardest_force_between_mean.notnull().all())
    for (color, dash), number in zip(cycle(CURVES), range(dataset.sizes["neighbours"]), strict=False):
        table = dataset.isel(neighbours=number)
        style: Any = {"color": color, "linestyle": dash, "lw": 1.4}
        label = f"gap {table.neighbours.item()}"
        _exceedance(left, table.impacts_between.values, style | {"label": label})
        if forces:
            none_is_zero = table.hardest_force_between.where(table.impacts_between > 0, 0.0)
            force = none_is_zero.where(table.status == 0).values
            _exceedance(right, 1e-6 * force, style)
    if not forces:
        right.text(0.5, 0.5, "no forces: velocities jump", transform=right.transAxes, ha="center")
    left.set(xlabel="impacts", ylabel="share of motions with more", xlim=(0, None), ylim=(0, 1.02))
    right.set(xlabel="largest force [MN]", xlim=(0, None), ylim=(0, 1.02))


def _exceeded(axes: Axes, dataset: xr.Dataset, stem: str, scale: float) -> None:
    meets = "neighbours" in dataset.dims
    for number, (name, look) in enumerate(looks_of(dataset)):
        table = dataset.isel(structure=number)
        style: Any = {"color": look["color"], "linestyle": look["linestyle"]}
        _exceedance(axes, scale * table[stem].values, style | {"lw": 1.6, "label": name})
        if meets:
            _exceedance(axes, scale * table[f"{stem}_alone"].values, style | {"lw": 0.6})
    if meets:
        axes.plot([], [], color="0.35", lw=0.6, label="thin: alone")
    axes.set_ylim(0, 1.02)


def _exceedance(axes: Axes, samples: np.ndarray, style: dict[str, Any]) -> None:
    """The share of the motions above each value; those that failed do not count."""
    ordered = np.sort(samples[np.isfinite(samples)])
    share = 1 - np.arange(ordered.size + 1) / ordered.size
    axes.step(np.append(0.0, ordered), share, where="post", **style)


def _over_height(axes: Axes, dataset: xr.Dataset, stem: str, scale: float) -> None:
    meets = "neighbours" in dataset.dims
    at = dataset.sel(quantile=_level(dataset))
    for number, (name, style) in enumerate(looks_of(dataset)):
        table, levels = at.isel(structure=number), levels_of(dataset, number)
        with_hits, alone = (
            scale * table[f"{stem}{end}_quantile"].values[: levels.size] for end in ("", "_alone")
        )
        profile(axes, levels, with_hits, alone if meets else None, name, style)
    if meets:
        axes.plot([], [], label="open, thin: alone", **THIN)
    axes.set_ylim(0, None)


def _level(dataset: xr.Dataset) -> float:
    levels = dataset["quantile"].values
    return float(levels[np.abs(levels - SHOWN).argmin()])
