"""What simulated references tell of two drifting structures: algebra, limits, simulations."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

import stochlin as sl
from stochlin.kernels.correlation.corrections import ADDED_VARIANCE, PARAMETER_AXES, by_signatures
from stochlin.solver.correlation.signatures import OFF_DIAGONAL, UNIT_SHARE, basis_of, corrected
from stochlin.solver.linearization.drift_map import drift_map
from stochlin.solver.simulation import stationary_motions

pytestmark = [pytest.mark.oracle, pytest.mark.extreme]

ROOT = Path(__file__).parents[2]
LAKEBED = sl.KanaiTajimi(period=1.0, damping=0.05)


def building(period=1.0, reduction_factor=4.0, hardening=0.05, damping=0.05):
    return sl.Bilinear(period, damping, hardening, reduction_factor=reduction_factor)


def load(name):
    """A benchmark as a module."""
    spec = importlib.util.spec_from_file_location(name, ROOT / "benchmarks" / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def signature(joint, gram):
    """From correlations (..., k) with the references, and those among them, eq. (9)."""
    return (basis_of(gram) @ joint[..., None])[..., 0]


def correlations(rng, size, rank):
    """A random correlation matrix."""
    factor = rng.standard_normal((size, rank))
    factor /= np.linalg.norm(factor, axis=1, keepdims=True)
    return factor @ factor.T


# --- algebra
# ----------------------------------------------------------------------------------------


@settings(deadline=None, max_examples=100)
@given(st.integers(0, 2**32 - 1), st.integers(1, 8), st.integers(1, 12))
def test_correlation_is_a_projection_and_what_is_left_of_it(seed, references, rank):
    rng = np.random.default_rng(seed)
    derived, simulated = (correlations(rng, references + 2, rank) for _ in range(2))

    def seen(matrix):
        return [signature(matrix[n, 2:], matrix[2:, 2:])[:, None] for n in (0, 1)]

    own, known = seen(derived), seen(simulated)
    both = [corrected(d, k - d) for d, k in zip(own, known, strict=True)]
    rho = by_signatures(derived[:1, 1], *both)[0]
    # The same by partial correlations with the references, which have a share of their own.
    blurred = [
        (1 - UNIT_SHARE) * matrix[2:, 2:] + UNIT_SHARE * np.eye(references)
        for matrix in (derived, simulated)
    ]

    # Where a correction is large, the simulated signature is shortened, as another test says.
    shorter = [
        np.linalg.norm(each.simulated) / np.linalg.norm(k)
        for each, k in zip(both, known, strict=True)
    ]

    def explained(matrix, gram, i, j):
        scale = shorter[i] * shorter[j] if matrix is simulated else 1.0
        return scale * (1 - UNIT_SHARE) * matrix[i, 2:] @ np.linalg.solve(gram, matrix[j, 2:])

    left_derived, left = (
        [1 + ADDED_VARIANCE - explained(matrix, gram, n, n) for n in (0, 1)]
        for matrix, gram in zip((derived, simulated), blurred, strict=True)
    )
    partial = derived[0, 1] + ADDED_VARIANCE - explained(derived, blurred[0], 0, 1)
    partial /= np.sqrt(left_derived[0] * left_derived[1])
    assert abs(partial) <= 1 + 1e-9
    expected = (
        explained(simulated, blurred[1], 0, 1)
        + partial * np.sqrt(left[0] * left[1])
        - ADDED_VARIANCE
    )
    assert rho == pytest.approx(expected, abs=1e-9)
    assert -1 - 2 * ADDED_VARIANCE - 1e-9 <= expected <= 1 + 1e-9


def test_signatures_are_shortened_smoothly_to_length_one():
    """By less than a thousandth where they are shorter than 0.9, and without a kink beyond."""
    own = np.zeros((1, 2001))
    correction = np.linspace(0.0, 2.0, own.size)[None]
    known = corrected(own, correction).simulated[0]
    assert (known <= 1).all()
    assert (np.diff(known) > 0).all()
    short = correction[0] < 0.9
    np.testing.assert_allclose(known[short], correction[0, short], rtol=0.04)
    slope = np.gradient(known, correction[0])
    assert np.abs(np.diff(slope)).max() < 0.02  # a limit without rounding has a step of 1


@settings(deadline=None, max_examples=5)
@given(st.integers(0, 2**32 - 1))
def test_a_form_is_found_from_the_correlations_of_its_neighbours(seed):
    """``1 - rho = q/(1 + q)`` with ``q = d' M d``, for the differences ``d`` of five structures."""
    draw = np.random.default_rng(seed)
    roots, steps = (
        draw.uniform(0.5, 3.0, (PARAMETER_AXES, PARAMETER_AXES)),
        draw.uniform(0.02, 0.2, PARAMETER_AXES),
    )
    matrix = roots @ roots.T + np.eye(PARAMETER_AXES)
    places = np.concatenate([np.zeros((1, PARAMETER_AXES)), np.diag(steps)])
    apart = places[:, None] - places
    form = np.einsum("ijk,kl,ijl->ij", apart, matrix, apart)
    found = load("drift_map").form_of((form / (1 + form))[..., None], steps)[:, 0]
    slopes = np.sqrt(np.diag(matrix))
    np.testing.assert_allclose(found[:PARAMETER_AXES], np.log(slopes), rtol=0, atol=1e-10)
    across = [matrix[pair] / (slopes[pair[0]] * slopes[pair[1]]) for pair in OFF_DIAGONAL]
    np.testing.assert_allclose(found[PARAMETER_AXES:], across, rtol=0, atol=1e-9)


# --- the map that ships
# -----------------------------------------------------------------------------


@pytest.mark.slow
def test_shipped_signatures_are_those_simulated_anew(monkeypatch):
    """One part of the map, with other motions: within its standard errors."""
    module = load("drift_map")
    # as its main function does
    monkeypatch.setattr(stationary_motions, "MOST_STEPS_FOR_DRIFT", np.inf)
    point = {"elastic_ductility_std": 2.0, "hardening": 0.2, "ground_damping": 0.17}
    result = module.part(*point.values(), seed=2)
    corrections = drift_map().signature_correction.rename(
        signature_strength="elastic_ductility_std"
    )
    shipped = corrections.sel(point)
    periods, dampings = shipped.signature_period.values[::7], [0.02, 0.1]
    structure, ground = module.grid(periods, dampings)
    ground = sl.KanaiTajimi(1.0, point["ground_damping"])
    derived = module.derived(structure, ground).sel(elastic_ductility_std=2.0, hardening=0.2)
    simulated = signature(result["joint"], result["gram"])[[1, 3]][:, ::7]
    found = simulated - derived.transpose("damping", "period", ...).values
    kept = shipped.sel(damping=dampings).values[:, ::7]
    # Standard errors of a coordinate are some 0.01: see below for the mean.
    assert np.abs(found - kept).max() < 0.08
    assert np.abs(found - kept).mean() < 0.012
    assert np.abs(kept).mean() > 0.03


@pytest.mark.slow
def test_shipped_displacements_are_those_simulated_anew(monkeypatch):
    """The coarse grid and white noise, with other motions; few beyond 3 standard errors."""
    module = load("drift_map")
    monkeypatch.setattr(stationary_motions, "MOST_STEPS_FOR_DRIFT", np.inf)
    monkeypatch.setattr(module, "STRUCTURE_STEPS", 1e8)
    for ground_damping in (0.17, np.inf):
        result = module.coarse_part(2.0, 0.2, ground_damping, seed=7)
        dampings = xr.DataArray(list(module.COARSE["damping"]), dims="damping")
        periods = xr.DataArray(module.COARSE_PERIOD, dims="period")
        ground = (
            sl.WhiteNoise() if np.isinf(ground_damping) else sl.KanaiTajimi(1.0, ground_damping)
        )
        table = sl.linearize(module.building(periods, 2.0, 0.2, dampings), ground, "drift")
        off = table.ductility_std.transpose("damping", "period") / result["ductility_std"] - 1
        assert (np.abs(off) > 3 * result["error"].max() + 0.01).sum() <= 5


# --- pairs
# ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("first", "second", "damping"),
    [
        (building(0.35, 2.3, 0.05, 0.02), building(0.34, 8.6, 0.03, 0.09), 0.05),
        (building(0.29, 2.0, 0.09, 0.02), building(0.38, 1.2, 0.37, 0.02), 0.05),
        (building(0.49, 2.4, 0.2, 0.015), building(0.6, 8.5, 0.12, 0.03), 0.04),
    ],
)
def test_stiff_unequal_pairs_on_narrow_band_ground(first, second, damping):
    """Where the derivation alone is off by 0.3 to 0.5."""
    ground = sl.KanaiTajimi(1.0, damping)
    table = sl.correlate(first, second, ground, closure="drift")
    exact = sl.simulate([first, second], ground, paths=128, seed=11, steps_per_period=16)
    error = exact.rho_standard_error[0, 1]
    assert abs(table.rho - exact.rho[0, 1]) < 0.1 + 4 * error  # the 95th percentile of 500 pairs
    assert abs(table.rho - exact.rho[0, 1]) < 4 * table.rho_error + 4 * error


def test_cautions_are_those_of_each_cell():
    period = xr.DataArray([0.09, 0.3, 1.0, 9.0, 11.0], dims="T")
    table = sl.correlate(building(period), building(1.5, 5.0, 0.1), LAKEBED, closure="drift")
    assert table.caution.values.tolist() == [2, 0, 0, 0, 2]  # beyond T/Tg
    assert np.isnan(table.rho_error.values[[0, 4]]).all()
    assert (table.rho_error.values[1:4] > 0).all()
    assert np.isfinite(table.rho).all()
    narrow = sl.KanaiTajimi(1.0, 0.02)
    assert int(sl.correlate(building(), building(1.5), narrow, closure="drift").caution) == 2
    for high_pass_period, caution in ((10.0, 0), (40.0, 2)):
        penzien = sl.CloughPenzien(
            1.0, 0.3, high_pass_period=high_pass_period, high_pass_damping=0.6
        )
        table = sl.correlate(building(), building(1.5), penzien, closure="drift")
        assert int(table.caution) == int(table.relative_displacement_caution) == caution
    elastic = sl.correlate(sl.Bilinear(1.0, 0.05), sl.Bilinear(9.0, 0.05), LAKEBED, closure="drift")
    assert float(elastic.rho_error) == 0
