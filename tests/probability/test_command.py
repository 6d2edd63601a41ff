"""``stochlin probability``: a case file in, a table, a picture and a file out."""

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from cases import example_case, storeyed_building, with_buildings
from commands import answered, refused

import stochlin as sl
from stochlin.analyses.cases.probability import judge_gap
from stochlin.analyses.cases.rows import gap_of
from stochlin.analyses.cases.separation import answer_case
from stochlin.views.probability.pictures import draw_pounding

pytestmark = pytest.mark.cli


@pytest.fixture
def case(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(example_case(), encoding="utf-8")
    return path


def test_prints_saves_and_draws(case, tmp_path):
    out, picture = tmp_path / "p.nc", tmp_path / "p.png"
    done = answered("probability", case, "--gap", "8cm", "--out", out, "--picture", picture)
    assert "Confidence of no pounding up to each time" in done.output
    assert "Gap for a confidence of" in done.output
    assert picture.stat().st_size > 10_000
    with xr.open_dataset(out, engine="scipy") as table:
        last = float(table.confidence_of_no_pounding_simulated[-1])
    assert f"{last:.4f}" in done.output
    said = " ".join(done.output.split())
    assert "cm by formula, 10.7 cm corrected, 10.9 cm simulated" in said
    assert "the column formula: for buildings like these it may be far off. The column" in said


def test_gap_and_probability_give_the_same_numbers_for_one_file(case):
    case.write_text(case.read_text(encoding="utf-8").replace("2048", "128"), encoding="utf-8")
    read = sl.read_case(case)
    judged, answer = judge_gap(read, gap_of(read)).table.isel(time=-1), answer_case(read)
    for end in ("", "_lower", "_upper"):
        confidence = judged[f"confidence_of_no_pounding_simulated{end}"]
        share = answer.existing[f"no_pounding_probability{end}"]
        assert float(share) == pytest.approx(float(confidence), rel=1e-12)
        assert float(answer.separation[f"gap{end}"][0]) == float(judged[f"required_gap_simulated{end}"])


@pytest.mark.slow
def test_buildings_with_storeys_have_all_parameters_in_the_picture(tmp_path):
    path, out = tmp_path / "case.toml", tmp_path / "p.nc"
    storeys = [storeyed_building(n, start) for n, start in ((1, "period"), (2, "masses"))]
    text = with_buildings(*storeys).replace("2048", "100").replace("align = true", "align = false")
    path.write_text(text, encoding="utf-8")
    done = answered("probability", path, "--out", out)
    assert "Floors are not level: floor 1 of Block 1" in done.output
    with xr.open_dataset(out, engine="scipy") as table:
        figure = draw_pounding(table)
    labels = [text.get_text() for axes in figure.axes for text in axes.get_legend().get_texts()]
    assert "crossings in clumps" in labels
    assert {"$u_1 - u_2$ by formula", "simulated"} <= set(labels)
    caption = figure.texts[-1]
    assert "gap: 5 cm" in caption.get_text()
    figure.draw_without_rendering()
    assert caption.get_window_extent().y0 >= 0


@pytest.mark.slow
def test_records_are_in_the_table_and_the_picture(tmp_path):
    """A harmonic motion at the period of one building: its radius alone closes the gap."""
    time = 0.02 * np.arange(600)
    np.savetxt(tmp_path / "short.txt", 0.1 * np.sin(2 * np.pi * time[:400]))
    np.savetxt(tmp_path / "weak.txt", 1e-3 * np.sin(2 * np.pi * time))
    records = "".join(
        f'[[site.records]]\npath = "{n}.txt"\nname = "A {n} one"\nunits = "g"\ndt = "0.02 s"\n'
        for n in ("short", "weak")
    )
    path, out, sheet = (tmp_path / name for name in ("case.toml", "p.nc", "p.csv"))
    text = example_case().replace("2048", "100").replace("[motion]", f"{records}[motion]")
    path.write_text(text, encoding="utf-8")
    for target in (out, sheet):
        done = answered("probability", path, "--out", target, "--picture", tmp_path / "p.png")
    said = " ".join(done.output.split())
    assert "Record A short one, hybrid method: confidence 0.0000 (rho" in said
    assert said.count("so that no phase avoids pounding") == 1
    with xr.open_dataset(out, engine="scipy") as table:
        figure = draw_pounding(table)
        confidence = table.record_confidence_of_no_pounding.load()
        apart = table.record_radius_difference.values
    assert (confidence.isel(record_time=0) == 1).all()
    assert (confidence.diff("record_time") <= 0).all()
    assert confidence.isel(record_time=-1).values.tolist() == [0.0, 1.0]
    assert float(confidence.record_time[-1]) == pytest.approx(time[-1])  # of the longer one
    assert apart[0] > 0.05 > apart[1]
    labels = [text.get_text() for text in figure.axes[2].get_legend().get_texts()]
    assert labels[:2] == ["A short one", "A weak one"]
    rows = pd.read_csv(sheet)
    assert len(rows) == 2 * rows["time [s]"].nunique()
    ends = rows.groupby("record").first()
    assert ends["record_confidence_of_no_pounding"].tolist() == [0.0, 1.0]
    one, two = (sl.Bilinear(T, 0.05, 0.05, reduction_factor=4) for T in (1.0, 0.6))
    record = sl.read_record(tmp_path / "weak.txt", dt=0.02, units="g")
    alone = sl.pounding_probability(
        one, two, sl.named_ground("firm", 0.01), 0.05, method="hybrid", record=record, confidence=0.9
    )
    found = ends[["record_required_gap [m]", "record_separation [m]"]].loc["A weak one"]
    np.testing.assert_allclose(found, [alone.required_gap, alone.separation], rtol=1e-12)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--gap", "-1m"), "gap = -1 is out"),
    ],
)
def test_bad_input_ends_with_one_sentence(case, arguments, message):
    assert message in refused("probability", case, *arguments)
