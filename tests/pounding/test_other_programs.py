"""Impacts, spectra and peak factors beside the published numbers of code_aster, and the page."""

from pathlib import Path

import numpy as np
import other_programs as other
import pytest
from answers.frozen import Case
from scipy.integrate import solve_ivp

import stochlin as sl

pytestmark = [pytest.mark.oracle, pytest.mark.extreme]

PAGE = Path(__file__).parents[2] / "docs" / "verification.md"


def test_a_throw_against_a_stop_has_its_exact_force_time_and_impulse():
    # code_aster SDND101 a; in contact the mass moves as half a sine of w = sqrt((k + K)/m).
    table = other.thrown()
    w = np.sqrt((other.SPRING + other.STOP) / other.MASS)
    both = other.STOP / (other.SPRING + other.STOP)  # share of the stop in all forces
    np.testing.assert_allclose(table.largest_force, other.STOP * other.SPEED / w, rtol=1e-9)
    np.testing.assert_allclose(table.impact_duration, np.pi / w, rtol=1e-6)
    impulse = float(table.contact_force[:20_000, 0].integrate("time"))
    assert impulse == pytest.approx(2 * other.MASS * other.SPEED * both, rel=1e-6)
    later = np.pi / w + np.pi / np.sqrt(other.SPRING / other.MASS)  # the next touch
    assert float(table.impact_time[1]) == pytest.approx(later, rel=1e-6)
    assert float(table.energy_balance_error.max()) < 1e-9
    speed = table.velocity[np.searchsorted(table.time, np.pi / w) + 1, 0]
    assert float(speed) == pytest.approx(-other.SPEED, rel=1e-6)


def test_a_mass_beside_a_wall_in_space_agrees_with_scipy():
    # code_aster SDND102 a.
    table, w = other.in_space(), other.GROUND

    def rates(t, y):
        force = 5.76e7 * max(y[0] - np.sin(w * t) / w**2 - 5e-4, 0.0)
        drag = 0.14 * np.sqrt(25 * 98_696) * y[1]
        return [y[1], -np.sin(w * t) - (98_696 * y[0] + drag + force) / 25]

    options = {"rtol": 1e-9, "atol": 1e-13, "max_step": 5e-5, "t_eval": other.TIMES}
    exact = (
        solve_ivp(rates, (0, 1), [0.0, 0.0], **options).y[0]
        - np.sin(w * np.array(other.TIMES)) / w**2
    )
    ours = other.absolute(table).sel(time=other.TIMES, method="nearest")
    np.testing.assert_allclose(ours, exact, rtol=1e-4)
    assert table.sizes["impact"] == 10


def test_the_closed_form_of_code_aster_is_vanmarckes_but_for_its_approximation():
    # code_aster SDLL104 a.
    m0, m1, m2 = other.moments()
    delta = np.sqrt(1 - m1**2 / (m0 * m2))
    for share, published in ((0.5, 3.3761135643155), (0.95, 4.08151330093)):
        n = 2 * other.STRONG * np.sqrt(m2 / m0) / (2 * np.pi * -np.log(share))
        closed = np.sqrt(2 * np.log(n * -np.expm1(-(delta**1.2) * np.sqrt(np.pi * np.log(n)))))
        assert closed == pytest.approx(published, rel=1e-11)
        assert other.peak_factor(share) == pytest.approx(closed, rel=1e-3)


def test_densities_of_an_acceleration_are_those_of_the_closed_form():
    # code_aster SDLD101 a; the density of the absolute acceleration is that of a Kanai-Tajimi
    # ground.
    f = np.array(other.SHOWN)
    ratio = (2 * np.pi * f) ** 2 / (other.STIFF_SPRING / other.MASS)
    below = (1 - ratio) ** 2 + 4 * 0.05**2 * ratio
    ours = other.densities(f)
    np.testing.assert_allclose(ours["absolute"], (1 + 4 * 0.05**2 * ratio) / below, rtol=1e-12)
    np.testing.assert_allclose(ours["relative"], ratio**2 / below, rtol=1e-12)


def test_the_published_moment_is_more_than_that_of_all_frequencies():
    # code_aster SDLD101 a; u and v of the stationary state are not correlated.
    w = np.sqrt(other.STIFF_SPRING / other.MASS)
    response = sl.linearize(sl.Bilinear(2 * np.pi / w, 0.05), sl.WhiteNoise(1 / (2 * np.pi)))
    u, v = float(response.displacement_std), float(response.velocity_std)
    most = w**4 * u**2 + (2 * 0.05 * w) ** 2 * v**2
    assert most == pytest.approx(505.0, rel=1e-9)
    assert other.moments_in_space()[0] < most < other.MOMENTS[0] < other.IN_STEPS_OF_1_HZ[0]


def test_other_programs_are_as_near_as_the_manual_says():
    for name, (folder, _, _) in other.FROM_MANUAL.items():
        within = Case.named(folder).verified["within"]
        rows = [row for row in other.rows() if row.case.endswith(f": {name}")]
        assert rows
        assert max(abs(row.off) for row in rows) < within


@pytest.mark.parametrize(
    ("case", "tolerance"),
    [("SDND101 a", 2e-4), ("SDND102 a", 0.03), ("SDLD101 a", 2e-3), ("SDLL104 a", 1e-3)],
)
def test_published_numbers_are_within_what_explains_them(case, tolerance):
    rows = [row for row in other.rows() if row.case == case]
    assert rows
    assert max(abs(row.off) for row in rows) < tolerance
    early = [row for row in rows if row.case == "SDND102 a"][:4]  # before small differences grow
    assert all(abs(row.off) < 2e-3 for row in early)
    digits = [row for row in rows if row.quantity.endswith(" Hz")]
    assert all(abs(row.off) < 1e-4 for row in digits)


def test_the_page_has_the_table():
    assert other.markdown() in PAGE.read_text(encoding="utf-8")
