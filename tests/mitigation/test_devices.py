"""Force, stroke and energy of links and dampers, by `simulate`, `pound` and `mitigate`."""

import numpy as np
import pytest
import xarray as xr

import stochlin as sl

MASS, PERIOD, DAMPING = 1e6, 1.0, 0.05
STIFF = sl.Kelvin(stiffness=1e9, restitution=0.65)
FIRM = sl.named_ground("firm", intensity=0.01)
LINKS = [
    sl.Link(2e7, 2e6, structures=(1, 2)),
    sl.Link(3e7, 1e6, hardening=0.05, yield_displacement=0.004, structures=(2, 2), floors=(1, 0)),
    sl.Link(1e6, 1e6, damping_exponent=0.5, structures=(1, 2)),
]
OF_LINKS = "peak_link_force", "peak_link_stroke", "link_energy"


def pair():
    return [
        sl.Bilinear(PERIOD, DAMPING, mass=MASS),
        sl.Bilinear(0.6, DAMPING, 0.05, yield_displacement=0.02, mass=MASS),
    ]


def harmonic(frequency, amplitude=1.0, duration=60.0, dt=0.005):
    time = dt * np.arange(round(duration / dt) + 1)
    return xr.DataArray(
        amplitude * np.sin(frequency * time),
        dims="time",
        coords={"time": time},
        attrs={"units": "m/s^2"},
    )


@pytest.mark.parametrize("within_storey", [False, True])
def test_energy_of_a_damper_in_white_noise_is_c_times_the_variance_of_its_velocity(within_storey):
    """A damper in an elastic oscillator from rest on white noise.

    The noise puts ``pi S0 m`` into the oscillator in each second, whatever its state. What is not
    in it at the end, ``m E[v^2] = pi S0 m/(2 xi w)``, has gone into both dashpots, by their
    constants. In steps of the trapezoidal rule the input is smaller by ``1 + xi w dt + (w
    dt/2)^2``.
    """
    w, s0, seconds = 2 * np.pi / PERIOD, 0.01, 40.0
    device = sl.Link(0.0, 0.2 * MASS * w, structures=(1, 1), floors=(1, 0))
    structure = sl.Bilinear(PERIOD, DAMPING, mass=MASS)
    if within_storey:
        structure = sl.ShearBuilding([MASS], [MASS * w**2], [9.0], DAMPING)
    table = sl.simulate(
        [structure], sl.WhiteNoise(s0), paths=1024, duration=seconds, link=[device], seed=3
    )
    xi, dt = DAMPING + 0.1, table.attrs["step_s"]
    put_in = np.pi * s0 * MASS * seconds / (1 + xi * w * dt + (w * dt / 2) ** 2)
    velocity_variance = np.pi * s0 / (2 * xi * w)
    expected = 0.1 / xi * (put_in - MASS * velocity_variance)
    found, error = (float(table[f"link_energy_mean{end}"][0]) for end in ("", "_standard_error"))
    assert abs(found - expected) < 4 * error
    assert error < 0.01 * expected
    # c E[v^2] T of the stationary response, less what the beginning from rest lacks, 1/(2 xi w) in
    # time
    stationary = device.damping_constant * velocity_variance * (seconds - 1 / (2 * xi * w))
    assert abs(found - stationary) < 4 * error + 0.05 * stationary
    np.testing.assert_allclose(table.peak_link_stroke[:, 0], table.peak.values[:, 0], rtol=1e-12)


def test_links_in_simulated_motions_are_those_of_pound():
    """The same motions by the other engine, whose energies balance; steps and forcing differ."""
    table = sl.simulate(pair(), FIRM, paths=32, duration=8.0, link=LINKS, steps_per_period=100)
    motions = sl.simulated_motions(FIRM, 8.0, paths=32, step=table.attrs["step_s"])
    row = sl.pound(pair(), 0.8, STIFF, motions, link=LINKS)
    assert int(row.impacts.sum()) == 0
    for name in OF_LINKS:
        scale = row[name].mean("path")
        np.testing.assert_allclose(table[name] / scale, row[name] / scale, atol=0.01, err_msg=name)
    for name in OF_LINKS:
        np.testing.assert_allclose(table[f"{name}_mean"], table[name].mean("path"), rtol=1e-12)


def test_a_linear_damper_in_a_harmonic_motion_dissipates_pi_c_w_a_squared_in_each_cycle():
    w, seconds = 6.0, 80.0
    device = sl.Link(1e6, 3e6, structures=(1, 1), floors=(1, 0))
    alone = sl.Bilinear(PERIOD, DAMPING, mass=MASS)
    (long, short) = (
        sl.pound([alone], motion=harmonic(w, duration=T), link=[device])
        for T in (seconds + 8 * np.pi / w, seconds)
    )
    own = 2 * np.pi / PERIOD
    k, c = MASS * own**2 + 1e6, 2 * DAMPING * own * MASS + 3e6
    amplitude = MASS / np.hypot(k - MASS * w**2, c * w)
    lost = float(long.link_energy[0] - short.link_energy[0])
    ran = float(long.time[-1] - short.time[-1])
    assert lost == pytest.approx(0.5 * 3e6 * (w * amplitude) ** 2 * ran, rel=5e-3)
    force = amplitude * np.hypot(1e6, 3e6 * w)
    last = long.link_force[-500:, 0]
    assert float(np.abs(last).max()) == pytest.approx(force, rel=2e-3)


def test_devices_of_measures_are_those_of_simulate():
    tower = sl.ShearBuilding([2e5] * 3, [2e8] * 3, [3.0] * 3, 0.05)
    low = sl.ShearBuilding([2e5] * 2, [2e8] * 2, [3.0] * 2, 0.05)
    braces = [sl.Link(0.0, 1e6, structures=(1, 1), floors=(n, n - 1)) for n in (1, 3)]
    links = [sl.Link(1e7), *braces]
    measures = {"all": sl.Measure(link=links)}
    row = sl.mitigate(tower, low, FIRM, 0.5, measures, duration=6.0, paths=32, seed=5).sel(
        measure="all"
    )
    assert row.link_kind.values.tolist() == ["link", "damper", "damper"]
    assert row.link_place.values.tolist() == ["1.2 to 2.2", "1.1 to ground", "1.3 to 1.2"]
    motions = sl.simulate([tower, low], FIRM, paths=32, seed=5, duration=6.0, link=links)
    for name in OF_LINKS:
        np.testing.assert_allclose(row[f"{name}_mean"], motions[name].mean("path"), rtol=1e-9)
        quantile = motions[name].quantile(0.95, "path")
        np.testing.assert_allclose(row[f"{name}_quantile"], quantile, rtol=1e-9)
    drifts = motions.peak_drift_mean.sel(element=["1.1", "1.3"])
    np.testing.assert_allclose(row.peak_link_stroke_mean[1:], drifts, rtol=1e-9)
