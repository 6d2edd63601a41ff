"""Case files with a design spectrum in place of a ground."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import stochlin as sl
from stochlin.analyses.cases.case import Case
from stochlin.analyses.cases.examples import example_case
from stochlin.analyses.sites.motion_fit import USES
from stochlin.views.shared.descriptions import source_in_words

pytestmark = pytest.mark.invariant

G = 9.80665
EXAMPLE = example_case().replace('duration = "20 s"', 'duration = "5 s"')  # fits take as long
CODE = 'spectrum = "eurocode_8"\nag = "0.25 g"\nsoil = "C"\n'


def read(folder: Path, site: str) -> Case:
    start, end = EXAMPLE.index("[site]"), EXAMPLE.index("[motion]")
    path = folder / "case.toml"
    path.write_text(f"{EXAMPLE[:start]}[site]\n{site}\n{EXAMPLE[end:]}", encoding="utf-8")
    return sl.read_case(path)


@pytest.mark.slow
def test_the_ground_delivers_the_spectrum_in_the_motion_of_the_file(tmp_path):
    case = read(tmp_path, CODE + "filters = 1\n")
    target = sl.eurocode_8(0.25 * G, "C")
    motion = {"duration": case.duration, "envelope": case.envelope}
    assert case.ground == sl.fit_ground(target, filters=1, **motion)
    assert case.site == "eurocode_8"
    assert "Eurocode 8, type 1, ground C" in case.ground.source
    assert "(largest)" in case.ground.source
    assert source_in_words(case).endswith("decay 0.35 1/s)")
    assert case.scatter == case.motion["scatter"] == USES["spectrum"].scatter


@pytest.mark.slow
def test_a_file_of_a_spectrum_is_read_and_kept_from_being_overwritten(tmp_path):
    period = np.geomspace(0.05, 4.0, 60)
    values = sl.asce_7(G, 0.6 * G, 8.0).interp(period=period).values
    rows = [f"{t:.6g},{a:.9g}" for t, a in zip(period, values, strict=True)]
    (tmp_path / "site.csv").write_text("\n".join(["T,Sa", *rows]), encoding="utf-8")
    options = 'units = "m/s^2"\nbetween = "linear"\nfilters = 1\n'
    one = read(tmp_path, f'spectrum = "site.csv"\n{options}')
    linear = sl.read_spectrum(tmp_path / "site.csv", units="m/s^2", between="linear")
    np.testing.assert_array_equal(one.spectrum, linear)
    two = read(tmp_path, 'spectrum = "asce_7"\nsds = "1 g"\nsd1 = "0.6 g"\ntl = "8 s"\nfilters = 1\n')
    assert tmp_path / "site.csv" in one.inputs
    frequency = np.array([2.0, 5.0, 20.0])
    np.testing.assert_allclose(one.ground.psd(frequency), two.ground.psd(frequency), rtol=0.03)


@pytest.mark.parametrize(
    ("site", "stated"),
    [
        (CODE, ("ag", 0.25 * G)),
        ('spectrum = "asce_7"\nsds = "1 g"\nsd1 = "0.6 g"\ntl = "8 s"\n', ("", 1.0)),
        ('ground = "firm"\npga = "0.3 g"\n', ("pga", 0.3 * G)),
        ('ground = "firm"\nintensity = "0.01 m^2/s^3"\n', ("", 1.0)),
    ],
)
def test_the_strength_of_a_site_is_told_by_the_key_that_states_it(tmp_path, site, stated):
    of_site = read(tmp_path, site).of_site
    assert (of_site.stated_strength[0], of_site.by_intensity) == (stated[0], "intensity" in site)
    assert of_site.stated_strength[1] == pytest.approx(stated[1])


FILTER = '[[site.grounds]]\nground = "firm"\nintensity = "0.01 m^2/s^3"\n'


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ("", "site does not fit: ParallelGround: 0 grounds; allowed: two or more"),
        (
            FILTER + '[[site.grounds]]\nground = "parallel"\n',
            "grounds.ground = 'parallel' is not",
        ),
        (FILTER + FILTER.replace("firm", "white_noise"), "white noise"),
    ],
)
def test_what_is_wrong_with_filters_in_parallel_is_said(tmp_path, lines, message):
    with pytest.raises(ValueError, match=message):
        read(tmp_path, f'ground = "parallel"\n{lines}')


@pytest.mark.parametrize(
    ("site", "message"),
    [
        (f'{CODE}ground = "firm"\n', "line 17: site.ground = 'firm' is given beside a spectrum"),
        (
            'spectrum = "eurocode_9"\n',
            "is neither a code nor a file beside this one; did you mean 'eurocode_8'. allowed: euro",
        ),
        (
            'spectrum = "asce_7"\nsds = "1 g"\nsd1 = "9 g"\ntl = "8 s"\n',
            "cannot be used: tl = 8 s; allowed",
        ),
    ],
)
def test_what_is_wrong_is_said_with_its_line(tmp_path, site, message):
    with pytest.raises(ValueError, match=message):
        read(tmp_path, site)
