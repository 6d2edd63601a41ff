"""Laws that make work, or stiffen, are doubted in words; laws of the literature never are."""

import numpy as np
import pytest
import sympy

import stochlin as sl
from stochlin.messages import DoubtfulInput
from stochlin.models.laws.baber_noori import symbolic as baber_noori
from stochlin.models.laws.bouc_wen import symbolic as bouc_wen
from stochlin.models.symbolic import compiled

pytestmark = pytest.mark.invariant

v, z, e = sympy.symbols("v z e")
RNG = np.random.default_rng(11)
SETS = 10


def law(rates):
    return sl.Hysteretic(1.0, 0.05, 0.1, yield_displacement=0.02, law=rates)


def draw(**ranges):
    return np.array([RNG.uniform(*ends, SETS) for ends in ranges.values()])


def test_bouc_wen_laws_are_not_doubted():
    beta, exponent = draw(beta=(0.5, 1.0), exponent=(1.0, 6.0))
    compiled(bouc_wen(), ("beta", "gamma", "exponent")).doubt(np.array([beta, 1 - beta, exponent]))


def test_laws_that_degrade_and_pinch_are_not_doubted():
    names = sl.BoucWenBaberNoori(1.0, 0.05).own_parameters()
    ranges = {
        "beta": (0.5, 1.0),
        "exponent": (1.0, 4.0),
        "strength_decay": (0.0, 0.1),
        "stiffness_decay": (0.0, 0.2),
        "pinching": (0.0, 0.95),
        "pinching_rate": (0.1, 2.0),
        "pinching_start": (0.0, 0.3),
        "pinching_width": (0.1, 0.5),
        "pinching_spread": (0.0, 0.05),
        "pinching_coupling": (0.1, 0.8),
    }
    assert tuple(ranges) == tuple(names)
    compiled(baber_noori(), names).doubt(draw(**ranges))


@pytest.mark.parametrize(
    "rates",
    [
        v - abs(v) * z,
        v
        * (
            1
            - sympy.Heaviside(z - 1) * sympy.Heaviside(v)
            - sympy.Heaviside(-z - 1) * sympy.Heaviside(-v)
        ),
        sympy.Piecewise((v, abs(z) < 1), (0.2 * v, True)),  # softening, and elastic
        {"z": (v - abs(v) * z) / (1 + 0.05 * e), "e": z * v},
    ],
    ids=str,
)
def test_good_laws_are_not_doubted(rates):
    law(rates)


@pytest.mark.parametrize(
    ("rates", "doubt"),
    [
        (
            -v,
            "z has given back more work than it took .*allowed: at each z a rate in unloading not below",
        ),
        # It unloads along a softer branch than it loads, around its loops the wrong way.
        (v * (1 - 0.5 * sympy.Heaviside(-v * z)), "z has given back more work than it took"),
        (
            {"z": (1 + 0.3 * e) * (v - abs(v) * z), "e": z * v},
            "z grows faster in loading .*allowed: a rate up to v",
        ),
        ({"z": v - abs(v) * z, "e": abs(v) * e + abs(v) * sympy.exp(40 * e)}, "no longer finite|faster"),
    ],
    ids=str,
)
def test_laws_that_make_work_or_stiffen_are_named(rates, doubt):
    with pytest.warns(DoubtfulInput, match=doubt):
        law(rates)
