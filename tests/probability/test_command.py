"""``stochlin probability``: a case file in, a table, a picture and a file out."""

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from cases import example_case
from commands import answered

import stochlin as sl
from stochlin.applications.cases.probability import judge_gap
from stochlin.applications.cases.rows import gap_of
from stochlin.applications.cases.separation import answer_case
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
