"""The hazard of a case file and the risk that is allowed: what is read, answered and shown."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from cases import FIRM_SITE, read_text

import stochlin as sl
from stochlin.applications.cases.reading.case import Case
from stochlin.applications.cases.separation import answer_case
from stochlin.views.separation.risk import risk_blocks
from stochlin.views.shared.words import NBSP

pytestmark = pytest.mark.invariant

G = 9.80665
HAZARD = '[site.hazard]\nmeasure = "pga"\n'
POINTS = (
    'intensities = ["0.05 g", "0.1 g", "0.2 g", "0.4 g", "0.8 g"]\n'
    'return_periods = ["30 yr", "100 yr", "475 yr", "2475 yr", "20000 yr"]\n'
)
TWO = 'intensities = ["0.1 g", "0.2 g"]\n'
BUILDINGS = """\
[building_1]
period = "1.0 s"
damping = 0.05
hardening = 0.05
reduction_factor = 3
[building_2]
period = "0.6 s"
damping = 0.05
elastic = true
[separation]
confidence = "90 %"
floors_align = false
"""
SIMULATION = "[simulation]\npaths = 512\n"
CURVE = ([0.05, 0.1, 0.2, 0.4, 0.8], [1 / 30, 1 / 100, 1 / 475, 1 / 2475, 1 / 20000])


def read(folder: Path, hazard: str, wanted: str = "") -> Case:
    site = FIRM_SITE.replace("[motion]", f"{hazard}[motion]")
    return read_text(folder, f"{site}{BUILDINGS}{wanted}{SIMULATION}")


@pytest.mark.parametrize(
    ("lines", "hazard"),
    [
        (f"{HAZARD}{POINTS}", sl.HazardCurve([G * im for im in CURVE[0]], CURVE[1])),
        (
            f"{HAZARD}{TWO}frequencies = [0.01, 0.001]\n",
            sl.HazardCurve([0.1 * G, 0.2 * G], [0.01, 0.001]),
        ),
        (f'{HAZARD}k0 = 0.01\nk = 2\nunits = "m/s^2"\n', sl.PowerLawHazard(0.01, 2.0)),
        (
            f'{HAZARD.replace("pga", "sa")}sa_period = "1 s"\n{TWO}frequencies = [0.01, 0.001]\n',
            sl.HazardCurve([0.1 * G, 0.2 * G], [0.01, 0.001], measure="sa", period=1.0),
        ),
        (
            f'{HAZARD.replace("pga", "intensity")}k0 = 1e-2\nk = 1.3\nunits = "cm^2/s^3"\n',
            sl.PowerLawHazard(1e-2 * 1e-4**1.3, 1.3, measure="intensity"),
        ),
    ],
)
def test_a_hazard_is_read_in_every_form(lines, hazard, tmp_path):
    found = read(tmp_path, lines).site.hazard
    assert type(found) is type(hazard)
    assert (found.measure, found.period) == (hazard.measure, hazard.period)
    years = 1 / 0.003
    assert float(found.intensity(years)) == pytest.approx(float(hazard.intensity(years)), rel=1e-12)


def test_a_file_is_read_as_from_python(tmp_path):
    rows = "# by the survey\npga [g],per year\n0.1,1e-2\n0.4,1e-3\n"
    (tmp_path / "hazard.csv").write_text(rows, encoding="utf-8")
    case = read(tmp_path, f'{HAZARD}file = "hazard.csv"\n')
    assert case.site.hazard == sl.read_hazard(tmp_path / "hazard.csv")
    assert case.site.hazard.intensities == pytest.approx([0.1 * G, 0.4 * G])
    assert tmp_path / "hazard.csv" in case.files


def test_a_hazard_too_steep_is_named(tmp_path):
    with pytest.raises(ValueError, match=r"case.toml.*k = 400 is out of range"):
        read(tmp_path, f'{HAZARD}k0 = 1e-4\nk = 400\nunits = "m/s^2"\n')


@pytest.fixture(scope="module")
def answered(tmp_path_factory):
    wanted = 'existing = "4 cm"\nrisk = "5 % in 30 years"\n'
    return answer_case(read(tmp_path_factory.mktemp("risk"), HAZARD + POINTS, wanted))


def test_risk_of_a_case_is_that_from_python(answered):
    case, table = answered.case, answered.risk
    assert table.risk_of.values.tolist() == ["existing", "answer", "target"]
    pair = case.buildings[0].structure, case.buildings[1].structure
    common = {"paths": 128, "envelope": case.site.course.envelope}
    one = sl.pounding_risk(
        *pair,
        case.site.ground,
        0.04,
        case.site.hazard,
        case.site.course.duration,
        years=30.0,
        **common,
    )
    for name in ("annual_rate", "annual_rate_standard_error", "probability_in_years_upper"):
        assert float(table[f"risk_{name}"][0]) == pytest.approx(float(one[name]), rel=1e-12)
    by_intensity = table.risk_annual_rate_by_intensity.isel(risk_gap=0)
    np.testing.assert_allclose(by_intensity, one.annual_rate_by_intensity, rtol=1e-12)
    whole = answered.table()
    assert whole.attrs["paths"] == 512
    assert whole.attrs["risk_paths"] == 128
    for name in table.data_vars:
        assert whole[name].attrs["long_name"], name
    assert set(answered.table(samples=False).dims) == {"rule"}


def test_a_hazard_that_ends_early_is_said_before_its_frequency(tmp_path):
    """The curve ends at 0.1 g, once in 100 years: the least return period that it supports."""
    early = 'intensities = ["0.05 g", "0.1 g"]\nreturn_periods = ["30 yr", "100 yr"]\n'
    answer = answer_case(read(tmp_path, HAZARD + early, 'existing = "30 cm"\n'))
    first, *_, table, _ = risk_blocks(answer)
    assert first.text.startswith("The hazard curve ends at PGA 0.1")
    assert table.rows[0].cells[3].replace(NBSP, " ") == "100 years or more"
