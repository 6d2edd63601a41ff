"""The number of motions grows until the gap is known as well as wanted."""

import numpy as np
import xarray as xr

import stochlin as sl
from stochlin.solver.simulation.prepared import FiniteMotion, PreparedStructures, enough_motions
from stochlin.solver.simulation.statistics import required_gaps

FIRM = sl.named_ground("firm", intensity=0.01)


def grown(spread, most=2048, fallen=0.0):
    """Lognormal separations of two structures with this spread, and the numbers simulated."""
    counts = []

    def simulated(count):
        counts.append(count)
        samples = np.exp(spread * np.random.default_rng(4).standard_normal(count))
        samples[: int(fallen * count)] = np.inf
        over = ("path", "structure", "structure_2")
        values = np.zeros((count, 2, 2)) + samples[:, None, None]
        return xr.Dataset({"separation": (over, values)}, {"quantile": [0.9]})

    return enough_motions(simulated, 256, most), counts


def test_motions_grow_until_the_interval_is_short_enough_and_no_further():
    known, counts = grown(0.3)
    assert counts == [256]
    wide, counts = grown(0.8)
    assert counts[0] == 256 < counts[-1] < 2048
    for motions in (known, wide):
        gap, lower, upper = required_gaps(motions)
        assert upper - lower <= 0.2 * gap
    assert grown(5.0)[1][-1] == 2048
    assert grown(0.8, most=256)[1] == [256]
    assert grown(0.3, fallen=0.08)[1] == [256, 2048]  # the upper end is infinite
    assert grown(0.3, fallen=0.5)[1] == [256]  # and so is the gap


def test_what_is_quick_begins_with_many_motions_and_storeys_with_few():
    one = sl.Bilinear(0.6, 0.05)
    tower = sl.ShearBuilding([2e5] * 10, [2e8] * 10, [3.0] * 10, 0.05)
    motion = FiniteMotion(20.0, None, 0.0, 1)

    def numbers(first, paths=None):
        pair = {"first": first, "second": one}
        prepared = PreparedStructures.of(pair, FIRM, motion, paths)
        return prepared.fewest, prepared.most

    assert numbers(one) == (2048, 2048)
    begin, most = numbers(tower)
    assert 256 <= begin < 1024 < most == 2048
    assert numbers(tower, 640) == (640, 640)
