"""Work of the hysteretic part from the virgin state, for every law, in random histories."""

import numpy as np
import pytest
import sympy
from cases import with_slow
from hypothesis import given
from hypothesis import strategies as st
from loops import by_steps, random_turns

import stochlin as sl
from stochlin.kernels.simulation.laws import BILINEAR
from stochlin.kernels.simulation.paths import FLAG, MODIFIED_CLOUGH

pytestmark = pytest.mark.invariant

LANES, PIECES = 170, 200  # histories of an example: in all 1e4 of each law; pieces of a leg
GIVEN = {"period": 0.5, "damping": 0.05, "yield_displacement": 0.02}
V, Z, E = sympy.symbols("v z e")


def numbers(low, high):
    return st.floats(low, high, allow_subnormal=False)


def structures(kind, **parameters):
    """Structures of a class with these parameters drawn."""
    return st.fixed_dictionaries(parameters).map(lambda drawn: kind(**GIVEN | drawn))


@st.composite
def backbones(draw):
    """Any first loading of the modified Clough law, with one branch or four."""
    alpha = draw(numbers(0.0, 0.3))
    drawn = {"hardening": alpha, "unloading_exponent": draw(numbers(0.0, 0.95))}
    if draw(st.booleans()):
        crack = draw(numbers(0.1, 0.9))
        drawn |= {"cracking": crack, "uncracked_stiffness": draw(numbers(1.0, 4.0))}
    if draw(st.booleans()):
        least = alpha / (1 - alpha) + 0.01
        drawn |= {"cap_ductility": draw(numbers(1.0, 6.0)), "softening": draw(numbers(least, 1.5))}
        drawn |= {"residual": draw(numbers(0.0, 0.9))}
    return sl.ModifiedClough(**GIVEN, **drawn)


def own_law(wear):
    """A law in symbols that becomes softer with the energy."""
    rates = {"z": (V - abs(V) * Z) / (1 + wear * E), "e": Z * V}
    return sl.Hysteretic(**GIVEN, hardening=0.05, law=rates)


ALPHA = {"hardening": numbers(-0.2, 0.5)}
DECAY = numbers(0.0, 0.1)
LAWS = {
    "bilinear": structures(sl.Bilinear, **ALPHA),
    "Bouc-Wen": st.tuples(numbers(0.02, 2.0), numbers(1.0, 3.0)).map(
        lambda drawn: sl.BoucWen(
            **GIVEN, hardening=0.1, beta=drawn[0], gamma=1 - drawn[0], exponent=drawn[1]
        )
    ),
    "Baber-Noori": structures(
        sl.BoucWenBaberNoori,
        **ALPHA,
        beta=numbers(0.05, 2.0),
        exponent=numbers(1.0, 3.0),
        strength_decay=DECAY,
        stiffness_decay=DECAY,
        pinching=numbers(0.0, 0.95),
        pinching_rate=numbers(0.1, 2.0),
        pinching_start=numbers(0.0, 0.3),
        pinching_width=numbers(0.05, 0.5),
        pinching_spread=DECAY,
        pinching_coupling=numbers(0.1, 1.0),
    ),
    "modified Clough": backbones(),
    "flag": structures(sl.Flag, **ALPHA, beta=numbers(0.0, 1.0)),
    "in symbols": st.sampled_from([0.0, 0.05]).map(own_law),
}


# Changes of the slope on a leg, of laws of straight branches; up to seven kinks, slopes from -2 to
# 4.
KINKS = {"bilinear": 5, "flag": 5, "modified Clough": 7 * 6}


@pytest.mark.parametrize("name", with_slow(LAWS, ("Baber-Noori",)))
@given(data=st.data(), seed=st.integers(0, 2**32), legs=st.integers(2, 12), size=numbers(0.5, 6.0))
def test_work_from_the_virgin_state_is_never_negative(name, data, seed, legs, size):
    """At any instant, to the error of the trapezoidal rule; and no law exceeds its strength."""
    structure = data.draw(LAWS[name])
    step = structure.step()
    turns = random_turns(seed, LANES, legs, size)
    law, own = (FLAG, [2.0]) if step == BILINEAR else (step, structure.law_parameters())
    reached, least = by_steps(law, turns, PIECES, [float(value) for value in own])
    # A kink within a piece changes the rule by an eighth of its square at most, times the change of
    # the slope.
    piece, kinks = np.abs(np.diff(turns, axis=0)) / PIECES, KINKS.get(name, 0)
    assert (least > -(kinks / 8) * (piece**2).sum(axis=0) - (0.0 if kinks else 1e-4)).all()
    assert (np.abs(reached[:, 0]) <= 1.0 + (1e-12 if kinks else 1e-6)).all()


@pytest.mark.parametrize(
    ("law", "own"), [(MODIFIED_CLOUGH, (0.5, 1, 1, 0, 9, 0, 0)), (FLAG, (0.6,))]
)
def test_an_extension_that_stays_changes_nothing(law, own):
    turns = np.array([0.0, 3.0, 3.0, -1.5, -1.5, 0.5, 0.5, 2.0, 2.0])[:, None]
    reached, _ = by_steps(law, turns, 1, own)
    np.testing.assert_array_equal(reached[2::2], reached[1::2])
