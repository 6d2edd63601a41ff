"""Shear buildings, links, and both as one system: against closed forms, and what is refused."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st

import stochlin as sl
from stochlin.models.buildings.base import GRAVITY
from stochlin.models.links import Link
from stochlin.models.systems import (
    assembly_of,
    check_links,
    check_stationary,
    common_floors,
    slabs_on_columns,
    stick_model_of,
)

pytestmark = pytest.mark.invariant

V = sympy.Symbol("v")
TWO = {"masses": [1e5] * 2, "stiffnesses": [1e8] * 2, "heights": [3.0] * 2, "damping": 0.05}
STRENGTH = {"hardening": 0.1, "yield_drifts": 0.01}
KNOWN = {"period": 0.8, "storeys": 4, "storey_height": 3.0, "mass": 4e5, "damping": 0.05}
YIELDING = KNOWN | {"hardening": 0.1, "base_shear_coefficient": 0.15}

numbers = st.integers(1, 12)


def uniform(storeys: int, mass: float, stiffness: float, **others: Any) -> sl.ShearBuilding:
    heights = [3.0] * storeys
    return sl.ShearBuilding([mass] * storeys, [stiffness] * storeys, heights, 0.05, **others)


def frequencies(storeys: int, mass: float, stiffness: float) -> np.ndarray:
    """Of a uniform shear building, in closed form."""
    mode = np.arange(1, storeys + 1)
    return 2 * np.sqrt(stiffness / mass) * np.sin((2 * mode - 1) * np.pi / (4 * storeys + 2))


def drifts(storeys: int) -> np.ndarray:
    return np.eye(storeys) - np.eye(storeys, k=-1)


def stiffness_of(building: sl.ShearBuilding) -> np.ndarray:
    """The matrix, written out."""
    t = drifts(building.storeys)
    k = building.arrays()["stiffnesses"].to_numpy() - building.geometric_stiffness()
    return t.T @ np.diag(k) @ t


@st.composite
def buildings(draw: st.DrawFn, **others: Any) -> sl.ShearBuilding:
    storeys = draw(numbers)

    def several(low: float, high: float) -> list[float]:
        return draw(st.lists(st.floats(low, high), min_size=storeys, max_size=storeys))

    given = {"hardening": draw(st.floats(0.01, 1)), "yield_drifts": several(1e-3, 0.1)}
    return sl.ShearBuilding(
        several(1e4, 1e6),
        several(1e7, 1e9),
        several(2.5, 6),
        draw(st.floats(0.01, 0.3)),
        **given,
        **others,
    )


# --- Modes and damping
# --------------------------------------------------------------------------------


@given(numbers, st.floats(1e3, 1e7), st.floats(1e6, 1e10))
def test_periods_of_a_uniform_shear_building(storeys: int, mass: float, stiffness: float) -> None:
    building = uniform(storeys, mass, stiffness)
    w = frequencies(storeys, mass, stiffness)
    np.testing.assert_allclose(building.periods(), 2 * np.pi / w, rtol=1e-9)
    damping, shapes = building.damping_matrix(), building._modes()[1]
    np.testing.assert_allclose(
        shapes.T @ damping @ shapes, np.diag(2 * 0.05 * w), rtol=0, atol=1e-10 * w[-1]
    )


@given(buildings(), st.data())
def test_a_damper_takes_its_power_from_its_own_storey(
    building: sl.ShearBuilding, data: Any
) -> None:
    n = building.storeys
    constants = np.array(data.draw(st.lists(st.floats(0, 1e7), min_size=n, max_size=n)))
    velocity = np.array(data.draw(st.lists(st.floats(-1, 1), min_size=n, max_size=n)))
    with_them = sl.ShearBuilding(
        *(building.arrays()[key] for key in ("masses", "stiffnesses", "heights")),
        building.damping,
        dampers=constants,
    )
    bare = building.damping_matrix()
    added = with_them.damping_matrix() - bare
    power = (constants * np.diff(velocity, prepend=0.0) ** 2).sum()
    assert velocity @ added @ velocity == pytest.approx(
        power, rel=1e-9, abs=1e-9 * np.abs(bare).max()
    )


# --- The weight
# ---------------------------------------------------------------------------------------


def test_each_storey_loses_the_weight_above_over_its_height() -> None:
    heights = np.array([4.0, 3.0, 3.5])
    given = [2e5, 1e5, 6e4], [1e8] * 3, heights
    building = sl.ShearBuilding(*given, 0.05, p_delta=True)
    lost = GRAVITY * np.array([3.6e5, 1.6e5, 6e4]) / heights
    np.testing.assert_allclose(building.geometric_stiffness(), lost, rtol=1e-14)
    assert not sl.ShearBuilding(*given, 0.05).geometric_stiffness().any()
    mass = np.diag(building.masses.to_numpy())
    squares = np.sort(np.linalg.eigvals(np.linalg.solve(mass, stiffness_of(building))).real)
    np.testing.assert_allclose((2 * np.pi / building.periods()) ** 2, squares, rtol=1e-12)


def test_the_weight_may_eat_the_hardening_but_not_the_stiffness() -> None:
    """A motion goes on, but nothing is stationary: the system names the storeys."""
    lost = 2e5 * GRAVITY / 3.0  # of the first of two storeys
    weak = sl.ShearBuilding(**TWO, **STRENGTH | {"hardening": 0.9 * lost / 1e8}, p_delta=True)
    stiff = sl.ShearBuilding(**TWO, **STRENGTH | {"hardening": 1.1 * lost / 1e8}, p_delta=True)
    with pytest.raises(ValueError, match="number 2: storey 1 has no stiffness after yielding"):
        check_stationary(assembly_of([stiff, weak]))
    assert stick_model_of(weak).system.post[0] == pytest.approx(-0.1 * lost, rel=1e-9)
    elastic = sl.ShearBuilding(**TWO, p_delta=True)
    check_stationary(assembly_of([elastic]))


# --- Regular buildings
# --------------------------------------------------------------------------------


@st.composite
def regular(draw: st.DrawFn) -> tuple[sl.ShearBuilding, dict[str, float]]:
    storeys = draw(st.integers(1, 60))
    height = st.floats(2.5, 6)
    heights = st.one_of(height, st.lists(height, min_size=storeys, max_size=storeys))
    known = {
        "period": draw(st.floats(0.05, 5)),
        "mass": draw(st.floats(1e3, 1e7)),
        "base_shear_coefficient": draw(st.floats(0.01, 1)),
    }
    building = sl.ShearBuilding.regular(
        **known, storeys=storeys, storey_height=draw(heights), damping=0.05, hardening=0.1
    )
    return building, known


@given(regular())
def test_a_regular_building_is_what_it_was_told(
    given: tuple[sl.ShearBuilding, dict[str, float]],
) -> None:
    building, known = given
    assert float(building.periods()[0]) == pytest.approx(known["period"], rel=1e-9)
    straight = building.participation().to_numpy() / building.levels()
    np.testing.assert_allclose(straight, straight[-1], rtol=1e-8)
    # Forces that grow with the height make all storeys yield at once, at this base shear.
    forces = building.levels() / building.levels().sum()
    weight = GRAVITY * known["mass"] * building.storeys
    shear = known["base_shear_coefficient"] * weight * forces[::-1].cumsum()[::-1]
    drift = np.linalg.solve(
        stiffness_of(building), known["base_shear_coefficient"] * weight * forces
    )
    np.testing.assert_allclose(
        np.diff(drift, prepend=0), building.arrays()["yield_drifts"], rtol=1e-9
    )
    at_yield = (building.stiffnesses * building.yield_drifts).to_numpy()
    np.testing.assert_allclose(at_yield, shear, rtol=1e-12)


# --- The first mode
# -----------------------------------------------------------------------------------


@given(buildings())
def test_effective_masses_of_all_modes_are_the_mass(building: sl.ShearBuilding) -> None:
    mass = building.masses.to_numpy()
    shapes = building._modes()[1]
    effective = (mass @ shapes) ** 2
    assert effective.sum() == pytest.approx(mass.sum(), rel=1e-10)
    first = building.oscillator()
    assert first.mass == pytest.approx(effective[0], rel=1e-12)
    assert first.period == float(building.periods()[0])
    assert first.damping == building.damping
    moves = building.participation().to_numpy()
    assert mass @ moves**2 == pytest.approx(first.mass, rel=1e-9)  # the same kinetic energy
    ratio = np.abs(np.diff(moves, prepend=0.0)) * first.yield_displacement
    assert (ratio / building.yield_drifts).max() == pytest.approx(1, rel=1e-12)


@given(st.floats(1e4, 1e6), st.floats(1e7, 1e9), st.floats(0.01, 0.3), st.floats(1e-3, 0.1))
def test_one_storey_is_the_oscillator(
    mass: float, stiffness: float, damping: float, drift: float
) -> None:
    own = {"beta": 0.7, "gamma": 0.2, "exponent": 2.0}
    building = sl.ShearBuilding(
        [mass], [stiffness], [3.0], damping, 0.1, drift, law="bouc_wen", law_parameters=own
    )
    found = building.oscillator()
    period = 2 * np.pi * np.sqrt(mass / stiffness)
    assert isinstance(found, sl.BoucWen)
    assert {name: getattr(found, name) for name in own} == own
    assert (found.damping, found.hardening) == (damping, 0.1)
    assert found.period == pytest.approx(period, rel=1e-14)
    assert found.mass == pytest.approx(mass, rel=1e-14)
    assert found.yield_displacement == pytest.approx(drift, rel=1e-14)
    np.testing.assert_allclose(building.participation(), [1.0], rtol=1e-14)
    one, other = stick_model_of(building), stick_model_of(found)
    np.testing.assert_allclose(one.law_parameters, other.law_parameters, rtol=1e-13)
    for here, there in zip(one.system, other.system, strict=True):
        np.testing.assert_allclose(here, there, rtol=1e-13)


# --- Structures and links as one system
# ---------------------------------------------------------------

OSCILLATOR = sl.Bilinear(1.0, 0.05, 0.1, yield_displacement=0.02, mass=2e5)


@given(st.lists(st.one_of(buildings(), st.just(OSCILLATOR)), min_size=1, max_size=4))
def test_a_system_of_mixed_structures_has_their_modes(structures: list[Any]) -> None:
    system = assembly_of(structures)
    n = int(system.first[-1])
    t = np.eye(n)
    for begin, end in pairwise(system.first):
        t[begin + 1 : end, begin : end - 1] -= np.eye(end - begin - 1)
    elastic = system.storeys.post + system.storeys.couple
    matrices = np.diag(system.storeys.mass), t.T @ np.diag(elastic) @ t, system.storeys.damping
    for matrix in matrices:
        np.testing.assert_allclose(matrix, matrix.T, rtol=0, atol=1e-12 * np.abs(matrix).max())
        root = np.sqrt(np.abs(np.diag(matrix)))
        assert np.linalg.eigvalsh(matrix / np.outer(root, root)).min() > 0
    root = np.sqrt(system.storeys.mass)
    squares = np.linalg.eigvalsh(matrices[1] / np.outer(root, root))
    periods = [
        np.atleast_1d(one.periods() if isinstance(one, sl.ShearBuilding) else one.period)
        for one in structures
    ]
    wanted = np.sort((2 * np.pi / np.concatenate(periods)) ** 2)
    np.testing.assert_allclose(squares, wanted, rtol=0, atol=1e-9 * wanted[-1])


def test_links_tie_floors_counted_through_all_structures() -> None:
    low, high = uniform(2, 1e5, 1e8), uniform(4, 1e5, 1e8)
    system = assembly_of([high, OSCILLATOR, low], [None, Link(1e6), Link(2e6, structures=(1, 3))])
    assert [
        (placed.floor, placed.other, placed.link.stiffness) for placed in system.placed_links
    ] == [
        (4, 6, 1e6),
        (1, 6, 2e6),
    ]
    given = Link(1e6, floors=(4, 1), structures=(1, 3))
    (placed,) = assembly_of([high, OSCILLATOR, low], [given]).placed_links
    assert (placed.floor, placed.other) == (3, 5)
    assert assembly_of([high, low], [None]).placed_links == ()
    assert system.first.tolist() == [0, 4, 5, 7]


def test_a_link_without_floors_is_at_the_highest_common_level() -> None:
    one = sl.ShearBuilding([1e5] * 3, [1e8] * 3, [4.0, 3.0, 3.0], 0.05)
    two = sl.ShearBuilding([1e5] * 4, [1e8] * 4, [3.5, 3.54, 3.5, 3.5], 0.05)
    assert common_floors(stick_model_of(one), stick_model_of(two), 1) == (2, 2)
    assert common_floors(stick_model_of(one), stick_model_of(OSCILLATOR), 1) == (3, 1)
    assert slabs_on_columns(one.levels(), two.levels()) == [(1, 1), (0, 1), (0, 3)]


# --- Bad input
# ----------------------------------------------------------------------------------------


def shear(**changed):
    return lambda: sl.ShearBuilding(**TWO | changed)


def of_law(law, **own):
    """Of a building without a strength, which has no use for the law."""
    return shear(law=law, law_parameters=own)


def regular_building(**changed):
    return lambda: sl.ShearBuilding.regular(**YIELDING | changed)


def link(**changed):
    return lambda: Link(**{"stiffness": 1e6} | changed)


MASSLESS, HIGH = sl.Bilinear(1.0, 0.05), sl.ShearBuilding([1e5] * 2, [1e8] * 2, [2.0, 2.0], 0.05)
LOW = uniform(2, 1e5, 1e8)
ONE, UPSIDE = {"structures": (2, 2)}, {"structures": (2, 2), "floors": (3, 0)}
REFUSED = {
    "heights has 1 values, and masses has 2; allowed: one for": shear(heights=[3.0]),
    "ShearBuilding: hardening is not given": shear(yield_drifts=0.01),
    "masses has 201 values; allowed: at most 200 storeys": lambda: uniform(201, 1e5, 1e8),
    r"law = v\*\*2 differs with the direction; allowed: ": shear(law=V**2),
    r"'beta': \[0\.6, 0\.8\]}; allowed: a mapping of numbers": of_law("bouc_wen", beta=[0.6, 0.8]),
    "gamma = -3 is out of range; allowed: -beta": of_law("bouc_wen", gamma=-3.0),
    "law_parameters = .*has no bet; allowed: beta, gamma, expo": of_law("bouc_wen", bet=1),
    "stiffnesses = inf in storey 1 is out of range; allowed: 0": regular_building(mass=1e308),
    "storey_height has 2 values; allowed: one, or 4": regular_building(storey_height=[3.0, 3.0]),
    "hardening is not given; what yields": regular_building(hardening=None),
    "takes 653777 N/m from storey 1; .*less than 600000 N/m": shear(
        stiffnesses=[6e5, 1e8], p_delta=True
    ),
    "Link: yield_displacement is given alone; allowed: both": link(yield_displacement=0.01),
    "Link: hardening is given alone; allowed: both": link(hardening=0.1),
    r"floors = \(0, 1\); allowed: two whole numbers from 1": link(floors=(0, 1)),
    r"floors = \(1, 0\).*from 1; 0, the ground, inside one": link(floors=(1, 0)),
    r"floors = None inside structure \(2, 2\); allowed: \(upper": link(**ONE),
    r"floors = \(1, 1\) inside .*: \(upper, lower\)": link(**ONE, floors=(1, 1)),
    r"floors = \(1, -1\); allowed: two whole numbers from 0": link(**ONE, floors=(1, -1)),
    r"link 1: floors = \(2, 1\), structure 1 has 1; allowed: 1 to": lambda: assembly_of(
        [OSCILLATOR, LOW], [Link(1, floors=(2, 1))]
    ),
    "structure 1: mass is not given; links and contacts need it, 0 < value": lambda: assembly_of(
        [MASSLESS, LOW], [Link(1)]
    ),
    "link 1: no two floors are at one level; give floors=": lambda: assembly_of(
        [LOW, HIGH], [Link(1)]
    ),
    "ties the structures 1 and 3 of 2; allowed: structures = t": lambda: assembly_of(
        [OSCILLATOR, LOW], [Link(1, structures=(1, 3))]
    ),
    r"link 1: floors = \(3, 0\), structure 2 has 2; allowed: 0 to 2": lambda: assembly_of(
        [OSCILLATOR, LOW], [Link(1, **UPSIDE)]
    ),
    "number 1 = 3 is of the wrong kind; allowed: Link": lambda: check_links("links", [3, None], 3),
    "1 given; allowed: one between each two neighbours": lambda: check_links("links", [Link(1)], 3),
}


@pytest.mark.parametrize("message", REFUSED)
def test_what_cannot_be_is_refused(message: str) -> None:
    with pytest.raises((ValueError, TypeError), match=message):
        REFUSED[message]()
