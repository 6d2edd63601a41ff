"""What is seen first of a gap: the drawing on the page, its positions to scale, the four lines."""

from __future__ import annotations

import dataclasses
import re
import warnings
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
from cases import BLOCK, KIOSK, example_case, with_buildings, with_slow
from matplotlib.axes import Axes
from matplotlib.text import Text

import stochlin as sl
from stochlin.applications.cases.separation import CaseAnswer, answer_case
from stochlin.views.separation.pictures import elevation_figure
from stochlin.views.separation.report import answer_sections
from stochlin.views.separation.words import allowances, cautions, first_lines, of_earthquakes
from stochlin.views.shared.blocks import TableBlock
from stochlin.views.shared.screen import lines

pytestmark = pytest.mark.cli

CM = 100.0  # a metre
EXAMPLE = example_case().replace("2048", "128").partition("[contact]")[0]
NONE_YET = EXAMPLE.replace('existing = "5 cm"', "")
NO_HEIGHTS = NONE_YET.replace('height = "24 m"', "").replace('height = "15 m"', "")
LEFT = BLOCK.format(n=1, period=0.5, storeys=3, height=3.2)
RIGHT = BLOCK.format(n=2, period=0.3, storeys=2, height=3.5)


def of(*buildings: str) -> str:
    """These buildings with few motions, and without an existing gap."""
    text = with_buildings(*buildings).replace("2048", "128").partition("[contact]")[0]
    return text.replace('existing = "5 cm"', "").replace(
        "floors_align = true", "floors_align = false"
    )


def with_codes(text: str) -> str:
    """Codes that take heights and no displacements."""
    start, head, rest = text.partition("[separation]\n")
    return f'{start}{head}codes = ["asce_41", "china_gb_50011"]\n{rest}'


CASES = {
    "oscillators": EXAMPLE,
    "enough": EXAMPLE.replace('"5 cm"', '"90 cm"'),
    "no gap yet": NONE_YET,
    "no heights": NO_HEIGHTS,
    "storeys": of(LEFT, RIGHT),
    "mixed": of(LEFT, KIOSK.format(n=2)),
    "set-back": of(LEFT),
    "set-back of an oscillator": of(KIOSK.format(n=1)).replace(
        'confidence = "90 %"', 'confidence = "90 %"\nexisting = "2 cm"'
    ),
    "alike": NONE_YET.replace('"0.6 s"', '"1.0 s"'),
    "too few motions": NONE_YET.replace('"90 %"', '"99.5 %"'),
    "codes": with_codes(NONE_YET),
    "codes without heights": with_codes(NO_HEIGHTS),
}


@pytest.fixture(scope="module")
def answer(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], CaseAnswer]:
    """The answer to a case of these names, computed once."""
    folder = tmp_path_factory.mktemp("cases")

    @cache
    def answered_case(name: str) -> CaseAnswer:
        path = folder / f"{name}.toml"
        path.write_text(CASES[name], encoding="utf-8")
        with warnings.catch_warnings():
            if name == "alike":  # which is asked about
                warnings.simplefilter("ignore", sl.DoubtfulInput)
            return answer_case(sl.read_case(path))

    return answered_case


def drawn(answer: CaseAnswer) -> tuple[Axes, Axes, Axes]:
    """The shares, the gaps and the buildings, in the same place across."""
    figure = elevation_figure(answer)
    figure.draw_without_rendering()
    buildings, gaps, shares = figure.axes
    assert gaps.get_xlim() == buildings.get_xlim()
    for text in figure.findobj(Text):
        if text.get_text() and text.get_visible():
            box = text.get_window_extent()
            assert -1 < box.x0 < box.x1 < figure.bbox.width + 1, text.get_text()
            assert -1 < box.y0 < box.y1 < figure.bbox.height + 1, text.get_text()
    return shares, gaps, buildings


def dimension_lines(gaps: Axes) -> list[tuple[float, float]]:
    """Row and length [cm] of each dimension line."""
    found = [line for line in gaps.get_lines() if line.get_marker() == "|"]
    return [(float(line.get_ydata()[0]), float(line.get_xdata()[1])) for line in found]


def displaced(buildings: Axes) -> list[np.ndarray]:
    """Displacements [cm] and levels [m] of each building."""
    found = [line for line in buildings.get_lines() if line.get_marker() in ("o", "s")]
    return [np.array(line.get_data()) for line in found]


def walls(buildings: Axes) -> list[tuple[float, float]]:
    """Place across [cm] and height [m] of the face of each building."""
    polygons = [patch.get_xy() for patch in buildings.patches]
    return [(float(xy[1][0]), float(xy[2][1])) for xy in polygons]


@pytest.mark.parametrize("name", with_slow(CASES, {"no gap yet", "codes", "codes without heights"}))
def test_every_kind_of_case_stands_to_scale(name: str, answer: Any) -> None:
    one = answer(name)
    table = one.separation
    shares, gaps, buildings = drawn(one)
    apart = CM * (table.gap[0].item() if one.existing is None else one.existing.attrs["gap_m"])
    wanted = [
        (face, b.height or 10.0) for face, b in zip((0, apart), one.case.buildings, strict=False)
    ]
    np.testing.assert_allclose(walls(buildings), wanted, rtol=1e-12, atol=1e-12)
    row = 0 if one.existing is None else 1
    assert (row, CM * table.gap[0].item()) in dimension_lines(gaps)
    if one.existing is not None:
        assert dimension_lines(gaps)[0] == (0, apart)
    (band,) = (line for line in gaps.get_lines() if line.get_linewidth() == 7)
    assert band.get_xdata()[0] == CM * table.gap_lower[0].item()
    if np.isfinite(table.gap_upper[0]):
        assert band.get_xdata()[1] == CM * table.gap_upper[0].item()
    of_gap = table.isel(rule=0) if one.existing is None else one.existing
    bars = [(bar.get_x(), bar.get_width()) for bar in shares.patches]
    share = 100 * of_gap.no_pounding_probability.item()
    np.testing.assert_allclose(bars, [(0, share), (share, 100 - share)])
    for n, (moved, levels) in enumerate(displaced(buildings)):
        towards = moved if n == 0 else apart - moved
        if "height" in table.dims:
            np.testing.assert_allclose(levels[1:], table.height)
            np.testing.assert_allclose(towards[1:], CM * table[f"peak_at_height_{n + 1}"])
        else:
            assert levels[1] == min(height for _, height in wanted)
            assert towards[1] == pytest.approx(CM * table[f"peak_{n + 1}"].item())
        assert moved[0] == wanted[n][0]


def test_slabs_on_columns_are_marked_and_a_line_stands_where_one_building_ends(answer: Any) -> None:
    one = answer("storeys")
    *_, buildings = drawn(one)
    floors = [
        [segment[0][1] for segment in lines.get_segments()] for lines in buildings.collections
    ]
    np.testing.assert_allclose(floors[0], [3.2, 6.4, 9.6])
    apart = CM * one.separation.gap[0].item()
    marks = {
        (float(line.get_xdata()[0]), float(line.get_ydata()[0]))
        for line in buildings.get_lines()
        if line.get_marker() == "x"
    }
    assert marks == {(0.0, 3.5), (0.0, 7.0), (apart, 3.2), (apart, 6.4)}
    *_, buildings = drawn(answer("set-back of an oscillator"))
    (line,) = (line for line in buildings.get_lines() if list(line.get_xdata()) == [2.0, 2.0])
    assert list(line.get_ydata()) == [0, 4.0]


def test_codes_of_the_file_have_a_line_or_words_why_not(answer: Any) -> None:
    _, gaps, _ = drawn(answer("codes"))
    assert {"at least the answer", "less than the answer"} <= {
        text.get_text() for text in gaps.texts
    }
    one = answer("codes without heights")
    _, gaps, _ = drawn(one)
    assert [row for row, _ in dimension_lines(gaps)] == [0, 2]  # that of China without heights
    assert [text.get_text() for text in gaps.texts].count("not available") == 1
    unknown = one.separation.assign(gap=one.separation.gap * np.nan)
    _, gaps, buildings = drawn(dataclasses.replace(one, separation=unknown))
    assert not dimension_lines(gaps)
    assert walls(buildings)[1][0] == 0


def test_of_buildings_that_fall_no_gap_is_enough(answer: Any) -> None:
    one = answer("oscillators")
    fallen = one.separation.assign(gap=one.separation.gap * np.inf)
    first, *_ = first_lines(dataclasses.replace(one, separation=fallen))
    assert first.startswith("No gap is enough for Office block and Annex: in more than 10")
    assert not any(
        "move alike" in text for text in cautions(dataclasses.replace(one, separation=fallen))
    )


@pytest.mark.parametrize("name", CASES)
def test_the_screen_begins_with_the_required_gap_verdict_and_reason(name: str, answer: Any) -> None:
    one, alone = answer(name), "set-back" in name
    first, shown = first_lines(one), " ".join(filter(None, lines(answer_sections(one))))
    assert shown.startswith(" ".join(first))
    assert not alone or not re.search(r"apart|\b(both|they|gap)\b", shown)
    gap = "0" if name == "alike" else f"{CM * one.separation.gap[0].item():.1f}"
    stand = "away from its property line" if alone else "apart"
    assert f" should stand {gap}\N{NO-BREAK SPACE}cm {stand}. 95" in first[0]
    levels = {"storeys": " at 7", "mixed": " at 9.6"}
    where = "" if alone or "heights" in name else levels.get(name, " at 15")
    assert re.search(rf"need no more; mean peaks? [^a]*( and [^a]*)?{where}", first[-1])
    first.remove(of_earthquakes(one))
    if one.existing is not None:
        word = "enough" if name == "enough" else "not enough"
        assert f"in {100 * one.existing.no_pounding_probability.item():.1f}" in first[1]
        assert first[2] == f"Verdict: {word}; 90\N{NO-BREAK SPACE}% are required."
        ends = dict.fromkeys(("_lower", "_upper"), (0.85, 0.93))
        near = {
            f"no_pounding_probability{end}": both[n] for n, (end, both) in enumerate(ends.items())
        }
        undecided = dataclasses.replace(one, existing=one.existing.assign(near))
        assert first_lines(undecided)[3].startswith("Verdict: undecided within the error")


def test_limits_of_the_existing_gap_are_factors_on_what_there_is(answer: Any) -> None:
    """Accelerations grow with the root of S0, here 0.01, and strength falls with R, here 4."""
    one = answer("oscillators")
    known = {"largest_intensity": (0.2, 0.19, 0.21), "least_added_damping": (0.1, 0.08, 0.12)}
    known["largest_intensity"] = tuple(0.01 * factor**2 for factor in known["largest_intensity"])
    known |= {
        "largest_reduction_factor": (2.0, 1.6, 2.5),
        "least_reduction_factor": (0.5, 0.4, 0.8),
    }

    def shown(**changed: float) -> list[tuple[str, ...]]:
        limits = {
            f"{name}{end}{of}": changed.get(name, value)
            for name, values in known.items()
            for end, value in zip(("", "_lower", "_upper"), values, strict=True)
            for of in (("_1", "_2") if "factor" in name else ("",))
        }
        (table, _) = allowances(dataclasses.replace(one, existing=one.existing.assign(limits)))
        assert isinstance(table, TableBlock)
        return [tuple(row.cells[1:]) for row in table.rows]

    assert shown() == [
        ("at least 2", "1.6 to 2.5"), ("at most 8", "5 to 10"),
        ("at most 0.2", "0.19 to 0.21"), ("at least 0.1", "0.08 to 0.12"),
    ]  # fmt: skip
    beyond = shown(
        largest_reduction_factor=np.inf, least_reduction_factor=0.0, largest_intensity=np.nan
    )
    assert beyond == [
        ("every value tried", ""),
        ("no tried value is enough", ""),
        ("at least 0.1", "0.08 to 0.12"),
    ]
    assert shown(largest_reduction_factor=np.nan)[0] == ("no tried value is enough", "")
