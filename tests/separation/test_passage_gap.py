"""Gaps of finite motions without simulation: exact limits, other algorithms, and simulation."""

import numpy as np
import pytest
import scipy.linalg
import scipy.stats
import xarray as xr
from cases import with_slow

import stochlin as sl
from stochlin.kernels.correlation.levels import (
    L1_NODES,
    AtLevels,
    covariances_with_rates,
    pair_rows,
)
from stochlin.kernels.correlation.pairs import taken
from stochlin.kernels.linearization.covariance import own_covariance, residues
from stochlin.kernels.linearization.levels import levels_for
from stochlin.kernels.passage import CHAIN, Passage, required_gaps, survival
from stochlin.kernels.probability import accumulated, hazards
from stochlin.solver.correlation.signatures import drifting_side
from stochlin.solver.linearization.equivalent_systems import Oscillators, joined
from stochlin.solver.linearization.levels import (
    EnvelopesInTime,
    distinct,
    solve_levels,
    structures_in_time,
)
from stochlin.solver.linearization.systems.systems import linearized_motion
from stochlin.solver.tables.cells import flat

QUAKE = {"duration": 30.0, "envelope": sl.AminAng(4.0, 15.0, 0.35)}
BROAD = sl.KanaiTajimi(0.42, 0.6, intensity=0.01)
GROUNDS = {
    "white": sl.WhiteNoise(0.01),
    "broad band": BROAD,
    "lake bed": sl.KanaiTajimi(2.0, 0.05, intensity=0.01),
    "high pass": sl.named_ground("firm", intensity=0.01),
}
PAIR = tuple(sl.Bilinear(T, 0.05, 0.05, reduction_factor=R) for T, R in ((0.6, 4), (1.0, 3)))
ELASTIC = sl.Bilinear(0.6, 0.05), sl.Bilinear(1.0, 0.03)


def gap(first, second, ground=BROAD, **options):
    return float(sl.passage_gap(first, second, ground, **QUAKE | options).required_gap)


def one_course(offset, memory, instants=41):
    """A process of one case with a constant fast part."""
    ones = np.ones((1, instants))
    seconds = np.full(instants, 0.5)
    seconds[[0, -1]] /= 2
    none = np.empty((0, 0, 0))
    return Passage(0.1 * ones, 1.2 * ones, 0.3 * ones, offset * ones, memory * ones, seconds, none)


def shares(process, gaps, chain=CHAIN):
    result = np.empty((1, len(gaps), process.seconds.size))
    survival(np.array([gaps]), process, chain, result)
    return result[0, :, -1]


def vanmarcke(process, gaps):
    """The same without an offset, by `hazards`."""
    d_d, v_v = process.std.T**2, (2 * np.pi * process.crossings * process.std).T ** 2
    rate = hazards(gaps, d_d, 0.0, v_v, process.bandwidth.T)[1]
    times = np.concatenate([[0.0], np.full(process.seconds.size - 1, 0.5)]).cumsum()
    return np.exp(-accumulated(rate, times)[-1])


@pytest.mark.oracle
class TestPassage:
    GAPS = np.array([0.05, 0.15, 0.25, 0.35, 0.45])

    def test_without_an_offset_it_is_that_of_vanmarcke(self):
        process = one_course(0.0, 1.0)
        np.testing.assert_allclose(
            shares(process, self.GAPS), vanmarcke(process, self.GAPS), rtol=1e-9
        )

    def test_of_a_permanent_offset_it_is_the_mean_over_a_gaussian(self):
        process = one_course(0.08, 1.0)
        normal = np.linspace(-8, 8, 4001)
        weights = scipy.stats.norm.pdf(normal) * (normal[1] - normal[0])
        left = self.GAPS[:, None] - 0.08 * normal
        stays = np.where(left > 0, vanmarcke(process, np.abs(left).ravel()).reshape(left.shape), 0)
        np.testing.assert_allclose(shares(process, self.GAPS), stays @ weights, atol=5e-3)

    def test_offsets_of_white_noise_are_independent_from_instant_to_instant(self):
        process = one_course(0.08, 1e-6)
        normal = np.linspace(-8, 8, 4001)
        weights = scipy.stats.norm.pdf(normal) * (normal[1] - normal[0])
        expected = []
        for value in self.GAPS[2:]:
            left = value - 0.08 * normal
            rate = hazards(np.abs(left), 0.01, 0.0, (2 * np.pi * 1.2 * 0.1) ** 2, 0.3)[1]
            stays = [np.where(left > 0, np.exp(-rate * s), 0) @ weights for s in process.seconds]
            expected.append(np.prod(stays))
        np.testing.assert_allclose(shares(process, self.GAPS[2:]), expected, atol=5e-3)

    def test_the_chain_is_an_ornstein_uhlenbeck_process(self):
        place, share = CHAIN.place, CHAIN.share
        assert share.sum() == pytest.approx(1, abs=1e-12)
        assert share @ place**2 == pytest.approx(1, abs=1e-12)
        factor = 0.7 ** np.arange(place.size)
        step = CHAIN.back @ (factor[:, None] * CHAIN.into)  # of probabilities
        np.testing.assert_allclose(step @ share, share, atol=1e-12)
        np.testing.assert_allclose(place @ step, 0.7 * place, atol=1e-10)

    def test_a_required_gap_has_its_confidence(self):
        process = one_course(0.05, 0.9)
        for confidence in (0.05, 0.5, 0.9, 0.999):
            found = np.empty(1)
            required_gaps(confidence, np.ones(1), process, CHAIN, found)
            assert shares(process, found) == pytest.approx(confidence, abs=2e-3 * (1 - confidence))


def at_levels(structures, ground):
    """Both structures at 16 levels each, one after the other; the shorter period is first."""
    cells = [Oscillators.of(flat({"structure": each, "ground": ground})) for each in structures]
    columns, number = distinct(joined(cells))
    assert number.tolist() == [0, 1]
    return solve_levels(columns, ground, levels_for(1.0))


@pytest.mark.oracle
@pytest.mark.parametrize("name", with_slow(GROUNDS, {"white", "high pass"}))
def test_moments_of_a_pair_are_those_of_the_lyapunov_equation(name):
    ground = GROUNDS[name]
    pair = [
        sl.Bilinear(T, 0.05, 0.05, yield_displacement=uy) for T, uy in ((0.6, 0.016), (1.0, 0.03))
    ]
    solved = at_levels(pair, ground)
    side = drifting_side(solved.solved.values)
    tops = [taken(side, np.array([place])) for place in (15, 31)]
    terms = residues(tops[0].motion, tops[1].motion)
    ahead, rates = covariances_with_rates(tops[0].motion, tops[1].motion, terms)
    c_eq, k_eq = (solved.solved.values[key][[15, 31]] for key in ("c_eq", "k_eq"))
    space = sl.statespace(pair, ground, c_eq, k_eq)
    matrix, noise = space.state_matrix.values, space.noise_vector.values
    drive = 2 * np.pi * 0.01 * np.outer(noise, noise)
    covariance = scipy.linalg.solve_continuous_lyapunov(matrix, -drive)
    u_1, v_1, v_2 = space.get_index("state").get_indexer(["u_1", "v_1", "v_2"])
    assert ahead[0] == pytest.approx(covariance[u_1, v_2], rel=1e-8)
    assert rates[0] == pytest.approx(covariance[v_1, v_2], rel=1e-8)


@pytest.mark.oracle
@pytest.mark.parametrize("name", GROUNDS)
def test_bandwidth_of_a_difference_is_that_of_the_engine(name):
    ground = GROUNDS[name]
    solved = at_levels(ELASTIC, ground)
    side, frequency = drifting_side(solved.solved.values), np.sqrt(solved.system.stiffness)
    both = AtLevels(
        solved.system,
        solved.forcing,
        own_covariance(solved.system, solved.forcing),
        side,
        solved.rows,
        np.tile(solved.levels, 2),
        solved.soil.later(solved.system, L1_NODES + 0 * frequency),
    )
    one, two = (taken(both, np.array([place])) for place in (15, 31))
    rows = pair_rows(one, two, np.zeros(1))
    response = linearized_motion(ELASTIC, ground)
    l0, l1, l2 = (np.ravel(x)[0] for x in response.spectral_moments(np.array([[1.0, -1.0]])))
    assert rows.bandwidth[0] == pytest.approx(np.sqrt(1 - l1**2 / (l0 * l2)), rel=1e-3)


@pytest.mark.oracle
def test_a_linear_structure_follows_white_noise_at_its_own_rate():
    structure, ground = sl.Bilinear(0.8, 0.05), sl.WhiteNoise(0.01)
    one = np.ones(1)
    course = EnvelopesInTime.of(None, 20.0, one, one)
    cells = Oscillators.of(flat({"structure": structure, "ground": ground}))
    square = structures_in_time(cells, ground, course).squares[:, 0, 0]
    rate = 2 * 0.05 * 2 * np.pi / 0.8
    np.testing.assert_allclose(square, -np.expm1(-rate * course.times), atol=1e-9)


@pytest.mark.oracle
@pytest.mark.parametrize(
    ("name", "error", "std_error"),  # in %
    [("white", 0.5, 1), ("broad band", 0.5, 1), ("high pass", 1, 2), ("lake bed", 2, 8)],
)
def test_elastic_pairs_have_the_gap_of_exact_moments(name, error, std_error):
    options = {**QUAKE, "paths": 0, "points": 16}
    exact, lagged = (
        sl.pounding_probability(*ELASTIC, GROUNDS[name], 0.1, closure=closure, **options)
        for closure in ("gaussian", "drift")
    )
    assert float(lagged.required_gap / exact.required_gap) == pytest.approx(1, abs=error / 100)
    np.testing.assert_allclose(
        lagged.difference_std,
        exact.difference_std,
        atol=std_error / 100 * float(exact.difference_std.max()),
    )


@pytest.mark.invariant
class TestSymmetryAndScaling:
    def test_both_sides_need_the_same_gap(self):
        assert gap(*PAIR) == pytest.approx(gap(*PAIR[::-1]), rel=1e-9)

    def test_equal_structures_need_none(self):
        with pytest.warns(sl.ImplausibleInput, match="are the same building"):
            assert gap(PAIR[0], PAIR[0]) == 0

    def test_motions_and_strengths_scale_together(self):
        strengths = [float(sl.linearize(each, BROAD).yield_displacement) for each in PAIR]
        plain, doubled = (
            gap(
                *(
                    sl.Bilinear(each.period, 0.05, 0.05, yield_displacement=factor * uy)
                    for each, uy in zip(PAIR, strengths, strict=True)
                ),
                sl.KanaiTajimi(0.42, 0.6, 0.01 * factor**2),
            )
            for factor in (1, 2)
        )
        assert doubled == pytest.approx(2 * plain, rel=1e-9)

    def test_beside_a_stiff_building_it_is_the_set_back(self):
        assert gap(PAIR[1], sl.Bilinear(0.02, 0.05)) == pytest.approx(gap(PAIR[1], None), rel=1e-3)

    def test_a_table_has_the_numbers_of_its_cells_in_any_order_and_lazily(self):
        period = xr.DataArray([0.4, np.nan, 0.7, 40.0], dims="period")
        factor = xr.DataArray([1.5, 5.0], dims="factor")
        other = sl.Bilinear(1.0, 0.05, 0.05, reduction_factor=3)

        def table(periods):
            first = sl.Bilinear(periods, 0.05, 0.05, reduction_factor=factor)
            return sl.passage_gap(first, other, BROAD, gap=0.1, **QUAKE)

        whole, delayed = table(period), table(period.chunk(period=2))
        lazy, invalid = delayed.compute(), table(period[[1]])
        assert whole.status.isel(factor=0).values.tolist() == [0, 3, 0, 3]
        for n, p in ((0, 0.4), (2, 0.7)):
            first = sl.Bilinear(p, 0.05, 0.05, reduction_factor=5.0)
            cell = sl.passage_gap(first, other, BROAD, gap=0.1, **QUAKE)
            for name, values in cell.items():
                found = float(whole[name].isel(period=n, factor=1))
                assert found == pytest.approx(float(values), rel=1e-9), name
        for name in whole:
            np.testing.assert_allclose(lazy[name], whole[name], rtol=1e-5, err_msg=name)
            assert invalid[name].dtype == delayed[name].dtype == whole[name].dtype, name


@pytest.mark.oracle
class TestSimulation:
    def test_a_yielding_pair(self):
        pair = [sl.Bilinear(T, 0.05, 0.05, reduction_factor=4) for T in (0.6, 1.0)]
        simulated = 0.1177  # m, of 16 384 motions, interval .1167 to .1187
        assert gap(*pair) == pytest.approx(simulated, rel=0.06)
        assert gap(*pair, scatter=0.3) > 1.05 * gap(*pair)

    def test_with_scatter_between_motions(self):
        table = sl.separation(*PAIR, BROAD, paths=4096, scatter=0.3, **QUAKE)
        simulated, lower, upper = (
            float(table[name].sel(rule="simulation")) for name in ("gap", "gap_lower", "gap_upper")
        )
        by_rule = float(table.gap.sel(rule="first_passage_drift"))
        assert by_rule == pytest.approx(gap(*PAIR, scatter=0.3), rel=1e-9)
        assert by_rule == pytest.approx(simulated, abs=0.05 * simulated + (upper - lower))

    def test_the_permanent_set_of_one_structure(self):
        structure = sl.Bilinear(1.0, 0.05, 0.05, reduction_factor=4)
        over_time = sl.transient_response(structure, BROAD, closure="drift", **QUAKE)
        assert "permanent_set_left_out" not in over_time
        motions = sl.simulated_motions(BROAD, 30.0, QUAKE["envelope"], paths=256, seed=3)
        uy = float(over_time.yield_displacement)
        table = sl.response_spectrum([*motions], 1.0, 0.05, hardening=0.05, yield_displacement=uy)
        # The standard error of a standard deviation of 256 is 4.4 %.
        assert float(over_time.drift_std[-1]) == pytest.approx(
            float(table.permanent_set.std()), rel=0.15
        )


@pytest.mark.invariant
class TestRefusals:
    def test_what_has_no_drift_closure(self):
        storeys = sl.ShearBuilding.regular(
            period=0.8, storeys=3, storey_height=3.0, mass=3e5, damping=0.05
        )
        for other, words in (
            (sl.BoucWen(0.5, 0.05, 0.1, reduction_factor=3), "no drift closure for BoucWen"),
            (
                sl.Bilinear(0.5, 0.05, 0.0, yield_displacement=0.02),
                "without stiffness after yielding",
            ),
        ):
            with pytest.raises(ValueError, match=words):
                gap(PAIR[0], other)
        with pytest.raises(TypeError):
            gap(PAIR[0], storeys)
        with pytest.raises(ValueError, match=r"closure = 'drift': .* BoucWen; allowed: 'gaussian'"):
            sl.pounding_probability(
                PAIR[0],
                sl.BoucWen(0.5, 0.05, 0.1, reduction_factor=3),
                BROAD,
                0.1,
                closure="drift",
                **QUAKE,
            )

    def test_cautions(self):
        alike = sl.Bilinear(1.04, 0.05, 0.05, reduction_factor=3)
        stiff = [sl.Bilinear(T, 0.05, 0.05, reduction_factor=3) for T in (0.2, 0.3)]
        both = [sl.KanaiTajimi(0.3, 0.5, 0.01), sl.KanaiTajimi(0.3, 0.5, 0.01)]
        flags = [
            int(sl.passage_gap(*pair, ground, **QUAKE).caution)
            for pair, ground in (
                (PAIR, BROAD),
                ((PAIR[1], alike), BROAD),
                (PAIR, GROUNDS["lake bed"]),
                (stiff, BROAD),
                (PAIR, sl.ParallelGround(both)),
            )
        ]
        assert flags == [0, 1, 1, 1, 2]
