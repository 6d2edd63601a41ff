"""Figs. 6 to 8 as they are drawn, and the files of them that come with the project."""

from pathlib import Path

import matplotlib.image
import numpy as np
import pytest
import xarray as xr

import stochlin as sl
from stochlin.charts import ChartSettings, chart_functions, draw

pytestmark = pytest.mark.paper

FOLDER = Path(__file__).parents[2] / "figures"
NAMES = ("fig6", "fig7", "fig8")
CHARTS = chart_functions(ChartSettings())


def saved(name):
    with xr.open_dataset(FOLDER / f"{name}.nc") as chart:
        return chart.load()


def curve(axes, label):
    (line,) = (line for line in axes.get_lines() if line.get_label() == label)
    return np.asarray(line.get_xdata(), float), np.asarray(line.get_ydata(), float)


@pytest.mark.parametrize("name", NAMES)
def test_files_are_what_the_program_makes(name):
    chart, file = CHARTS[name](), saved(name)
    assert set(chart.variables) == set(file.variables)
    for variable in chart.data_vars:
        np.testing.assert_array_equal(file[variable], chart[variable])
    for key in ("title", "caption", "comment", "references"):
        assert file.attrs[key] == chart.attrs[key]
    picture = matplotlib.image.imread(FOLDER / f"{name}.png")
    assert picture.shape[1] == 1080  # 7.2 inches at 150 dots
    assert picture.std() > 0.05


def test_fig6_draws_both_elements_of_the_paper_and_their_laws():
    kelvin, impact, loops = draw(sl.charts.contact_loop_chart()).axes
    assert any("max(v, 0)" in text.get_text().replace("\\", "") for text in impact.texts)
    assert not any("max" in text.get_text() for text in kelvin.texts)
    # With e = 0.65 the dashpot of the Kelvin element pulls at the end, that of the other has let
    # go.
    d, force = curve(loops, "Kelvin")
    xi = sl.Kelvin.damping_ratio(0.65)
    assert force[0] == pytest.approx(2 * xi)
    assert force[-1] == pytest.approx(-2 * xi * 0.65)
    assert d[-1] == pytest.approx(0, abs=1e-12)
    # Back from its deepest point the force of the Impact Kelvin element is that of the bare spring.
    d, force = curve(loops, "Impact Kelvin")
    back = slice(int(d.argmax()) + 1, None)
    np.testing.assert_allclose(force[back], d[back], atol=1e-12)


def test_fig7_shows_that_kelvin_opposes_the_parting_and_takes_longer():
    upper, lower = draw(sl.charts.contact_history_chart()).axes
    root = np.sqrt(0.75)
    time, d = curve(upper, "Kelvin")
    np.testing.assert_allclose(d, np.exp(-0.5 * time) * np.sin(root * time) / root, atol=1e-12)
    assert time[-1] == pytest.approx(np.pi / root)
    assert curve(lower, "Kelvin")[1].min() < -0.1
    time, force = curve(lower, "Impact Kelvin")
    assert time[-1] == pytest.approx(np.arccos(0.5) / root + np.pi / 2)
    assert force.min() > -1e-12


def test_fig8_draws_both_elements_of_the_paper():
    chart = sl.charts.restitution_chart()
    [axes] = draw(chart).axes
    for kind, label in ((sl.Kelvin, "Kelvin"), (sl.ImpactKelvin, "Impact Kelvin")):
        xi, e = curve(axes, label)
        np.testing.assert_array_equal(e, kind.restitution(xi))
    assert (xi[0], xi[-1], axes.get_ylim()) == (0, 1, (0, 1))
