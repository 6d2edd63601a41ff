"""Probability of pounding of laws without equivalent coefficients: by simulation alone."""

import pytest
import xarray as xr
from cases import example_case
from commands import answered

import stochlin as sl
from stochlin.views.probability.pictures import draw_pounding

GROUND = sl.KanaiTajimi(0.4, 0.6, intensity=0.02)
MOTION = {"envelope": sl.AminAng(1.0, 6.0, 0.5), "duration": 10.0, "paths": 64, "seed": 3}
CLOUGH = sl.ModifiedClough(0.6, 0.05, hardening=0.05, yield_displacement=0.02)
BESIDE = sl.Bilinear(1.0, 0.05, hardening=0.05, yield_displacement=0.04)
STEM = "confidence_of_no_pounding"


def test_shares_are_those_of_simulated_separations():
    table = sl.pounding_probability(CLOUGH, BESIDE, GROUND, 0.1, **MOTION)
    assert STEM not in table
    assert "cannot be linearized" in table.attrs["comment"]
    moved = sl.simulate([CLOUGH, BESIDE], GROUND, **MOTION)
    apart = moved.separation.isel(structure=0, structure_2=1)
    share = float((apart <= 0.1).mean("path"))
    assert float(table[f"{STEM}_simulated"]) == share
    assert 0 < share < 1


def test_without_a_simulation_there_is_nothing():
    with pytest.raises(ArithmeticError, match="ModifiedClough cannot be linearized"):
        sl.pounding_probability(CLOUGH, BESIDE, GROUND, 0.1, **MOTION | {"paths": 0})


@pytest.mark.cli
def test_the_command_prints_and_draws_what_is_simulated(tmp_path):
    path, out = tmp_path / "case.toml", tmp_path / "p.nc"
    text = example_case().replace("2048", "128")
    text = text.replace('damping = "5 %"\n', 'damping = "5 %"\nlaw = "modified_clough"\n', 1)
    path.write_text(text, encoding="utf-8")
    said = " ".join(answered("probability", path, "--out", out).output.split())
    assert "There are no formulas: ModifiedClough cannot be linearized" in said
    with xr.open_dataset(out, engine="scipy") as table:
        assert STEM not in table
        names = {text.get_text() for text in draw_pounding(table).axes[0].get_legend().get_texts()}
    assert names >= {"simulated, 95 % interval"}
