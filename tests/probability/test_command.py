"""``stochlin probability``: a case file in, a table, a picture and a file out."""

import pytest
import xarray as xr
from cases import example_case
from commands import answered

import stochlin as sl
from stochlin.applications.cases.pairs import judge_gap
from stochlin.applications.cases.rows import gap_of
from stochlin.applications.cases.separation import answer_case

pytestmark = pytest.mark.cli


@pytest.fixture
def case(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(example_case(), encoding="utf-8")
    return path


def test_prints_saves_and_draws(case, tmp_path):
    out, picture = tmp_path / "p.nc", tmp_path / "p.png"
    done = answered("probability", case, "--gap", "8cm", "--out", out, "--picture", picture)
    assert picture.stat().st_size > 10_000
    with xr.open_dataset(out, engine="scipy") as table:
        last = float(table.confidence_of_no_pounding_simulated)
    assert f"{last:.4f}" in done.output
    said = " ".join(done.output.split())
    assert "cm by formula, 10.9 cm simulated" in said
    assert "Do not rely on the formula" in said


def test_gap_and_probability_give_the_same_numbers_for_one_file(case):
    case.write_text(case.read_text(encoding="utf-8").replace("2048", "128"), encoding="utf-8")
    read = sl.read_case(case)
    judged, answer = judge_gap(read, gap_of(read)), answer_case(read)
    for end in ("", "_lower", "_upper"):
        confidence = judged[f"confidence_of_no_pounding_simulated{end}"]
        share = answer.existing[f"no_pounding_probability{end}"]
        assert float(share) == pytest.approx(float(confidence), rel=1e-12)
        assert float(answer.separation[f"gap{end}"][0]) == float(judged[f"required_gap_simulated{end}"])
