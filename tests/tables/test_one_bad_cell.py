"""One bad cell spoils no table: its neighbours have the numbers they have alone, it has a status.

Everything that is reduced over the cells of a table is at stake: what is shared by all of them, and
what goes on until the last one has converged.
"""

from functools import partial

import numpy as np
import pytest
import sympy

import stochlin as sl
from stochlin.solver.tables import labels

pytestmark = pytest.mark.invariant

V, Z = sympy.symbols("v z", real=True)
LAW = V - Z * sympy.Abs(V) / 2 - V * sympy.Abs(Z) / 2
# Periods, damping and hardening ratios and reduction factors of the first and the second
# structures.
GOOD = [(1.0, 0.05, 0.05, 2.0), (0.6, 0.03, 0.1, 4.0), (2.0, 0.02, 0.3, 1.2)]
BESIDE = [(0.7, 0.05, 0.05, 3.0), (1.5, 0.04, 0.02, 2.0), (0.5, 0.05, 0.2, 5.0)]
INVALID = [
    (np.nan, 0.05, 0.05, 2.0),
    (-1.0, 0.05, 0.05, 2.0),
    (np.inf, 0.05, 0.05, 2.0),
    (1e-200, 0.05, 0.05, 2.0),
    (1.0, 5.0, 0.05, 2.0),
    (1.0, 0.05, 1.2, 2.0),
    (1.0, 0.05, 0.05, -2.0),
]
# No stationary response, and strengths and periods that no linearization, or no motion, can follow.
HARD = [
    (1.0, 0.05, 0.0, 2.0),
    (1.0, 0.05, -0.5, 8.0),
    (0.3, 0.02, 1e-6, 1e4),
    (1.0, 0.05, 0.05, 1e-300),
    (1.0, 1e-9, 1e-9, 50.0),
    (1.0, 1e-300, 1e-12, 5.0),
]
# two seconds each
HARDEST = [(1.0, 0.05, 0.05, 1e30), (1e-9, 0.05, 0.05, 3.0), (1e9, 0.05, 0.05, 3.0)]
GROUNDS = {
    "white noise": sl.WhiteNoise(0.01),
    "Kanai-Tajimi": sl.KanaiTajimi(2.0, 0.1, 0.01),
    "Clough-Penzien": sl.CloughPenzien(1.0, 0.3, 4.0, 0.6, 0.01),
}
LAKE, BROAD = GROUNDS["Kanai-Tajimi"], sl.KanaiTajimi(0.5, 0.6, 0.01)
QUAKE = {"duration": 8.0, "envelope": sl.AminAng(1.0, 5.0, 0.5)}
FEW = {"method": "simulation", "paths": 32}
TOWER = sl.ShearBuilding([2e5, 2e5], [4e8, 3e8], [3.5, 3.5], 0.05, 0.05, yield_drifts=0.01)
RECORD = sl.simulated_motions(BROAD, 8.0, paths=2, seed=1)[0]
MIXED = ["covariance_change", "coefficient_change"]  # NaN after the last iteration of a cell


def columns(cells):
    return [np.array(column) for column in zip(*cells, strict=True)]


def of(cells, law=sl.Bilinear, **others):
    period, damping, hardening, factor = columns(cells)
    return law(period, damping, hardening, reduction_factor=factor, **others)


def in_metres(cells):
    period, damping, hardening, factor = columns(cells)
    return sl.Bilinear(period, damping, hardening, yield_displacement=0.05 / factor)


def system(one, two, link=None, max_iterations=30, **options):
    pair = of(one, mass=1e5), of(two, mass=2e5)
    return sl.linearize_system(pair, LAKE, [link], max_iterations=max_iterations, **options)


def probability(one, two, **options):
    return sl.pounding_probability(
        in_metres(one), in_metres(two), BROAD, 0.1, points=5, **options, **QUAKE
    )


def on_record(one, _):
    period, damping, hardening, factor = columns(one)
    strength = {"hardening": hardening, "yield_displacement": 0.05 / factor}
    return sl.response_spectrum(RECORD, period, damping, **strength)


RELAXED = {"iteration": "substitution", "relaxation": 0.7, "max_iterations": 200}
DASHPOT = sl.Link(2e6, 1e5, damping_exponent=0.5)
LINEARIZED = {
    f"linearize, {closure}, {name}": lambda one, _, c=closure, g=ground: sl.linearize(of(one), g, c)
    for closure in ("gaussian", "drift")
    for name, ground in GROUNDS.items()
}
# Functions that compute every cell with the same operations, to the last bit.
SAME_BITS = {
    **LINEARIZED,
    **{
        f"correlate, {name}": lambda one, two, g=ground: sl.correlate(of(one), of(two), g)
        for name, ground in GROUNDS.items()
    },
    "Bouc-Wen": lambda one, two: sl.correlate(of(one, sl.BoucWen), of(two), LAKE),
    "law in symbols": lambda one, _: sl.linearize(of(one, partial(sl.Hysteretic, law=LAW)), LAKE),
    "eq. (4) of a pair": lambda one, two: sl.correlate(of(one), of(two), LAKE, "white_noise"),
    "effective": lambda one, two: sl.correlate(of(one), of(two), LAKE, "effective"),
    "amplification": lambda one, _: sl.amplification(of(one), LAKE),
    "peak_response": lambda one, _: sl.peak_response(of(one), LAKE, 20.0),
    "reduction_factor": lambda one, _: sl.reduction_factor(of(one), LAKE),
    "recorded_gap": lambda one, two: sl.recorded_gap(in_metres(one), in_metres(two), RECORD),
    "response_spectrum": on_record,
}
# The same, of periods and damping ratios alone, or of other numbers that stand in their place.
OF_PERIODS = {
    "strength_for_ductility": lambda one, _: sl.strength_for_ductility(of(one), LAKE, 4.0),
    "rho_white_noise": lambda one, two: sl.rho_white_noise(
        columns(one)[0], columns(two)[0], columns(one)[1], columns(two)[1]
    ),
    "durations": lambda one, _: sl.peak_response(
        sl.Bilinear(0.8, 0.05), LAKE, 20.0 * columns(one)[0]
    ),
    "grounds": lambda one, _: sl.linearize(
        sl.Bilinear(0.8, 0.05, 0.1, reduction_factor=3.0), sl.KanaiTajimi(*columns(one)[:2], 0.01)
    ),
    "critical_gap": lambda one, two: sl.critical_gap(
        columns(one)[0], columns(two)[0], columns(one)[2]
    ),
    "code_gaps": lambda one, two: sl.code_gaps(columns(one)[0], columns(two)[0], zone="I"),
}
# Sums of a lone cell are made in another order, and matrices of all cells are multiplied together.
ROUNDED = {
    **{
        f"correlate, drift, {name}": lambda one, two, g=ground: sl.correlate(
            of(one), of(two), g, closure="drift"
        )
        for name, ground in GROUNDS.items()
    },
    "system, anderson": system,
    "system, substitution": partial(system, **RELAXED),
    "system, linked": partial(system, link=sl.Link(2e6, 1e5)),
    "system, yielding link": partial(
        system, link=sl.Link(2e6, hardening=0.05, yield_displacement=0.01)
    ),
    "system, power law": partial(system, link=DASHPOT),
    "system, power law, substitution": partial(system, link=DASHPOT, **RELAXED),
    "system, with storeys": lambda one, _: sl.linearize_system(
        [of(one), TOWER], LAKE, max_iterations=30
    ),
}
# Cells have the motions in common, whose step and length follow from all that are not out of range.
SIMULATED = {
    "correlate, simulation": lambda one, two: sl.correlate(of(one), of(two), BROAD, **FEW),
}
# The steps in time follow from all cells; the tolerance is that of one step.
IN_TIME = {
    "transient_response": lambda one, _: sl.transient_response(
        in_metres(one), BROAD, points=5, **QUAKE
    ),
    "probability": partial(probability, paths=0),
    "probability, simulation": partial(probability, paths=32),
}
# Cells that are simulated one by one.
ONE_BY_ONE = {
    "amplification, peaks": lambda one, _: sl.amplification(
        of(one), BROAD, of="peak", paths=32, **QUAKE
    ),
    "separation": lambda one, two: sl.separation(of(one), of(two), BROAD, paths=32, **QUAKE),
    "pounding_risk": lambda one, two: sl.pounding_risk(
        in_metres(one), in_metres(two), BROAD, 0.1, sl.PowerLawHazard(k0=0.01, k=2.5), 8.0, paths=32
    ),
}


def check(table, alone, bad, rtol=1e-12, atol=1e-14):
    """The first cells are as ``alone``, to rounding; the last ``bad`` are NaN with a status."""
    for n, lone in enumerate(alone):
        for name, value in lone.drop_vars(MIXED, errors="ignore").data_vars.items():
            here = table[name].isel(case=n, missing_dims="ignore")
            there = value.isel(case=0, missing_dims="ignore")
            if value.dtype.kind == "f":
                np.testing.assert_allclose(here, there, rtol, atol, err_msg=name)
            else:
                np.testing.assert_array_equal(here, there, err_msg=name)
    last = table.isel(case=slice(-bad, None))
    main = last[next(iter(table.data_vars))]
    assert main.isnull().all()
    assert "status" not in last or (last.status >= labels.NOT_CONVERGED).all()


def compare(verb, good, beside, bad, invalid=INVALID, **tolerance):
    alone = [verb([one], [two]) for one, two in zip(good, beside, strict=True)]
    cells = [*good, *bad, *invalid]
    table = verb(cells, [*beside, *[beside[0]] * (len(cells) - len(good))])
    check(table, alone, len(invalid), **tolerance)


def over(verbs, long=()):
    """The functions as parameters of a test, of which ``make test`` leaves out the long ones."""
    assert set(long) <= set(verbs)
    return pytest.mark.parametrize(
        "verb",
        [
            pytest.param(verb, id=name, marks=[pytest.mark.slow] * (name in long))
            for name, verb in verbs.items()
        ],
    )


@over(
    SAME_BITS, {name for name in SAME_BITS if "white" in name or "Clough" in name or "Wen" in name}
)
def test_a_cell_has_the_numbers_that_it_has_alone(verb):
    compare(verb, GOOD, BESIDE, HARD + HARDEST * (verb in LINEARIZED.values()))


@pytest.mark.filterwarnings("ignore:.*peak_[12] = ")
@over(OF_PERIODS)
def test_numbers_of_other_kinds_have_the_numbers_that_they_have_alone(verb):
    compare(verb, GOOD, BESIDE, HARD, INVALID[:3])


@over(ROUNDED, set(ROUNDED) - {"correlate, drift, Kanai-Tajimi", "system, anderson"})
def test_a_system_has_the_numbers_that_it_has_alone(verb):
    compare(verb, GOOD, BESIDE, HARD[:3] + HARDEST[:2], rtol=1e-9, atol=1e-14)


@over(IN_TIME, set(IN_TIME) - {"transient_response"})
def test_a_motion_in_time_has_the_moments_that_it_has_alone(verb):
    compare(verb, GOOD[:2], BESIDE[:2], HARD[:1], INVALID[:4], rtol=2e-4, atol=1e-7)


@over(SIMULATED)
def test_simulated_cells_are_those_of_the_table_without_the_bad_ones(verb):
    without = verb(GOOD, BESIDE)
    table = verb(GOOD + INVALID, BESIDE + [BESIDE[0]] * len(INVALID))
    alone = [without.isel(case=[n]) for n in range(len(GOOD))]
    check(table, alone, len(INVALID), rtol=1e-5, atol=1e-9)  # steps of the formulas beside them


@over(ONE_BY_ONE, {"separation"})
def test_a_cell_that_is_simulated_alone_has_the_same_bits(verb):
    compare(verb, GOOD[:1], BESIDE[:1], HARDEST[:1])


def test_a_structure_that_falls_has_a_status_and_its_neighbours_their_numbers():
    """Its moments end, and with them those of all that are followed together."""
    falls = (0.5, 0.05, -0.3, 25.0)
    verb = IN_TIME["transient_response"]
    with pytest.raises(ArithmeticError, match="falls"):
        verb([falls], BESIDE[:1])
    table = verb([GOOD[0], falls], [BESIDE[0]] * 2)
    assert table.status.values.tolist() == [labels.CONVERGED, labels.NOT_CONVERGED]
    check(table, [verb(GOOD[:1], BESIDE[:1])], 1)
