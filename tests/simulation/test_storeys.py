"""Floors on storeys in simulated motions: limits, invariance, another integrator, printed values."""

import functools

import numpy as np
import pytest
import scipy.linalg
import sympy

import stochlin as sl
from stochlin.kernels.simulation.stepping import LANES
from stochlin.models.systems import arrangement_of, shares_at, stack_of
from stochlin.solver.simulation.connected_structures import stepped_groups
from stochlin.solver.simulation.structures_in_motion import meeting_heights

pytestmark = pytest.mark.oracle

FIRM = sl.KanaiTajimi(2 * np.pi / 15, 0.6, 0.02)
V, Z = sympy.symbols("v z")
SMOOTH = V - sympy.Abs(V) * Z
LAWS = {
    "elastic": {},
    "bilinear": {"hardening": 0.1, "yield_drifts": 0.01},
    "bouc_wen": {"hardening": 0.1, "yield_drifts": 0.01, "law": "bouc_wen"},
    "sympy": {"hardening": 0.1, "yield_drifts": 0.01, "law": SMOOTH},
}


def four(**changes):
    usual = {"hardening": 0.05, "yield_drifts": [0.010, 0.010, 0.009, 0.008]}
    stiffnesses = np.array([4, 3.6, 3, 2.2]) * 1e8
    return sl.ShearBuilding([2e5, 2e5, 2e5, 1.5e5], stiffnesses, [3.0] * 4, 0.05, **(usual | changes))


def two(**changes):
    usual = {"hardening": 0.1, "yield_drifts": 0.006}
    return sl.ShearBuilding([1.5e5] * 2, [2.5e8, 2e8], [3.0] * 2, 0.05, **(usual | changes))


def single(law):
    """A building of one storey and the oscillator that it is."""
    mass, period = 3e5, 0.5
    building = sl.ShearBuilding([mass], [mass * (2 * np.pi / period) ** 2], [3.0], 0.05, **LAWS[law])
    return building, building.oscillator()


@pytest.mark.parametrize("law", LAWS)
def test_a_building_of_one_storey_is_an_oscillator(law):
    building, oscillator = single(law)
    other = sl.Bilinear(0.8, 0.03)
    finite = {"paths": 64, "duration": 12.0, "seed": 5}
    one, same = (sl.simulate([each, other], FIRM, **finite) for each in (building, oscillator))
    scale = float(same.peak.max())
    np.testing.assert_allclose(one.peak.values, same.peak.values, rtol=0, atol=1e-9 * scale)
    np.testing.assert_allclose(one.separation, same.separation, rtol=0, atol=1e-9 * scale)
    np.testing.assert_allclose(
        one.peak_drift[:, 0].values, same.peak[:, 0].values, rtol=0, atol=1e-9 * scale
    )


def test_elastic_floors_have_the_variance_of_their_modes():
    building = four(yield_drifts=None, hardening=None)
    table = sl.simulate([building], sl.WhiteNoise(0.01), paths=256, seed=2)
    mass, (w, shapes) = building.masses.values, building._modes()
    share = shapes * (mass @ shapes)
    modes = [sl.Bilinear(2 * np.pi / each, 0.05) for each in w]
    covariance = np.zeros((4, 4))
    for m, one in enumerate(modes):
        for n, other in enumerate(modes):
            pair = sl.correlate(one, other, sl.WhiteNoise(0.01))
            product = float(pair.rho * pair.displacement_std_1 * pair.displacement_std_2)
            covariance += product * np.outer(share[:, m], share[:, n])
    off = table.displacement_std.values - np.sqrt(np.diag(covariance))
    assert (np.abs(off) < 4 * table.displacement_std_standard_error.values).all()


LINKS = {
    "none": [],
    "spring": [sl.Link(5e7, 2e6, floors=(2, 2))],
    "yielding": [sl.Link(8e7, 1e5, hardening=0.05, yield_displacement=0.004, floors=(3, 2))],
}


def springs_of(system):
    """Each storey and link: its extension by the floors, stiffnesses, limit of ``z``, dashpot."""
    drifts, ties = system.drifts, system.ties
    links = [tie.link for tie in ties]
    along = np.concatenate([drifts, np.zeros((len(ties), len(drifts)))])
    for row, tie in zip(along[len(drifts) :], ties, strict=True):
        row[[tie.floor, tie.other]] = 1, -1
    share = np.array([link.hardening if link.yields else 1.0 for link in links])
    stiffness = [link.stiffness for link in links]
    post = np.append(system.storeys.post, stiffness * share)
    couple = np.append(system.storeys.couple, stiffness * (1 - share))
    limit = np.append(system.storeys.strength, [x.yield_displacement or np.inf for x in links])
    return (
        along,
        post,
        couple,
        limit,
        np.append(np.zeros(len(drifts)), [x.damping_constant for x in links]),
    )


def solved(system, force, seconds, steps):
    """Displacements of the floors after each step (steps, n), by the equations of motion in floors.

    Within a step no spring begins or ceases to slide: the motion is that of a linear system, and exact
    but for the force, which is that of the middle. ``z`` follows its drift, or stays.
    """
    along, post, couple, limit, dashpot = springs_of(system)
    pull, dt = along.T / system.storeys.mass[:, None], seconds / steps
    s, n = along.shape
    u, v, z = slice(n), slice(n, 2 * n), slice(2 * n, 2 * n + s)
    damping = system.storeys.damping / system.storeys.mass[:, None] + pull @ (dashpot[:, None] * along)

    @functools.cache
    def transition(modes):
        slides, rates = np.frombuffer(modes, dtype=bool), np.zeros((2 * n + s + 1,) * 2)
        rates[u, v], rates[v, v], rates[v, u] = np.eye(n), -damping, -pull @ (post[:, None] * along)
        rates[z, v], rates[v, z] = np.where(slides[:, None], 0.0, along), -pull * couple
        rates[v, -1] = 1
        return scipy.linalg.expm(rates * dt)

    x, found = np.zeros(2 * n + s + 1), np.empty((steps, n))
    for step, f in enumerate(force(dt * (np.arange(steps) + 0.5))):
        x[-1] = f
        slides = (np.abs(x[z]) >= limit) & (along @ x[v] * x[z] > 0)
        x = transition(slides.tobytes()) @ x
        x[z] = np.clip(x[z], -limit, limit)
        found[step] = x[u]
    return found


@pytest.mark.parametrize(("links", "p_delta"), [("none", True), ("spring", False), ("yielding", True)])
def test_motion_is_that_of_linear_stretches(links, p_delta):
    system = arrangement_of([four(p_delta=p_delta), two()], LINKS[links])
    n, seconds = 6, 1.6

    def force(t):
        return 9 * np.sin(11 * t) * np.sin(2 * t)

    theirs = solved(system, force, seconds, 32000).T
    drift = system.drifts @ theirs
    assert (np.abs(drift).max(axis=1) / system.storeys.strength).max() > 2
    frames = stepped_groups(system)
    assert len(frames) == (1 if system.ties else 2)
    errors = []
    for steps in (800, 1600):
        dt = seconds / steps
        middle = dt * (np.arange(steps) + 0.5)
        f = np.repeat(force(middle)[:, None], LANES, axis=1)
        found = np.empty(n)
        for frame in frames:
            part = frame.part
            out = np.empty((1, part.size, LANES))
            part.block(dt)(f, part.at_rest(), steps, out)
            assert (out == out[..., :1]).all()  # equal motions, equal answers
            found[frame.watched] = out[0, :, 0]
        errors.append(np.abs(found - theirs[:, -1]).max() / np.abs(theirs).max())
    assert errors[1] < 2e-4
    assert errors[1] < 0.4 * errors[0] or errors[1] < 1e-5


def test_a_storey_that_its_weight_leaves_no_hardening_has_no_stationary_answer():
    soft = {"masses": [4e5] * 2, "stiffnesses": [4e7] * 2, "heights": [3.0] * 2, "damping": 0.05}
    building = sl.ShearBuilding(**soft, hardening=0.05, yield_drifts=0.02, p_delta=True)
    with pytest.raises(ValueError, match=r"storey 1 has no stiffness after yielding.*with a duration"):
        sl.simulate([building], FIRM)
    without = sl.ShearBuilding(**soft, hardening=0.05, yield_drifts=0.02)
    with_weight, plain = (sl.simulate([b], FIRM, paths=128, duration=30.0) for b in (building, without))
    drifts = (table.peak_drift.median("path")[0] for table in (with_weight, plain))
    assert float(next(drifts)) > 1.05 * float(next(drifts))  # in most motions it falls
    fallen = np.isposinf(with_weight.peak_drift).all("element")
    assert 0 < float(fallen.mean()) == float(with_weight.collapse_probability[0]) < 1
    assert "collapse_probability" not in plain


def test_between_floors_nothing_is_larger_than_at_the_levels_of_both():
    low = stack_of(two())
    high = stack_of(sl.ShearBuilding([1e5] * 5, [1e8] * 5, [2.2] * 5, 0.05))
    heights = meeting_heights(low, high)
    np.testing.assert_allclose(heights, [2.2, 3.0, 4.4, 6.0])
    rng = np.random.default_rng(8)
    for _ in range(50):
        motions = [rng.standard_normal(stack.system.mass.size) for stack in (low, high)]

        def apart(height, motions=motions):
            one, other = (
                shares_at(stack.levels, height) @ motion
                for stack, motion in zip((low, high), motions, strict=True)
            )
            return one - other

        dense = max(apart(height) for height in np.linspace(1e-6, 6.0, 400))
        assert dense <= max(0.0, *map(apart, heights)) + 1e-12


def test_laws_in_one_frame_are_each_their_own():
    """Linked by nothing, a building of another law moves as it does alone."""
    pair = [four(law=SMOOTH), two(law="bouc_wen", law_parameters={"beta": 0.6, "gamma": -0.1})]
    usual = {"paths": 32, "duration": 6.0, "seed": 2}
    free, linked = (
        sl.simulate(pair, FIRM, link=link, **usual) for link in (None, sl.Link(0.0, floors=(2, 2)))
    )
    np.testing.assert_allclose(free.peak, linked.peak, rtol=1e-6)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            {"link": sl.Link(1e6, floors=(9, 1))},
            r"floors = \(9, 1\), structure 1 has 4; allowed: 1 to 4",
        ),
        ({"link": sl.Link(1e6, structures=(1, 3))}, "ties the structures 1 and 3 of 2"),
        ({"link": [sl.Link(1e6)] * 2}, "2 given; allowed: one between each two"),
        ({"duration": 0.1}, "shorter than the period of"),
    ],
)
def test_what_does_not_fit_together_is_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        sl.simulate([four(), two()], FIRM, paths=32, **arguments)
