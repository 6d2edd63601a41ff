"""Records and structures at the ends of all allowed ranges, and tables of very many cells."""

import resource

import numpy as np
import pytest
import xarray as xr
from motions import motion, shaking

import stochlin as sl
from stochlin.applications.records.cells import checked_motions
from stochlin.kernels.records.runs import peaks_on_records
from stochlin.solver.tables import labels

pytestmark = [pytest.mark.invariant, pytest.mark.filterwarnings("ignore:.*(its peak is|period = )")]


@pytest.mark.parametrize("largest", [1.001e9, 1e155, -1e300])
def test_larger_accelerations_are_refused(largest):
    record = shaking(40)
    record[7] = largest
    structure = sl.Bilinear(1.0, 0.05)
    for call in (
        lambda: sl.recorded_gap(structure, structure, record),
        lambda: sl.respond(structure, record),
        lambda: sl.response_spectrum(record, 1.0, 0.05),
        lambda: sl.pseudo_energy_radius(record, 1.0, 0.05),
        lambda: sl.fit_ground(record),
        lambda: sl.fit_motion(record),
        lambda: sl.scale_records({"a": record}, pga=1.0),
    ):
        with pytest.raises(ValueError, match=r"m/s\^2 at 0\.14 s; allowed: at most 1e\+09 m/s\^2"):
            call()


@pytest.mark.filterwarnings("ignore::stochlin.messages.ImplausibleInput")
@pytest.mark.parametrize("dt", [1e-10, 1e10, 1e-310])
def test_other_time_steps_are_refused(dt):
    record = motion(np.sin(np.arange(40.0)), dt)
    with pytest.raises(
        ValueError, match=r"time step of record is .* allowed: 1e-09 <= value <= 1e\+09"
    ):
        sl.response_spectrum(record, 1e9, 0.05)


def extremes(rng, cells, dt):
    """Structures with parameters at both ends of their ranges, and between."""

    def between(low, high):
        return 10 ** rng.choice([low, high, rng.uniform(low, high)], cells)

    period = np.clip(dt * between(-1, 18), max(1e-9, dt / 10), min(1e9, 1e4 * dt))
    uy = np.where(rng.random(cells) < 0.3, 1e300, between(-300, 60))
    hardening = np.where(rng.random(cells) < 0.2, -between(-9, -0.1), between(-300, 0))
    damping = np.clip(between(-300, 0), 0, 1 - 1e-12)
    return {"period": period, "damping": damping, "hardening": hardening, "yield_displacement": uy}


@pytest.mark.parametrize("seed", range(30))
def test_no_number_is_lost_without_a_status(seed):
    """Every number is finite, infinite by a fall, or NaN with a status that says so."""
    rng = np.random.default_rng(seed)
    dt = 10 ** rng.choice([-9.0, 9.0, rng.uniform(-9, 9)])
    size = 10 ** rng.choice([9.0, -300.0, rng.uniform(-12, 9)])
    values = size * rng.uniform(-1, 1, 60)
    record = motion(values, dt)
    first, second = extremes(rng, 60, dt), extremes(rng, 60, dt)
    spectrum = sl.response_spectrum(record, **first)
    gap = sl.recorded_gap(*(sl.Bilinear(**each) for each in (first, second)), record)
    failed = (labels.NOT_CONVERGED, labels.INVALID_INPUT)
    for table, peaks in ((spectrum, ["displacement_max"]), (gap, ["peak_1", "peak_2"])):
        fell = np.any([np.isposinf(table[name]) for name in peaks], axis=0)
        lost = table.status.isin(failed).to_numpy()
        for name, values in table.data_vars.items():
            assert (np.isfinite(values) | fell | lost).all(), name
            if values.dtype.kind == "f":
                assert np.isnan(values.to_numpy()[lost]).all(), name
        assert (first["hardening"][fell] < 0).all() or (second["hardening"][fell] < 0).any()
        if size > 1e-60:
            assert not (table.status == labels.NOT_CONVERGED).any()


def test_a_lone_case_that_is_lost_raises():
    """The squares of the displacements are below the smallest number, so that rho is 0/0."""
    structures = sl.Bilinear(1.0, 0.05), sl.Bilinear(0.5, 0.05)
    with pytest.raises(ArithmeticError, match="not a number"):
        sl.recorded_gap(*structures, 1e-200 * shaking(40))


def test_very_many_cells_are_refused_before_they_cost_memory():
    axes = [xr.DataArray(np.linspace(1, 2, 100_000), dims=name) for name in ("a", "b")]
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(ValueError, match=r"^the table would take .* GB; allowed: "):
        sl.response_spectrum(shaking(40), axes[0], axes[1] / 10)
    with pytest.raises(ValueError, match=r"^the table would take .* GB; allowed: "):
        sl.recorded_gap(sl.Bilinear(axes[0], 0.05), sl.Bilinear(axes[1], 0.05), shaking(40))
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 50_000  # kB


def test_a_table_without_a_valid_cell_has_only_its_status():
    table = sl.response_spectrum(shaking(40), [-1.0, -2.0], 0.05)
    assert (table.status == labels.INVALID_INPUT).all()
    assert table.displacement_max.isnull().all()


def test_blocks_of_cells_have_the_numbers_of_single_cells():
    rng = np.random.default_rng(0)
    grounds = checked_motions([shaking(50, seed) for seed in (0, 1)]).grounds
    sides = [
        np.column_stack(
            [10 ** rng.uniform(0, 3, 5000), rng.uniform(0.01, 0.5, 5000), np.full(5000, 0.1), uy]
        )
        for uy in 10 ** rng.uniform(-4, 0, (2, 5000))
    ]
    shares = []
    together = peaks_on_records(grounds, *sides, progress=shares.append)
    assert len(shares) > 3
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
    for cell in rng.integers(0, 5000, 40):
        alone = peaks_on_records(grounds, *(side[[cell]] for side in sides))
        np.testing.assert_array_equal(together[:, [cell]], alone)
