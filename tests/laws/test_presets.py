"""Laws with the parameters of tests on steel beams and on masonry infills, as the sources have them."""

import numpy as np
import pytest
import xarray as xr

import stochlin as sl

pytestmark = pytest.mark.oracle

STEEL = {"yield_rotation": 0.01, "web_slenderness": 45.0, "flange_slenderness": 6.5}
STEEL |= {"shear_span_ratio": 5.0, "depth": 0.6096, "yield_strength": 50 * 6.895e6}
FRAME = {"period": 1.2, "damping": 0.02, "yield_displacement": 0.09}
OF_ELASTIC = FRAME["yield_displacement"] * (2 * np.pi / FRAME["period"]) ** 2
REDUCED = {"unbraced_slenderness": 50.0}


def steel(**changed):
    return sl.BoucWenBaberNoori.of_steel_beams(**STEEL | FRAME | changed)


def equations(constant, *exponents, free=None):
    """Products of powers of the properties, with lengths in inches and stresses in ksi."""
    web, flange, span, deep, strong, unbraced = exponents
    logs = web * np.log(45) + flange * np.log(6.5) + span * np.log(5) + deep * np.log(25.4 * 24 / 533)
    logs += strong * np.log(6.895 * 50 / 355) + (unbraced * np.log(free) if free else 0.0)
    return constant * np.exp(logs)


@pytest.mark.parametrize(
    ("changed", "plastic", "energy"),
    [
        (
            {},
            (0.0865, -0.365, -0.14, 0.34, -0.721, -0.23, 0.0),
            (495.0, -1.34, -0.595, 0.0, 0.0, -0.36, 0.0),
        ),
        (
            REDUCED,
            (0.19, -0.314, -0.1, 0.113, -0.76, -0.07, -0.185),
            (585.0, -1.14, -0.632, 0.0, 0.0, -0.391, -0.205),
        ),
    ],
    ids=["other beams", "reduced sections"],
)
def test_steel_beams_have_the_moment_and_the_energy_of_the_equations(changed, plastic, energy):
    """Force at the cap of a sharp law without decay, and the energy at which decay would be complete."""
    free = changed.get("unbraced_slenderness")
    at_cap = 1 + equations(*plastic, free=free) / 0.01
    whole = steel(**changed, exponent=60.0, strength_decay=0.0, stiffness_decay=0.0)
    loop = sl.hysteresis_loop(whole, [0.09, at_cap * 0.09], refine=400)
    assert float(loop.force_per_mass[-1]) / OF_ELASTIC == pytest.approx(1.1, rel=1e-6)
    wearing = steel(**changed)
    capacity = equations(*energy, free=free) / (0.01 * (1 - wearing.hardening))
    assert wearing.stiffness_decay == pytest.approx(1 / capacity, rel=1e-12)
    assert wearing.strength_decay == pytest.approx(2 / capacity, rel=1e-12)


def test_strength_of_steel_beams_falls_with_the_energy_as_by_the_rule_of_the_equations():
    """In cycles of equal size each excursion takes its share of what is left: 1 - E/E_t, at first."""
    structure = steel()
    turns = np.resize([4 * 0.09, -4 * 0.09], 12)
    loop = sl.hysteresis_loop(structure, turns, refine=200)
    z, moved = loop.z.to_numpy(), np.diff(loop.displacement) / 0.09
    work = np.concatenate([[0.0], np.cumsum(0.5 * (z[1:] + z[:-1]) * moved)])
    peaks = np.arange(200, z.size, 400)  # of the positive side
    spent = work[peaks] * structure.stiffness_decay  # E/E_t
    strength = np.abs(z[peaks])
    assert spent[2] < 0.25
    assert spent[-1] > 0.4
    first = strength[:3] - (1 - spent[:3])
    assert (np.abs(first) < 0.01 + 1.5 * spent[:3] ** 2).all()  # to the second term of its series
    np.testing.assert_allclose(strength, (1 + 2 * spent) ** -0.5, atol=0.02)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"yield_strength": 355.0}, "yield_strength = 355 is out of range; .*355e6 for 355 MPa"),
        ({"depth": 24.0}, r"depth = 24 is out of range; allowed: 0.1 <= value <= 0.92"),
        ({"web_slenderness": 60.0}, "web_slenderness = 60 is out of range; allowed: 20 <= value <= 55"),
        ({"unbraced_slenderness": 5.0}, "unbraced_slenderness = 5 is out of range"),
        ({"exponent": 0.5}, "exponent = 0.5 is out of range; allowed: 1 <= value"),
    ],
    ids=str,
)
def test_steel_beams_out_of_the_range_of_the_tests_are_refused(changed, message):
    with pytest.raises(ValueError, match=message):
        steel(**changed)


def test_steel_beams_may_be_uncertain_or_many():
    scattered = steel(depth=sl.Uncertain(STEEL["depth"], 0.1))
    assert scattered.median() == steel()
    many = steel(depth=[STEEL["depth"], 0.8], exponent=[2.0, 3.0])
    assert many.hardening[0] == steel().hardening < many.hardening[1]
    assert many.strength_decay[1] == pytest.approx(3 * many.stiffness_decay[1])


def infilled(share, **changed):
    return sl.ModifiedClough.of_masonry_infill(
        **{"frame_share": share, "period": 0.4, "damping": 0.05, "yield_displacement": 0.01} | changed
    )


@pytest.mark.parametrize("share", [0.05, 0.4])
def test_infills_crack_and_fail_beside_their_frame(share):
    """Forces over that of frame and infill at the largest force of the infill."""
    loop = sl.hysteresis_loop(infilled(share), [0.002, 0.01, 0.05, 0.09, 0.12], refine=1)
    force = loop.force_per_mass.to_numpy() / (0.01 * (2 * np.pi / 0.4) ** 2)
    strut = 0.8 * (1 - share)  # the stiffness of the infill is 2.8, 0.8 and -0.1 times this over 0.8
    infill = np.array([0.0, 2.8 / 0.8 * 0.2, 1.0, 1 - 4 * 0.1 / 0.8, 0.0, 0.0]) * strut / 0.8
    frame = share * np.array([0.0, 0.2, 1.0, 5.0, 9.0, 12.0])
    np.testing.assert_allclose(force, frame + infill, rtol=1e-12, atol=1e-15)


def test_small_motions_of_infilled_frames_have_the_period_that_their_docstring_states():
    structure = infilled(0.3, damping=1e-6)
    pulse = xr.DataArray(np.r_[1e-4, np.zeros(4000)], coords={"time": 0.001 * np.arange(4001)})
    u = sl.respond(structure, pulse).displacement.squeeze().to_numpy()
    crossings = np.flatnonzero((u[:-1] < 0) & (u[1:] >= 0))
    period = 0.001 * np.diff(crossings).mean()
    assert period == pytest.approx(0.4 / np.sqrt(3.5 - 2.5 * 0.3), rel=1e-3)


def test_infills_may_be_many_and_their_share_is_checked():
    many = infilled([0.1, 0.5])
    assert many.hardening.to_numpy().tolist() == [0.1, 0.5]
    assert bool(many.valid().all())
    with pytest.raises(
        ValueError, match=r"frame_share = 1 is out of range; .*a bare frame has no infill"
    ):
        infilled(1.0)


def test_storeys_take_the_parameters_of_a_preset():
    part = infilled(0.2)
    own = {name: value for name, value in part.cells().items() if name in part.own_parameters()}
    parts = [1e5] * 2, [4e7] * 2, [3.0] * 2, 0.05
    house = sl.ShearBuilding(*parts, part.hardening, 0.008, law="modified_clough", law_parameters=own)
    assert house.oscillator().cap_ductility == 1.0
