"""Case files with a design spectrum in place of a ground, and the scatter of their motions."""

from __future__ import annotations

from pathlib import Path

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
    assert case.site.scatter == motion_of(case)["scatter"] == USES["spectrum"].scatter


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
