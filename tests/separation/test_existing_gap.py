"""Answers for an existing gap: put back into the separation, each gives this gap."""

from dataclasses import replace

import numpy as np
import pytest

import stochlin as sl
from stochlin.applications.separation.existing_gap import NO_LIMIT, Required

pytestmark = pytest.mark.oracle

GROUND = sl.named_ground("firm", intensity=0.01)
OPTIONS = {"envelope": sl.AminAng(4.0, 15.0, 0.35), "paths": 128, "confidence": 0.8}
GRID = [0.5, 0.9, 1.1, 1.5]
FIRST, SECOND = (sl.Bilinear(T, 0.05, 0.2, reduction_factor=3.0) for T in (0.4, 1.2))


def required(first, second, ground):
    table = sl.separation(first, second, ground, 25.0, **OPTIONS)
    return float(table.gap.sel(rule="simulation"))


@pytest.fixture(scope="module")
def now():
    return required(FIRST, SECOND, GROUND)


def strengths(factor=1.0):
    uy = [float(sl.linearize(s, GROUND).yield_displacement) for s in (FIRST, SECOND)]
    return [
        replace(s, reduction_factor=None, yield_displacement=u / factor)
        for s, u in zip((FIRST, SECOND), uy, strict=True)
    ]


@pytest.mark.parametrize("share", [0.8, 1.3])
def test_each_answer_asks_for_the_gap_that_is_there(now, share):
    gap = share * now
    table = sl.existing_gap(FIRST, SECOND, GROUND, gap, duration=25.0, **OPTIONS)
    assert float(table.required_gap) == pytest.approx(now, rel=1e-9)
    assert (float(table.no_pounding_probability) > 0.8) == (share > 1)

    strong = sl.named_ground("firm", intensity=float(table.largest_intensity))
    assert required(*strengths(), strong) == pytest.approx(gap, rel=3e-3)

    added = float(table.least_added_damping)
    if share > 1:
        assert added == 0
    else:
        damped = [replace(s, damping=0.05 + added) for s in strengths()]
        assert required(*damped, GROUND) == pytest.approx(gap, rel=3e-3)

    factor = float(table.largest_reduction_factor_1)
    assert float(table.largest_reduction_factor_2) == pytest.approx(factor, rel=1e-9, nan_ok=True)
    if np.isfinite(factor):
        assert required(*strengths(factor / 3.0), GROUND) == pytest.approx(gap, rel=3e-3)


def test_strengths_that_hold_need_not_begin_at_the_strongest():
    """Elastic, both are in resonance with the ground; as built they yield, and the gap holds."""
    pair = [sl.Bilinear(T, 0.05, 0.05, reduction_factor=4) for T in (1.9, 2.1)]
    ground, shape = sl.KanaiTajimi(2.0, 0.05, 0.001), sl.AminAng(4.0, 15.0, 0.35)
    motion = {"envelope": shape, "paths": 256}
    table = sl.existing_gap(*pair, ground, 0.2149, duration=30.0, **motion)
    assert float(table.no_pounding_probability) > 0.9
    least = float(table.least_reduction_factor_1)
    assert 1 < least < 4 < float(table.largest_reduction_factor_1)
    ends = [float(table[f"least_reduction_factor_{end}_1"]) for end in ("lower", "upper")]
    assert ends[0] < least < ends[1]
    for factor, enough in ((0.9 * least, False), (1.1 * least, True)):
        uy = [float(sl.linearize(s, ground).yield_displacement) * 4 / factor for s in pair]
        weaker = [
            replace(s, reduction_factor=None, yield_displacement=u)
            for s, u in zip(pair, uy, strict=True)
        ]
        gap = float(sl.separation(*weaker, ground, 30.0, **motion).gap[0])
        assert (gap <= 0.2149) == enough


def test_ends_of_intervals_ask_for_the_gap_with_the_ends_of_what_is_required():
    """Of linear structures in closed form: gaps go with the root of the intensity."""
    pair = sl.Bilinear(0.5, 0.05), sl.Bilinear(1.0, 0.05)
    shares = []
    table = sl.existing_gap(*pair, GROUND, 0.1, duration=25.0, **OPTIONS, progress=shares.append)
    assert shares == sorted(shares)
    assert shares[0] < shares[1] < 0.2 < shares[-1] <= 1
    now = sl.separation(*pair, GROUND, 25.0, **OPTIONS)
    for end, other in (("lower", "upper"), ("upper", "lower")):
        exact = float(GROUND.intensity) * (0.1 / float(now[f"gap_{other}"][0])) ** 2
        assert float(table[f"largest_intensity_{end}"]) == pytest.approx(exact, rel=0.02)


def test_a_few_motions_decide_where_they_are_clear_and_all_of_them_find_the_edge():
    """The gap of a few is 5 % too large, within their 10 % error; all ask for the value itself."""
    tried = {64: [], 512: []}

    def search(few, error, all_motions):
        def gaps(value, paths):
            tried[paths].append(value)
            factor, off = (few, error) if paths == 64 else (all_motions, 0.02)
            return tuple(factor * value * (1 + sign * off) for sign in (0, -1, 1))

        search = Required(gaps, 1.0, 512, {(3.0, 512): gaps(3.0, 512)})
        return search.end(GRID, [0], 1, NO_LIMIT)

    found = search(1.05, 0.1, 1.0)
    assert found.value == pytest.approx(1, rel=1e-3)
    assert (found.lower, found.upper) == pytest.approx((1 / 1.02, 1 / 0.98), rel=1e-3)
    assert tried[64] == [0.5, 0.9, 1.1]
    assert not {0.5, 1.5} & set(tried[512])
    assert tried[512].count(3.0) == 1
    ample = Required(lambda value, paths: (value,) * 3, 2.0, 64, {})
    assert ample.end(GRID, [0], 1, NO_LIMIT) == NO_LIMIT  # all are sufficient up to the end
    assert ample.least(GRID) == (0.5, 0.5, 0.5)
    hopeless = Required(lambda value, paths: (value,) * 3, 0.1, 64, {})
    assert np.isnan(hopeless.least(GRID)).all()
    falls = Required(lambda value, paths: (value if value < 1 else np.inf,) * 3, 1.2, 64, {})
    assert falls.end(GRID, [0], 1, NO_LIMIT)[1:] == (0.9, 1.1)  # a structure falls from 1 on
    # All motions contradict the few at the value before the edge: it is there, within the error.
    assert search(1.0, 0.001, 1.2).value == 0.9


def test_a_duration_without_its_name_is_never_taken_for_a_gap():
    with pytest.raises(TypeError, match=r"existing_gap\(\) takes 4 positional"):
        sl.existing_gap(FIRST, SECOND, GROUND, 0.3, 0.1)
    with pytest.raises(TypeError, match=r"mitigate\(\) takes 5 positional"):
        sl.mitigate(FIRST, SECOND, GROUND, 0.3, 0.1, {})
