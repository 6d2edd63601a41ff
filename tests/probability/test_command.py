"""``stochlin probability``: a case file in, a table, a picture and a file out."""

import pytest
import xarray as xr
from cases import example_case
from commands import answered

import stochlin as sl
from stochlin.applications.cases.separation import answer_case

pytestmark = pytest.mark.cli


def test_it_prints_saves_and_draws_the_numbers_that_gap_gives_for_the_same_file(tmp_path):
    case, out, picture = (tmp_path / name for name in ("case.toml", "p.nc", "p.png"))
    text = example_case().replace("2048", "128").replace("5 cm", "8 cm")
    case.write_text(text, encoding="utf-8")
    done = answered("probability", case, "--out", out, "--picture", picture)
    assert picture.stat().st_size > 10_000
    answer = answer_case(sl.read_case(case))
    with xr.open_dataset(out, engine="scipy") as table:
        for end in ("", "_lower", "_upper"):
            confidence = table[f"confidence_of_no_pounding_simulated{end}"]
            share = answer.existing[f"no_pounding_probability{end}"]
            assert float(share) == pytest.approx(float(confidence), rel=1e-12)
            gap = answer.separation[f"gap{end}"][0]
            assert float(gap) == float(table[f"required_gap_simulated{end}"])
        assert f"{float(table.confidence_of_no_pounding_simulated):.4f}" in done.output
    assert "Do not rely on the formula" not in " ".join(done.output.split())


@pytest.mark.parametrize(("gap", "asked"), [("8m", True), ("8cm", False)])
def test_a_gap_of_the_command_line_has_the_limits_of_one_in_a_file(tmp_path, gap, asked):
    case = tmp_path / "case.toml"
    case.write_text(example_case().replace("2048", "100"), encoding="utf-8")
    done = answered("probability", case, "--gap", gap)
    assert ("usual are 0.01 to 0.5 m" in done.output) == asked
