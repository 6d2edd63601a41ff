"""Pictures of spectra show the numbers of their datasets, and say of what they are."""

import numpy as np
import pytest
import xarray as xr

import stochlin as sl
from stochlin.views.sites.pictures import fit_in_words

pytestmark = pytest.mark.invariant

MOTION = (10.0, sl.AminAng(1.0, 6.0, 0.5))
GROUND = sl.CloughPenzien(0.5, 0.5, 3.0, 0.7, intensity=0.01)
CODE = sl.eurocode_8(2.0, "B")


@pytest.fixture(scope="module")
def of_code() -> xr.Dataset:
    return sl.simulated_spectrum(GROUND, CODE, *MOTION, paths=64)


def lines(axes) -> dict[str, np.ndarray]:
    return {line.get_label(): line.get_ydata() for line in axes.get_lines()}


def test_the_spectra_are_those_of_the_dataset(of_code, tmp_path):
    of_code.to_netcdf(tmp_path / "table.nc")
    with xr.open_dataset(tmp_path / "table.nc") as read:
        for one in (of_code, read):
            (axes,) = sl.charts.draw_spectrum(one).axes
            drawn = lines(axes)
            np.testing.assert_array_equal(drawn["motions, mean"], one.pseudo_acceleration)
            np.testing.assert_array_equal(drawn["wanted"], one.target)


def test_the_fit_of_a_case_is_told_in_the_band_of_its_buildings():
    """Buildings of 0.5 and 1 s have a band of 0.1 to 1.5 s: errors beyond do not concern them."""
    period = np.array([0.05, 0.09, 0.11, 0.5, 1.4, 1.6, 8.0])
    ratio = np.array([1.5, 0.6, 1.03, 1.0, 0.96, 2.0, 3.0])
    table = xr.Dataset(
        {"target": ("period", period), "ratio": ("period", ratio)}, {"period": period}
    )
    (whole,), (told,), (beyond,) = (fit_in_words(table, each) for each in ((), (0.5, 1.0), (99.0,)))
    assert "at most by +200.0\N{NO-BREAK SPACE}%, at 8 s" in whole
    assert "at most by \N{MINUS SIGN}4.0\N{NO-BREAK SPACE}%, at 1.4 s" in told
    assert f"off by {100 * np.sqrt((0.03**2 + 0.04**2) / 3):.1f}\N{NO-BREAK SPACE}%" in told
    assert "from 0.1 to 1.5 s, 0.2 to 1.5 times the periods of the buildings" in told
    assert beyond == whole
    caption = (
        sl.charts.draw_spectrum(of_two(period, ratio), periods=[0.5, 1.0]).texts[-1].get_text()
    )
    assert "at 1.4 s" in caption


def of_two(period: np.ndarray, ratio: np.ndarray) -> xr.Dataset:
    """A spectrum with these ratios to its target."""
    table = sl.simulated_spectrum(GROUND, sl.eurocode_8(2.0, "B"), *MOTION, paths=2)
    table = table.isel(period=slice(period.size)).assign_coords(period=period)
    return table.assign(ratio=("period", ratio))
