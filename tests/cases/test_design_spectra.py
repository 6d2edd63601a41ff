"""Case files with a design spectrum in place of a ground, and the scatter of their motions."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from cases import example_case

import stochlin as sl
from stochlin.applications.cases.reading.case import Case
from stochlin.applications.cases.rows import motion_of
from stochlin.applications.sites.motion_fit import USES
from stochlin.views.shared.words import scatter

pytestmark = pytest.mark.invariant

G = 9.80665
EXAMPLE = example_case().replace('duration = "20 s"', 'duration = "5 s"')  # fits take as long
CODE = 'spectrum = "eurocode_8"\nag = "0.25 g"\nsoil = "C"\n'


def read(folder: Path, site: str, more: str = "") -> Case:
    start, end = EXAMPLE.index("[site]"), EXAMPLE.index("[motion]")
    path, rest = folder / "case.toml", EXAMPLE[end:].replace("[motion]", f"[motion]\n{more}", 1)
    path.write_text(f"{EXAMPLE[:start]}[site]\n{site}\n{rest}", encoding="utf-8")
    return sl.read_case(path)


@pytest.mark.slow
def test_the_ground_delivers_the_spectrum_in_the_motion_of_the_file(tmp_path):
    case = read(tmp_path, CODE + "filters = 1\n")
    target = sl.eurocode_8(0.25 * G, "C")
    motion = {"duration": case.site.course.duration, "envelope": case.site.course.envelope}
    assert case.site.ground == sl.fit_ground(target, filters=1, **motion)
    assert case.site.name == "eurocode_8"
    assert "Eurocode 8, type 1, ground C" in case.site.ground.source
    assert "(largest)" in case.site.ground.source
    assert "decay 0.35 1/s), have this spectrum" in case.site.ground.source
    assert case.site.scatter == motion_of(case)["scatter"] == USES["spectrum"].scatter


@pytest.mark.slow
def test_a_file_of_a_spectrum_is_read_and_kept_from_being_overwritten(tmp_path):
    period = np.geomspace(0.05, 4.0, 60)
    values = sl.asce_7(G, 0.6 * G, 8.0).interp(period=period).values
    rows = [f"{t:.6g},{a:.9g}" for t, a in zip(period, values, strict=True)]
    (tmp_path / "site.csv").write_text("\n".join(["T,Sa", *rows]), encoding="utf-8")
    options = 'units = "m/s^2"\nbetween = "linear"\nfilters = 1\n'
    one = read(tmp_path, f'spectrum = "site.csv"\n{options}')
    linear = sl.read_spectrum(tmp_path / "site.csv", units="m/s^2", between="linear")
    np.testing.assert_array_equal(one.site.spectrum, linear)
    two = read(tmp_path, 'spectrum = "asce_7"\nsds = "1 g"\nsd1 = "0.6 g"\ntl = "8 s"\nfilters = 1\n')
    assert tmp_path / "site.csv" in one.files
    frequency = np.array([2.0, 5.0, 20.0])
    np.testing.assert_allclose(one.site.ground.psd(frequency), two.site.ground.psd(frequency), rtol=0.03)


def test_the_scatter_is_that_of_the_file_or_what_suites_show(tmp_path):
    """None where the strength of the ground is given."""
    firm = 'ground = "firm"\nintensity = "0.01 m^2/s^3"\n'
    of_suites = "0.3 (suites of records about a spectrum)."
    for site, given, value, said in (
        (firm, "", 0.0, ""),
        (firm, "scatter = 0.4", 0.4, "the standard deviation 0.4 (scatter in [motion])."),
        (CODE, "", 0.3, f"the standard deviation {of_suites}"),
        (CODE, "scatter = 0", 0.0, ""),
    ):
        case = read(tmp_path, site, given)
        assert case.site.scatter == motion_of(case)["scatter"] == value
        assert scatter(case).endswith(said)
        assert bool(scatter(case)) == bool(said)
