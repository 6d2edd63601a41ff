"""``stochlin probability``: a case file in, a table, a picture and a file out."""

from __future__ import annotations

import pytest
import xarray as xr
from cases import storeyed_building, with_buildings
from click.testing import CliRunner

import stochlin as sl
from stochlin.views.probability.command import probability
from stochlin.views.probability.pictures import draw_pounding

pytestmark = pytest.mark.cli


@pytest.fixture
def case(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(sl.example_case(), encoding="utf-8")
    return path


def run(*arguments):
    return CliRunner().invoke(probability, [str(argument) for argument in arguments])


def test_prints_saves_and_draws(case, tmp_path):
    out, picture = tmp_path / "p.nc", tmp_path / "p.png"
    done = run(case, "--gap", "8cm", "--out", out, "--picture", picture)
    assert done.exit_code == 0, done.output
    assert "Confidence of no pounding up to each time" in done.output
    assert "Gap for a confidence of" in done.output
    assert picture.stat().st_size > 10_000
    with xr.open_dataset(out, engine="scipy") as table:
        last = float(table.confidence_of_no_pounding_simulated[-1])
    assert f"{last:11.4f}" in done.output


@pytest.mark.slow
def test_buildings_with_storeys_have_all_parameters_in_the_picture(tmp_path):
    path, out = tmp_path / "case.toml", tmp_path / "p.nc"
    storeys = [storeyed_building(n, start) for n, start in ((1, "period"), (2, "masses"))]
    text = with_buildings(*storeys).replace("2048", "100").replace("align = true", "align = false")
    path.write_text(text, encoding="utf-8")
    done = run(path, "--out", out)
    assert done.exit_code == 0, done.output
    assert "Floors are not level: floor 1 of Block 1" in done.output
    with xr.open_dataset(out, engine="scipy") as table:
        figure = draw_pounding(table)
    labels = [text.get_text() for axes in figure.axes for text in axes.get_legend().get_texts()]
    assert "crossings in clumps" in labels
    assert {"std of $u_1 - u_2$", "simulated"} <= set(labels)
    caption = figure.texts[-1]
    assert "gap: 0.05\N{NO-BREAK SPACE}m" in caption.get_text()
    figure.draw_without_rendering()
    assert caption.get_window_extent().y0 >= 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--gap", "-1m"), "gap = -1"),
        (("--out", "p.xls"), "ends in '.xls'"),
        (("--picture", "nowhere/p.png"), "no folder nowhere"),
    ],
)
def test_bad_input_ends_with_one_sentence(case, arguments, message):
    done = run(case, *arguments)
    assert done.exit_code == 2
    assert message in done.output
    assert "Traceback" not in done.output
