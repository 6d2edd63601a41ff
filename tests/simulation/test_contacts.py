"""Forces of contacts over a time step, against quadrature and what must hold for any element."""

from itertools import pairwise

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import example, given
from scipy.integrate import quad

from stochlin.kernels.simulation.contacts import (
    ForceLaw,
    force,
    law_table,
    mean_force,
    solve_force,
    stored_in,
)

pytestmark = pytest.mark.invariant

NOISE = 1e-9  # of means of steps over 1e-5 of a penetration and more: differences lose five digits
KINDS = {
    "spring": {},
    "tension": {},
    "no tension": {"tension": False},
    "approach only": {"approach_only": True},
    "over approach": {"over_approach": True},
}


def powers(low, high):
    """Numbers of any size between two powers of ten."""
    return st.floats(low, high).map(lambda power: 10.0**power)


@st.composite
def laws(draw):
    """Elements with exponents from 1 to 3, any damping, and its exponents 0, n - 1 and 1/4."""
    kind = draw(st.sampled_from(list(KINDS)))
    n = draw(st.sampled_from([1.0, 1.5, 2.0, 3.0]) | st.floats(1.0, 3.0))
    c = 0.0 if kind == "spring" else draw(st.just(0.0) | powers(-6, 3))
    own = [n - 1.0] if kind == "no tension" else [0.0, n - 1.0, 0.25]
    p = 0.0 if kind == "over approach" else draw(st.sampled_from(own))
    return law_table([ForceLaw(draw(powers(-1, 2)), n, c, p, **KINDS[kind])])[0]


speeds = st.just(0.0) | powers(-3, 1)
steps = powers(-3, 0)
places = st.just(0.0) | powers(-4, 0) | powers(-4, 0).map(lambda d: -d)
sizes = powers(-5, 0.5)


def steepest(law, v0, dt, deepest):
    """A bound of the slope of the mean force over the change, for penetrations up to the deepest.

    The mean of a function of the penetration has half its slope at most. The mean force of a
    dashpot is ``c/dt`` times the difference of an integral of ``d^p``, which has the slope ``d^p``
    at its end.
    """
    elastic = law.stiffness * law.exponent * deepest ** (law.exponent - 1)
    if law.over_approach:
        return elastic + (
            law.damping * law.stiffness * deepest**law.exponent / (v0 * dt) if v0 else 0.0
        )
    return elastic + law.damping * deepest**law.damping_exponent / dt


LETS_GO = law_table([ForceLaw(2.0, 1.5, 0.5, 0.5, tension=False)])[0]


@example(law=LETS_GO, v0=0.0, before=0.5, size=0.9, sign=-1, dt=0.5)
@given(law=laws(), v0=speeds, before=places, size=sizes, sign=st.sampled_from([1, -1]), dt=steps)
def test_mean_force_is_the_mean_of_the_force(law, v0, before, size, sign, dt):
    change = sign * size * max(abs(before), 1e-4)
    total, elastic = mean_force(law, v0, before, change, dt)
    v = change / dt
    kinks = [0.0, -law.damping * v / law.stiffness]
    inside = sorted(
        d for d in kinks if min(before, before + change) < d < max(before, before + change)
    )
    ends = [before, *(inside if change > 0 else inside[::-1]), before + change]
    for found, each in (
        (total, law),
        (elastic, law_table([ForceLaw(law.stiffness, law.exponent)])[0]),
    ):
        parts = [
            quad(lambda d, each=each: force(each, d, v, v0), *pair, epsabs=0, epsrel=1e-11)[0]
            for pair in pairwise(ends)
        ]
        largest = max(abs(force(each, d, v, v0)) for d in (before, before + change))
        assert found == pytest.approx(sum(parts) / change, rel=1e-7, abs=NOISE * largest)


@given(
    law=laws(),
    v0=speeds,
    before=places,
    share=powers(-15, 0.5),
    sign=st.sampled_from([1, -1]),
    dt=steps,
)
def test_elastic_work_is_the_change_of_the_stored_energy(law, v0, before, share, sign, dt):
    change = sign * share * max(abs(before), 1e-4)
    _, elastic = mean_force(law, v0, before, change, dt)
    one, two = stored_in(law, before), stored_in(law, before + change)
    assert elastic * change == pytest.approx(two - one, rel=0, abs=1e-14 * max(one, two))


@given(law=laws(), v0=speeds, before=places, size=sizes, dt=steps)
def test_mean_force_grows_with_the_change_and_has_no_jumps(law, v0, before, size, dt):
    """Also where contact begins or ends in the step, and where the rate changes its sign."""
    unit = max(abs(before), 1e-4)
    near = unit * np.array([1e-5, 1e-4, 1e-3, 1e-2])
    far = size * unit * np.linspace(0.05, 1, 20)
    let_go = -before / (1 + law.damping / (law.stiffness * dt)) if before > 0 else 0.0
    corners = (np.array([-before, let_go])[:, None] + np.append(near, -near)).ravel()
    changes = np.unique(np.concatenate([near, -near, far, -far, corners]))
    changes = changes[abs(changes) >= near[0]]
    found = np.array([mean_force(law, v0, before, change, dt)[0] for change in changes])
    rise, most = np.diff(found), np.maximum(abs(found[1:]), abs(found[:-1]))
    assert (rise >= -NOISE * most).all()
    slope = steepest(law, v0, dt, max(before, before + changes[-1], 0.0))
    assert (rise <= slope * np.diff(changes) + NOISE * most).all()


@given(
    law=laws(),
    v0=speeds,
    before=powers(-4, 0),
    share=powers(-17, -6),
    sign=st.sampled_from([1, -1]),
)
@example(law_table([ForceLaw(1.0, 1.0, 1.0, 0.0, tension=False)])[0], 1.0, 0.01, 1e-12, -1)
def test_mean_force_over_a_small_change_is_that_at_an_instant(law, v0, before, share, sign):
    """A contact at rest, or at its deepest, has such changes."""
    change, dt = sign * share * before, 1.0
    found, elastic = mean_force(law, v0, before, change, dt)
    exact = force(law, before + 0.5 * change, change / dt, v0)
    # the sum of the parts, either of which may be large, the other way than the spring
    size = abs(elastic) + abs(exact - elastic)
    assert found == pytest.approx(exact, rel=0, abs=NOISE * size)


@given(
    law=laws(),
    v0=speeds,
    before=places,
    size=sizes,
    sign=st.sampled_from([1, -1]),
    dt=steps,
    soft=powers(-2, 1),
)
@example(  # the contact ends within the step, so that the search goes to both ends many times
    law=law_table([ForceLaw(1.0, 1.5, 0.1, over_approach=True)])[0],
    v0=0.1,
    before=0.5,
    size=1.2,
    sign=-1,
    dt=0.01,
    soft=5.0,
)
def test_force_that_is_found_satisfies_its_equation(law, v0, before, size, sign, dt, soft):
    """For contacts as stiff as ten times what resists the step; steps of contacts are below 1."""
    alone = sign * size * max(abs(before), 1e-4)
    bound = mean_force(law, v0, before, alone, dt)[0]
    slope = steepest(law, v0, dt, max(before, before + alone, 1e-4))
    g = soft / slope
    found = solve_force(law, v0, before, alone, g, dt)
    rest = found - mean_force(law, v0, before, alone - g * found, dt)[0]
    assert abs(rest) <= NOISE * abs(bound)
    assert min(0.0, bound) <= found <= max(0.0, bound)


@given(law=laws(), v0=speeds, before=powers(-4, 0), size=sizes, dt=steps)
def test_there_is_no_force_without_contact(law, v0, before, size, dt):
    for change in (-size, 0.0, before * (1 - 1e-12)):
        assert mean_force(law, v0, -before, change, dt) == (0.0, 0.0)
        assert solve_force(law, v0, -before, change, 1.0, dt) == 0.0
