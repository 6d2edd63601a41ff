"""Charts from outside: one file, computed, saved and drawn by the command line."""

import matplotlib.image
import pytest
import xarray as xr

pytestmark = pytest.mark.invariant

SEVERAL = """
import numpy as np
import xarray as xr
from stochlin.charts import register_chart
import stochlin as sl

@register_chart("levels")
def levels_chart(settings):
    values = np.linspace(.5, 2, settings.points)
    period = xr.DataArray(values, coords={"period": ("period", values, {"units": "s"})})
    first = sl.Bilinear(period, settings.damping, settings.hardening, reduction_factor=4)
    table = sl.amplification(first, settings.ground).transpose("ground", ...)
    return table.assign_attrs(chart="curves")

@register_chart("area")
def area_chart(_):
    x, y = np.arange(1.0, 5), np.arange(1.0, 4)
    table = xr.DataArray(np.outer(x, y), dims=("length", "width"), coords={"length": x, "width": y})
    return table.to_dataset(name="area").assign_attrs(chart="plane", title="Areas")

@register_chart("nothing")
def nothing_chart(_):
    rho = xr.DataArray([float("nan")] * 4, coords={"period": [1.0, 2, 3, 4]}, dims="period")
    return xr.Dataset({"rho": rho}, attrs={"chart": "curves"})
"""


@pytest.mark.slow
def test_the_example_of_the_page_is_computed_and_drawn(toy, tmp_path):
    done = toy("charts", "toy", "--points", 9, "--out", ".")
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(tmp_path / "toy.nc") as chart:
        assert chart.attrs["chart"] == "toy_bars"
    assert matplotlib.image.imread(tmp_path / "toy.png").std() > 0.05


@pytest.mark.slow
def test_curves_and_planes_need_no_drawing_code(install, tmp_path):
    stochlin = install(SEVERAL)
    for name in ("levels", "area"):
        done = stochlin("charts", name, "--points", 5, "--out", ".")
        assert done.returncode == 0, done.stderr
        assert matplotlib.image.imread(tmp_path / f"{name}.png").std() > 0.05


@pytest.mark.slow
def test_a_chart_without_a_number_is_not_drawn(install, tmp_path):
    done = install(SEVERAL)("charts", "nothing", "--out", ".")
    assert done.returncode == 2
    assert "the chart has no finite number" in done.stderr
    assert not list(tmp_path.glob("nothing.*"))
