"""``stochlin probability``: a case file in, a table, a picture and a file out."""

from __future__ import annotations

import pytest
import xarray as xr
from click.testing import CliRunner

import stochlin as sl
from stochlin.views.probability.command import probability

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
    assert "Confidence of no pounding so far" in done.output
    assert "Gap for a confidence of" in done.output
    assert picture.stat().st_size > 10_000
    with xr.open_dataset(out, engine="scipy") as table:
        last = float(table.confidence_of_no_pounding_simulated[-1])
    assert f"{last:11.4f}" in done.output


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
