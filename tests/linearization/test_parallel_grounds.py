"""Grounds in parallel: spectra and covariances of linear structures add; a simulation agrees."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

import stochlin as sl

SLOW = sl.CloughPenzien(1.0, 0.4, 5.0, 0.6, intensity=0.01)
FAST = sl.CloughPenzien(0.2, 0.5, 1.0, 0.6, intensity=0.02)
BOTH = sl.ParallelGround([SLOW, FAST])
ONE, TWO = sl.Bilinear(1.0, 0.05), sl.Bilinear(0.6, 0.05)


# The coefficients of their sum are up to 1e12 times each other, and none is a rounding error.
FAR_APART = [
    sl.KanaiTajimi(0.085, 0.12, intensity=0.0012),
    sl.CloughPenzien(0.155, 0.16, 8.0, 0.25, intensity=0.96),
    sl.CloughPenzien(0.95, 0.08, 5.4, 0.6, intensity=0.38),
]


def log_between(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(np.log(low), np.log(high)).map(lambda x: float(np.exp(x)))


KANAI = st.builds(sl.KanaiTajimi, log_between(0.05, 3), log_between(0.05, 2), log_between(1e-3, 1))
CLOUGH = st.builds(
    sl.CloughPenzien,
    log_between(0.05, 3),
    log_between(0.05, 2),
    log_between(0.8, 30),
    log_between(0.2, 1.5),
    log_between(1e-3, 1),
)


@pytest.mark.invariant
@given(st.lists(KANAI | CLOUGH, min_size=2, max_size=3))
@example(FAR_APART)
def test_spectrum_of_the_filter_is_the_sum(grounds):
    frequency = np.geomspace(0.1, 200, 50)
    found = sl.ParallelGround(grounds).lone_filter()
    wanted = sum(ground.psd(frequency).values for ground in grounds)
    # Zeros of polynomials of up to 24th degree: ten digits as a rule, five where they come close.
    np.testing.assert_allclose(found.intensity * found.transmission(frequency), wanted, rtol=1e-5)


@pytest.mark.invariant
@pytest.mark.parametrize("factor", [1e-12, 1e12])
def test_intensity_scales_them_together(factor):
    scaled = sl.ParallelGround([replace(g, intensity=factor * g.intensity) for g in (SLOW, FAST)])
    before, after = (sl.correlate(ONE, TWO, ground) for ground in (BOTH, scaled))
    np.testing.assert_allclose(
        after.displacement_std_1, np.sqrt(factor) * before.displacement_std_1
    )
    np.testing.assert_allclose(after.rho, before.rho)


@pytest.mark.oracle
@pytest.mark.parametrize(
    "grounds", [[SLOW, FAST], [SLOW, SLOW], [SLOW, replace(SLOW, period=1.0001)]]
)
def test_covariances_of_linear_structures_add(grounds):
    parts = [sl.correlate(ONE, TWO, ground) for ground in grounds]
    whole = sl.correlate(ONE, TWO, sl.ParallelGround(grounds))
    for name in ("displacement_std_1", "displacement_std_2"):
        np.testing.assert_allclose(whole[name] ** 2, sum(p[name] ** 2 for p in parts), rtol=1e-9)
    shared = [p.rho * p.displacement_std_1 * p.displacement_std_2 for p in [whole, *parts]]
    np.testing.assert_allclose(shared[0], sum(shared[1:]), rtol=1e-8)


@pytest.mark.oracle
def test_moments_are_those_of_simulated_motions():
    table = sl.simulate([ONE, TWO], BOTH, paths=256, seed=3)
    exact = sl.correlate(ONE, TWO, BOTH)
    off = table.displacement_std - [exact.displacement_std_1, exact.displacement_std_2]
    assert (abs(off) < 4 * table.displacement_std_standard_error).all()
    assert abs(table.rho[0, 1] - exact.rho) < 4 * table.rho_standard_error[0, 1]


@pytest.mark.invariant
@pytest.mark.parametrize(
    ("grounds", "error", "message"),
    [
        ([SLOW], ValueError, "1 grounds; allowed: two or more"),
        ([SLOW, 3], TypeError, "grounds, number 2 = 3 is of the wrong kind; allowed: Clough"),
        (
            [SLOW, replace(FAST, period=np.ones(2))],
            ValueError,
            "number 2.*has an array; allowed: num",
        ),
        ([SLOW, sl.WhiteNoise()], ValueError, "white noise in parallel.*allowed: filtered grounds"),
    ],
)
def test_what_is_no_list_of_grounds_is_refused(grounds, error, message):
    with pytest.raises(error, match=message):
        sl.ParallelGround(grounds)
