"""Rigid walls at the ends of a row: symmetry, energy, what meets, and what is refused."""

import re

import numpy as np
import pytest
import xarray as xr
from motions import motion, shaking

import stochlin as sl
from stochlin.applications.pounding.rows import checked_row, doubts_of_walls
from stochlin.applications.records.cells import checked_motions

pytestmark = [pytest.mark.invariant, pytest.mark.extreme]

BALANCE = 1e-9
ELEMENTS = [
    sl.LinearSpring(2e8),
    sl.Kelvin(2e8, restitution=0.65),
    sl.NoTensionKelvin(2e8, restitution=0.65),
    sl.Jankowski(2e9, restitution=0.65),
]
SOFT = sl.Bilinear(1.2, 0.05, 0.05, yield_displacement=0.05, mass=2e5)
STIFF = sl.Bilinear(0.6, 0.05, 0.05, yield_displacement=0.02, mass=3e5)
TOWER = sl.ShearBuilding(
    [2e5] * 3, [2e8, 1.6e8, 1e8], [3.5] * 3, 0.05, hardening=0.05, yield_drifts=0.008
)


@pytest.mark.parametrize(
    "contact", [*ELEMENTS, sl.Stereomechanical(0.65)], ids=lambda c: type(c).__name__
)
@pytest.mark.parametrize("fixed", ["ground", "space"])
def test_a_wall_on_the_left_is_the_mirror_of_one_on_the_right(contact, fixed):
    wall, motion = sl.Wall(fixed), shaking()
    right = sl.pound([SOFT, wall], 0.01, contact, motion)
    left = sl.pound([wall, SOFT], 0.01, contact, -1.0 * motion)
    assert right.sizes["impact"] > 2
    np.testing.assert_array_equal(right.displacement, -left.displacement)
    np.testing.assert_array_equal(right.impact_time, left.impact_time)
    np.testing.assert_array_equal(right.energy_lost, left.energy_lost)
    largest = float(abs(right.input_energy).max())
    np.testing.assert_allclose(right.energy_received, left.energy_received, atol=1e-9 * largest)
    assert right.neighbours.values.tolist() == ["1 | wall"]
    assert left.neighbours.values.tolist() == ["wall | 1"]


def test_a_wall_far_away_changes_nothing():
    motion = shaking()
    alone = sl.pound([SOFT], motion=motion)
    beside = sl.pound([sl.Wall(), SOFT, sl.Wall("space")], [1.0, 1e3], ELEMENTS[0], motion)
    np.testing.assert_array_equal(beside.amplification, 1.0)
    np.testing.assert_allclose(beside.displacement, alone.displacement, atol=1e-12)


def test_a_wall_is_the_limit_of_ever_heavier_and_stiffer_buildings():
    motion, contact = shaking(), ELEMENTS[0]
    wall = sl.pound([SOFT, sl.Wall()], 0.01, contact, motion, steps_per_contact=64)
    differences = []
    for mass in (1e8, 1e10):
        heavy = sl.Bilinear(0.002, 0.05, mass=mass)
        beside = sl.pound([SOFT, heavy], 0.01, contact, motion, steps_per_contact=64)
        differences.append(float(abs(beside.hardest_force[0] / wall.hardest_force[0] - 1)))
    assert differences[1] < differences[0] < 0.03
    assert differences[1] < 2e-3


@pytest.mark.parametrize("contact", ELEMENTS, ids=lambda c: type(c).__name__)
def test_energy_balances_for_three_buildings_between_two_walls(contact):
    row = [sl.Wall(), SOFT, STIFF, SOFT, sl.Wall("space")]
    table = sl.pound(row, [0.005, 0.02, 0.02, 0.01], contact, shaking(400))
    assert float(table.energy_balance_error.max()) < BALANCE
    assert (table.impacts > 0).all()
    assert table.neighbours.values.tolist() == ["wall | 1", "1 | 2", "2 | 3", "3 | wall"]
    assert table.left.values.tolist() == [0, 1, 2, 3]
    assert table.right.values.tolist() == [1, 2, 3, 0]
    last = table.isel(time=-1)
    of_buildings = ["kinetic_energy", "elastic_energy", "viscous_energy", "hysteretic_energy"]
    total = sum(float(last[name].sum()) for name in of_buildings)
    total += float(last.contact_lost_energy + last.contact_stored_energy)
    put_in = float(last.input_energy.sum() + last.wall_energy)
    assert total == pytest.approx(put_in, rel=1e-8)
    balance = table.energy_transferred.sum("side") + table.energy_lost
    assert float(abs(balance[:-1]).max()) < 1e-9 * put_in  # the last may go on


def test_a_plane_wall_meets_each_slab_and_an_edge_at_mid_storey_a_column():
    motion, contact = shaking(400), ELEMENTS[1]
    plane = sl.pound([TOWER, sl.Wall()], 0.004, contact, motion)
    assert plane.kind.values.tolist() == ["slab to wall"] * 3
    assert plane.level.values.tolist() == [3.5, 7.0, 10.5]
    assert plane.floor_left.values.tolist() == [1, 2, 3]
    assert plane.floor_right.values.tolist() == [0, 0, 0]
    edges = sl.pound([TOWER, sl.Wall(levels=[8.75, 7.02])], 0.004, contact, motion)
    assert edges.kind.values.tolist() == ["slab to wall", "wall to column"]
    assert edges.column.values.tolist() == ["", "left"]
    assert edges.storey.values.tolist() == [0, 3]
    assert edges.share.values.tolist() == [1.0, 0.5]
    assert float(edges.column_force[1]) == float(edges.hardest_force[1]) > 0
    for table in (plane, edges):
        assert float(table.energy_balance_error.max()) < BALANCE


def test_an_edge_at_mid_storey_hits_half_of_both_floors():
    # One contact at mid-height of the second storey: c = 2 xi sqrt(k m) with 1/m = (1/4 +
    # 1/4)/m_floor.
    two = sl.ShearBuilding([2e5] * 2, [2e8, 2e8], [3.0, 3.0], 0.05)
    contact = sl.LinearSpring(1e8)
    table = sl.pound([sl.Wall(levels=[4.5]), two], 0.002, contact, shaking(), steps_per_contact=128)
    middle = table.displacement.isel(structure=0).mean("floor")
    pressed = np.maximum(-middle - 0.002, 0.0)
    np.testing.assert_allclose(table.contact_force[:, 0], 1e8 * pressed, atol=1e-6 * 1e8)


@pytest.mark.parametrize(
    ("row", "gaps", "said"),
    [
        (
            [SOFT, sl.Wall(), STIFF],
            [0.1, 0.1],
            r"number 2 is a wall; allowed: a wall first or last",
        ),
        ([sl.Wall()], [], r"number 1 is a wall alone; allowed: a wall first or last"),
        ([sl.Wall(), sl.Wall()], [0.1], r"walls alone; allowed: at least one building"),
        (
            [sl.Wall(), SOFT],
            [0.1, 0.1],
            r"allowed: one number between each two neighbours, 1 in all",
        ),
        ([sl.Wall(), SOFT], [-0.1], r"-0.1 between the wall and structure 1 is out of range; al"),
        ([SOFT, STIFF, sl.Wall()], [0.1, -0.1], r"-0.1 between structure 2 and the wall is out of"),
        ([sl.Wall(), SOFT, STIFF], [0.1, -0.1], r"-0.1 between structures 1 and 2 is out of range"),
        (
            [SOFT, sl.Wall(levels=[3.0])],
            0.1,
            r"an oscillator, which has no levels; allowed: a wall w",
        ),
        (
            [TOWER, sl.Wall(levels=[11.0])],
            0.1,
            r"above the roof .* 10.5 m; allowed: levels up to the",
        ),
        (
            [TOWER, sl.Wall(levels=[7.0, 7.04])],
            0.1,
            r"meets the slab at 7 m twice; allowed: one level within 0.05 m of a slab",
        ),
        (
            [SOFT, sl.Wall()],
            xr.DataArray(10.0, attrs={"units": "cm"}),
            r"gaps is in 'cm', by its attribute units; allowed: m",
        ),
    ],
)
def test_walls_that_cannot_stand_there_are_refused(row, gaps, said):
    with pytest.raises(ValueError, match=said):
        sl.pound(row, gaps, ELEMENTS[0], shaking())


def test_velocities_do_not_jump_at_a_column():
    with pytest.raises(
        ValueError, match=r"a wall meets a column at 8.75 m; allowed: a contact with a f"
    ):
        sl.pound([TOWER, sl.Wall(levels=[8.75])], 0.01, sl.Stereomechanical(0.5), shaking())


@pytest.mark.parametrize(
    "levels", [[], [0.0], [-1.0], [np.nan], [np.inf], [[1.0]], [2.0, 2.0], 3.0]
)
def test_levels_of_walls_are_positive_and_differ(levels):
    with pytest.raises(ValueError, match=r"Wall: levels = .*; allowed: levels above the ground"):
        sl.Wall(levels=levels)


def test_levels_of_walls_are_in_metres():
    levels = xr.DataArray([350.0], dims="level", attrs={"units": "cm"})
    with pytest.raises(ValueError, match=r"Wall: levels is in 'cm', .*; allowed: m, so convert"):
        sl.Wall(levels=levels)


def test_a_row_has_buildings_and_walls():
    with pytest.raises(TypeError, match=r"number 2 = 'wall' is of the wrong kind; .*, Wall$"):
        sl.pound([SOFT, "wall"], 0.1, ELEMENTS[0], shaking())


@pytest.mark.parametrize(
    ("row", "gaps", "sign", "said"),
    [
        ([SOFT, sl.Wall("space")], 0.9, 1, r"a wall fixed in space moves by 2.45 m against the gr"),
        ([sl.Wall(), SOFT, sl.Wall("space")], [0.1, 0.2], 1, r"2.45 m closer .* 0.3 m in all; has"),
        ([sl.Wall("space"), SOFT, sl.Wall()], [0.1, 0.2], -1, r"2.45 m closer .* 0.3 m in all; h"),
    ],
)
def test_walls_in_space_that_drift_are_doubted(row, gaps, sign, said):
    offset = motion(np.full(351, sign * 0.1))
    neighbours = checked_row(row)
    grounds = checked_motions(offset).grounds
    assert re.search(said, *doubts_of_walls(neighbours, np.atleast_1d(gaps), grounds, 0.0))


def test_walls_in_space_that_stay_or_go_away_are_not_doubted():
    grounds = checked_motions(motion(np.full(101, 0.1))).grounds
    for row in ([sl.Wall("space"), SOFT, sl.Wall()], [SOFT, sl.Wall("space")], [SOFT, sl.Wall()]):
        gaps = np.full(len(row) - 1, 0.05)
        assert not [*doubts_of_walls(checked_row(row), gaps, grounds, 0.0)]
    row = checked_row([SOFT, sl.Wall("space")])
    assert [*doubts_of_walls(row, np.array([0.05]), grounds, 2.0)]  # by the ground at the start


def test_a_wall_has_no_mass():
    with pytest.raises(TypeError, match="mass"):
        sl.Wall(mass=1e10)
