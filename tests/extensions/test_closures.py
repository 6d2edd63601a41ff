"""A closure from outside: one function, known to every command."""

import pytest
import xarray as xr

import stochlin as sl

pytestmark = pytest.mark.cli

PAIR = "rho --period-1 0.8s --period-2 1.1s --hardening 0.05 --reduction-factor 4"


def test_a_closure_of_the_page_lies_between_both_that_it_mixes(toy, tmp_path):
    done = toy(*PAIR.split(), "--closure", "between", "--out", "between.nc")
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(tmp_path / "between.nc") as table:
        between = float(table.displacement_std_1)
    first = sl.Bilinear(0.8, 0.05, 0.05, reduction_factor=4)
    gaussian, clipped = (
        float(sl.linearize(first, sl.WhiteNoise(1.0), closure=name).displacement_std)
        for name in ("gaussian", "clipped")
    )
    assert gaussian < between < clipped
    other = toy(*PAIR.split(), "--closure", "clippd")
    assert other.returncode == 2
    known = "did you mean 'clipped'? allowed: gaussian, clipped, drift, between"
    assert known in " ".join(other.stderr.split())


def test_closures_are_listed_in_their_order_and_belong_to_laws():
    assert sl.Bilinear.closure_names()[:3] == ("gaussian", "clipped", "drift")
    assert sl.BoucWen.closure_names() == ("gaussian",)
    assert sl.BoucWen.closed_form("drift") is None
