"""Ground motions with an evolutionary spectrum: against envelopes, other grounds and random phases."""

import numpy as np
import pytest
import xarray as xr

import stochlin as sl
from stochlin.kernels.linearization.modulated_filters import RowsFilter, shortest_series
from stochlin.messages import DoubtfulInput

pytestmark = pytest.mark.oracle

QUAKE = sl.GammaEnvelope(power=2.0, decay=0.5)
DURATION = 12.0
FIRM = sl.KanaiTajimi(2 * np.pi / 15, 0.6, intensity=0.01)
WHITE = sl.WhiteNoise(0.01)
ELASTIC = sl.Bilinear(1.0, 0.05)
YIELDING = sl.Bilinear(0.6, 0.05, 0.2, yield_displacement=0.02)


def fading(time, frequency):
    """High frequencies come first and die out first."""
    high = frequency**2 / (8.0**2 + frequency**2)
    return QUAKE.at(time) * (1 - high) + 1.5 * QUAKE.at(2 * time) * high


def worst(found, expected):
    """Largest difference over time, over the largest value."""
    names = ("displacement_std", "velocity_std", "z_std", "c_eq", "k_eq")
    return max(
        float(abs(found[name] - expected[name]).max() / max(abs(expected[name]).max(), 1e-30))
        for name in names
    )


@pytest.mark.parametrize("structure", [ELASTIC, YIELDING], ids=["elastic", "yielding"])
@pytest.mark.parametrize("ground", [WHITE, FIRM], ids=["white", "firm"])
def test_a_modulation_of_time_alone_is_the_envelope(structure, ground):
    found = sl.transient_response(
        structure, ground, DURATION, modulation=lambda time, frequency: QUAKE.at(time)
    )
    expected = sl.transient_response(structure, ground, DURATION, envelope=QUAKE)
    assert worst(found, expected) < 1e-9
    np.testing.assert_allclose(found.envelope, expected.envelope, rtol=1e-12)
    assert found.attrs["strong_shaking_end_s"] == expected.attrs["strong_shaking_end_s"]
    assert found.attrs["modulation_terms"] == 1


@pytest.mark.parametrize(
    ("structure", "tolerance"), [(ELASTIC, 1e-9), (YIELDING, 1e-6)], ids=["elastic", "yielding"]
)
def test_white_noise_modulated_by_the_root_of_a_spectrum_is_that_ground(structure, tolerance):
    """The series has some thirty terms here; the other side has the filter itself.

    Coefficients of yielding structures are accurate to 1e-6.
    """
    found = sl.transient_response(
        structure,
        WHITE,
        DURATION,
        modulation=lambda t, w: QUAKE.at(t) * np.sqrt(FIRM.psd(w.ravel()).values / FIRM.intensity),
    )
    assert found.attrs["modulation_terms"] > 20
    assert worst(found, sl.transient_response(structure, FIRM, DURATION, envelope=QUAKE)) < tolerance


def test_cells_of_a_table_have_the_same_modulation():
    periods = xr.DataArray([0.5, 1.1], dims="period")
    intensities = xr.DataArray([0.003, 0.03], dims="intensity")
    options = {"duration": DURATION, "modulation": fading, "points": 7}
    table = sl.transient_response(
        sl.Bilinear(periods, 0.05), sl.WhiteNoise(intensities), **options
    ).displacement_std
    for i in range(2):
        for j in range(2):
            alone = sl.transient_response(
                sl.Bilinear(float(periods[i]), 0.05), sl.WhiteNoise(float(intensities[j])), **options
            ).displacement_std
            np.testing.assert_allclose(
                table.isel(period=i, intensity=j), alone, rtol=1e-8, atol=1e-8 * float(alone.max())
            )


@pytest.mark.parametrize(
    ("weight", "function", "first"),
    [
        (lambda w: 1 / (1 + w**2), np.cos, 0.0),
        (lambda w: w / (1 + w**2), np.sin, 1.0),
        (lambda w: 1 / np.sqrt(1 + w**2), np.cos, 0.5),
        (lambda w: w / np.sqrt(1 + w**2), np.sin, 0.5),
    ],
    ids=["even", "odd", "even, then odd", "odd, then even"],
)
@pytest.mark.parametrize("ground", [WHITE, FIRM], ids=["white", "firm"])
def test_outputs_behind_all_pass_filters_have_the_modulated_spectrum(weight, function, first, ground):
    """At all frequencies, with the same turn of phases at all times."""
    soil = RowsFilter.of(ground.lone_filter().arrays)

    def modulation(times, frequencies):
        return np.exp(-times[:, None]) * weight(frequencies / 7) + times[:, None] * weight(
            frequencies / 5
        )

    times = np.linspace(0, 3, 7)
    series = shortest_series(modulation, times, [4.0, 6.0])
    assert (series.function, series.orders[0]) == (function, first)
    whole = series.modulated(soil)
    frequencies = np.array([0.0, 0.1, 3.0, 11.0, 80.0])
    unit = np.eye(whole.noise.size)
    outputs = np.array(
        [whole.rows @ np.linalg.solve(1j * w * unit - whole.matrix, whole.noise) for w in frequencies]
    )
    amplitudes = series.amplitudes(modulation(times, series.frequencies))
    found = amplitudes @ (outputs + whole.direct).T
    expected = modulation(times, frequencies) * np.sqrt(
        ground.psd(frequencies).values / ground.intensity
    )
    np.testing.assert_allclose(abs(found), expected, atol=1e-9 * expected.max())
    turns = found[:, 1:] * found[0, 1:].conj()
    np.testing.assert_allclose(turns, expected[:, 1:] * expected[0, 1:], atol=1e-9 * expected.max() ** 2)


STEP, WIDTH, LAST = 0.005, 0.2, 60.0  # [s], [rad/s]; the waves repeat after 31 s
WAVES = np.arange(WIDTH / 2, LAST, WIDTH)
INSTANTS = np.arange(0, DURATION + STEP / 2, STEP)


def waves(modulation):
    """Cosine and sine waves (times, 2 waves); half their squares sum up to its variance."""
    amplitude = np.sqrt(4 * FIRM.psd(WAVES).values * WIDTH) * modulation(INSTANTS[:, None], WAVES)
    angle = INSTANTS[:, None] * WAVES
    return np.concatenate([amplitude * np.cos(angle), amplitude * np.sin(angle)], axis=1)


def responses(structure, motions, spring):
    """Displacements (times, paths) to motions by central differences.

    ``spring(n, z, change)`` is the next plastic spring's displacement ``z`` for a change of ``u``.
    """
    w, share = 2 * np.pi / structure.period, structure.hardening if structure.yields else 1.0
    friction = structure.damping * w * STEP
    u, rate, z, rows = *np.zeros((3, motions.shape[1])), []
    for n, motion in enumerate(motions):
        rows.append(u)
        force = motion - w**2 * (share * u + (1 - share) * z)
        rate = (rate * (1 - friction) + STEP * force) / (1 + friction)
        z = spring(n, z, STEP * rate)
        u = u + STEP * rate
    return np.array(rows)


def linearized(table):
    """The spring with the coefficients of a result, ``z' = -c_eq u' - k_eq z``."""
    c, k = (np.interp(INSTANTS + STEP / 2, table.time, table[name]) for name in ("c_eq", "k_eq"))
    return lambda n, z, change: (z * (1 - k[n] * STEP / 2) - c[n] * change) / (1 + k[n] * STEP / 2)


def yielding(n, z, change):
    """The elastic and perfectly plastic spring."""
    return np.clip(z + change, -YIELDING.yield_displacement, YIELDING.yield_displacement)


@pytest.mark.parametrize("structure", [ELASTIC, YIELDING], ids=["elastic", "yielding"])
def test_the_variance_is_the_sum_over_all_waves(structure):
    """Without any sampling: each wave alone, with the coefficients of the result where it yields.

    The steps of 0.005 s leave 4e-4 of the largest standard deviation; with 0.01 s it is four times that.
    """
    table = sl.transient_response(structure, FIRM, DURATION, modulation=fading, points=601)
    u = responses(structure, waves(fading), linearized(table))
    std = np.sqrt(0.5 * (u**2).sum(axis=1))
    np.testing.assert_allclose(std[::4], table.displacement_std, rtol=0, atol=6e-4 * std.max())


@pytest.mark.slow
@pytest.mark.parametrize(
    ("structure", "until", "bias"), [(ELASTIC, 12, 0.0), (YIELDING, 4, 0.1)], ids=["elastic", "yielding"]
)
def test_motions_with_random_phases_have_these_deviations(structure, until, bias):
    """4000 motions tell a standard deviation to 1.1 %.

    Linearization of the yielding structure is within 10 % for 4 s. Later its plastic drift is missing.
    """
    paths = 4000
    phases = np.random.default_rng(11).uniform(0, 2 * np.pi, (WAVES.size, paths))
    motions = waves(fading) @ np.concatenate([np.cos(phases), -np.sin(phases)])
    std = responses(structure, motions, yielding).std(axis=1)[200::200][:until]
    options = {"structure": structure, "ground": FIRM, "duration": DURATION, "points": 13}
    table = sl.transient_response(**options, modulation=fading)
    tolerance = 4 / np.sqrt(2 * paths) + bias
    np.testing.assert_allclose(table.displacement_std[1 : until + 1], std, rtol=tolerance)
    uniform = sl.transient_response(**options, envelope=QUAKE).displacement_std[1 : until + 1]
    assert abs(uniform / std - 1).max() > 2 * tolerance


REFUSED = {
    "negative": (lambda t, w: 1 - t + 0 * w, "modulation is -.* at the time .* rad/s; allowed: finite"),
    "not finite": (lambda t, w: np.where(t > 3, np.inf, w), "modulation is inf .* from 0 on"),
    "zero": (lambda t, w: 0 * t, "modulation is 0 during the whole duration = 12"),
    "shape": (lambda t, w: np.ones(3), r"array of shape \(3,\) .* or what broadcasts"),
    "grows": (lambda t, w: w + 0 * t, "48 terms over frequency leave out .* smoother .* a limit"),
}


@pytest.mark.parametrize(("modulation", "message"), REFUSED.values(), ids=list(REFUSED))
def test_modulations_out_of_range_are_refused(modulation, message):
    with pytest.raises(ValueError, match=message):
        sl.transient_response(ELASTIC, FIRM, DURATION, modulation=modulation)


def test_modulations_of_another_kind_are_refused():
    for other in (3, QUAKE.at):
        with pytest.raises(TypeError, match=r"modulation = .*; allowed: a function of time and freq"):
            sl.transient_response(ELASTIC, FIRM, DURATION, modulation=other)
    with pytest.raises(TypeError, match=r"modulation\(time, frequency\) = .*; allowed: real numbers"):
        sl.transient_response(ELASTIC, FIRM, DURATION, modulation=lambda t, w: np.exp(1j * w * t))
    with pytest.raises(ValueError, match=r"envelope and modulation do not go together; multiply"):
        sl.transient_response(ELASTIC, FIRM, DURATION, envelope=QUAKE, modulation=fading)


@pytest.mark.slow
def test_what_a_rough_modulation_loses_is_said():
    """A jump over frequency; the result is nearer to the sum over waves than the warning says."""

    def jump(time, frequency):
        return QUAKE.at(time) * (frequency < 10)

    with pytest.warns(DoubtfulInput, match=r"48 terms over frequency leave out 0\.0"):
        table = sl.transient_response(ELASTIC, FIRM, DURATION, modulation=jump, points=601)
    u = responses(ELASTIC, waves(jump), lambda n, z, change: z)
    std = np.sqrt(0.5 * (u**2).sum(axis=1))
    error = abs(std[::4] - table.displacement_std).max() / std.max()
    assert error < table.attrs["modulation_error"]
