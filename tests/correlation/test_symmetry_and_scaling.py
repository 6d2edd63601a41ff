"""What must hold for any two structures on any ground, whatever the numbers are."""

import cases
import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

import stochlin as sl

pytestmark = pytest.mark.invariant


def spread(limits):
    """Numbers between the limits, their logarithm uniform, with the limits themselves."""
    low, high = np.log(limits)
    return st.floats(0, 1).map(lambda share: float(np.exp(low + share * (high - low))))


@st.composite
def structures(draw, domain=cases.BEYOND):
    values = {key: draw(spread(domain[key])) for key in ("period", "damping", "hardening")}
    return values | {"reduction_factor": 3 * draw(spread(domain["strength_ratio"]))}


@st.composite
def grounds(draw):
    kind = draw(st.sampled_from([sl.WhiteNoise, sl.KanaiTajimi, sl.CloughPenzien]))
    values = {"intensity": draw(spread((1e-3, 1e2)))}
    if kind is not sl.WhiteNoise:
        values |= {"period": draw(spread((0.1, 5.0))), "damping": draw(spread((0.005, 0.9)))}
    if kind is sl.CloughPenzien:
        values |= {"high_pass_period": draw(spread((1.0, 50.0)))}
        values |= {"high_pass_damping": draw(spread((0.05, 1.5)))}
    return kind, values


def rho(first, second, ground):
    kind, values = ground
    return float(sl.correlate(sl.Bilinear(**first), sl.Bilinear(**second), kind(**values)).rho)


@given(structures(), grounds())
def test_identical_structures_move_as_one(structure, ground):
    assert rho(structure, structure, ground) == 1


@given(structures(), structures(), grounds())
def test_exchanging_the_structures_changes_nothing(first, second, ground):
    assert rho(first, second, ground) == rho(second, first, ground)


@given(structures(), structures(), grounds())
def test_correlation_is_between_minus_one_and_one(first, second, ground):
    assert abs(rho(first, second, ground)) <= 1


@given(structures(), structures(), grounds(), spread((1e-3, 1e3)))
def test_a_common_scale_of_time_changes_nothing(first, second, ground, scale):
    slower = [one | {"period": one["period"] * scale} for one in (first, second)]
    kind, values = ground
    periods = {key: value * scale for key, value in values.items() if key.endswith("period")}
    expected = rho(first, second, ground)
    assert rho(*slower, (kind, values | periods)) == pytest.approx(expected, abs=1e-9)


@pytest.mark.filterwarnings("ignore::stochlin.messages.DoubtfulInput")  # hardly yields
@given(structures(), grounds(), spread((1e-6, 1e6)))
def test_response_scales_with_the_strength_when_intensity_does(structure, ground, scale):
    kind, values = ground
    reference = sl.linearize(sl.Bilinear(**structure), kind(**values))
    del structure["reduction_factor"]
    strength = {"yield_displacement": float(reference.yield_displacement) * np.sqrt(scale)}
    stronger = kind(**values | {"intensity": values["intensity"] * scale})
    table = sl.linearize(sl.Bilinear(**structure, **strength), stronger)
    assert float(table.ductility_std) == pytest.approx(float(reference.ductility_std), rel=1e-8)
    assert float(table.k_eq) == pytest.approx(float(reference.k_eq), rel=1e-7, abs=1e-300)


@pytest.mark.filterwarnings("ignore::stochlin.messages.DoubtfulInput")  # hardly yields
@given(structures(), grounds(), spread((0.5, 6.0)))
def test_reduction_factor_is_a_strength_by_definition(structure, ground, peak_factor):
    """``uy = p sigma_el / R``, worked out by hand from the elastic response."""
    kind, values = ground
    reduced = sl.Bilinear(**structure, peak_factor=peak_factor)
    factor = structure.pop("reduction_factor")
    elastic = sl.linearize(sl.Bilinear(structure["period"], structure["damping"]), kind(**values))
    strength = peak_factor * float(elastic.displacement_std) / factor
    given_strength = sl.Bilinear(**structure, yield_displacement=strength)
    one, other = (sl.linearize(s, kind(**values)) for s in (reduced, given_strength))
    assert float(one.yield_displacement) == pytest.approx(strength, rel=1e-12)
    assert float(one.displacement_std) == pytest.approx(float(other.displacement_std), rel=1e-9)


@given(
    structures(cases.PRACTICE), structures(cases.PRACTICE), spread((0.15, 4.0)), spread((0.03, 0.8))
)
def test_clough_penzien_ground_without_its_high_pass_is_kanai_tajimi(
    first, second, period, damping
):
    """A high-pass below all motion; drift frequencies of the structures are some 1e-3 rad/s."""
    soil = {"period": period, "damping": damping}
    high_pass = {"high_pass_period": 1e9, "high_pass_damping": 0.7}
    expected = rho(first, second, (sl.KanaiTajimi, soil))
    assert rho(first, second, (sl.CloughPenzien, soil | high_pass)) == pytest.approx(
        expected, abs=1e-5
    )


@given(structures(cases.PRACTICE), structures(cases.PRACTICE), grounds())
def test_vanishing_reduction_factor_reaches_the_elastic_value_smoothly(first, second, ground):
    """No jump where the third state is dropped: each step of R changes rho by a small amount."""
    kind, values = ground
    factor = xr.DataArray(np.geomspace(1e-3, 1.0, 400), dims="factor")
    pair = [sl.Bilinear(**one | {"reduction_factor": factor}) for one in (first, second)]
    table = sl.correlate(*pair, kind(**values))
    elastic = [sl.Bilinear(one["period"], one["damping"]) for one in (first, second)]
    expected = float(sl.correlate(*elastic, kind(**values)).rho)
    limit = table.status.values == 1
    assert limit[0]
    assert not limit[-1]
    assert (np.diff(limit.astype(int)) <= 0).all()  # one switch, from elastic to yielding
    np.testing.assert_allclose(table.rho.values[limit], expected, rtol=0, atol=1e-14)
    first_yielding = int(limit.sum())
    assert float(table.rho[first_yielding]) == pytest.approx(expected, abs=1e-11)
    # R grows by 1.7 % a step: rho follows it, at a rate that yielding lends it.
    assert float(np.abs(np.diff(table.rho)).max()) < 0.05


@given(structures(), structures(), grounds(), st.sampled_from([sl.Bilinear, sl.BoucWen]))
def test_full_hardening_is_elastic(first, second, ground, law):
    """With hardening 1 the hysteretic force has no share: slip has no effect."""
    kind, values = ground
    pair = [law(**one | {"hardening": 1.0}) for one in (first, second)]
    elastic = [sl.Bilinear(one["period"], one["damping"]) for one in (first, second)]
    expected = float(sl.correlate(*elastic, kind(**values)).rho)
    assert float(sl.correlate(*pair, kind(**values)).rho) == pytest.approx(expected, abs=1e-9)
