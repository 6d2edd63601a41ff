"""Linked buildings through a motion, with and without contact."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.integrate
import xarray as xr

import stochlin as sl

pytestmark = pytest.mark.oracle

FAR = 10.0  # [m]: no contact
SPRING = sl.LinearSpring(1e8)


def record(samples=300, dt=0.02):
    noise = np.random.default_rng(7).standard_normal(samples + 10)
    values = 2.0 * np.convolve(noise, np.hanning(11), mode="valid") / 3
    return xr.DataArray(values[:samples], dims="time", coords={"time": dt * np.arange(samples)})


def pair(**law):
    return [
        sl.Bilinear(0.9, 0.03, mass=2e5, **law),
        sl.Bilinear(0.5, 0.06, mass=3e5, **law),
    ]


def reference(structures, link, motion):
    """Displacements of linear structures by another integrator of another formulation."""
    m = np.array([s.mass for s in structures])
    w = np.array([2 * np.pi / s.period for s in structures])
    xi = np.array([s.damping for s in structures])
    tie = np.array([[1.0, -1.0], [-1.0, 1.0]])
    stiffness = (np.diag(m * w**2) + link.stiffness * tie) / m[:, None]
    damping = (np.diag(2 * xi * w * m) + link.damping_constant * tie) / m[:, None]
    time, ground = motion.time.values, motion.values
    state, out = np.zeros(4), [np.zeros(2)]
    for t, a, b in zip(time[:-1], ground[:-1], ground[1:], strict=True):
        slope = (b - a) / (time[1] - time[0])

        def rates(s, x, t=t, a=a, slope=slope):
            return np.append(x[2:], -stiffness @ x[:2] - damping @ x[2:] - a - slope * (s - t))

        span = (t, t + time[1] - time[0])
        solved = scipy.integrate.solve_ivp(rates, span, state, rtol=1e-11, atol=1e-14, method="Radau")
        state = solved.y[:, -1]
        out.append(state[:2])
    return np.array(out)


@pytest.mark.parametrize(
    "link", [sl.Link(3e7, 0.0), sl.Link(0.0, 2e6), sl.Link(5e6, 4e5)], ids=("spring", "dashpot", "both")
)
def test_linear_histories(link):
    motion = record(120)
    table = sl.pound(pair(), FAR, SPRING, motion, link=link)
    exact = reference(pair(), link, motion)
    # the reference's own error, of thousands of steps to 1e-11
    np.testing.assert_allclose(table.displacement, exact, rtol=0, atol=1e-8 * abs(exact).max())
    force = link.stiffness * (exact[:, 0] - exact[:, 1])
    velocity = table.velocity[:, 0] - table.velocity[:, 1]
    force += link.damping_constant * velocity.values
    np.testing.assert_allclose(table.link_force[:, 0], force, rtol=0, atol=1e-7 * abs(force).max())


def test_a_rigid_link_makes_one_structure_of_two():
    one, two = pair()
    k = [s.mass * (2 * np.pi / s.period) ** 2 for s in (one, two)]
    c = [2 * s.damping * np.sqrt(s.mass * each) for s, each in zip((one, two), k, strict=True)]
    mass = one.mass + two.mass
    period = 2 * np.pi * np.sqrt(mass / sum(k))
    single = sl.Bilinear(period, sum(c) / (2 * np.sqrt(mass * sum(k))), mass=mass)
    stiffness = 1e4 * max(k)
    table = sl.pound([one, two], FAR, SPRING, record(), link=sl.Link(stiffness, 1e7))
    alone = sl.respond(single, record()).displacement
    size = float(abs(alone).max())
    for side in range(2):  # the link gives by its force over its stiffness, 1e-4 of the displacement
        np.testing.assert_allclose(table.displacement[:, side], alone, rtol=0, atol=5e-4 * size)


@pytest.mark.parametrize("contact", [SPRING, sl.Kelvin(1e8, restitution=0.6), sl.Stereomechanical(0.5)])
@pytest.mark.parametrize("law", [{}, {"hardening": 0.05, "yield_displacement": 0.02}])
def test_energy_is_accounted_for(contact, law):
    table = sl.pound(pair(**law), 0.005, contact, record(), link=sl.Link(2e6, 3e5))
    assert table.sizes["impact"] > 3
    assert float(table.link_lost_energy[-1]) > 0.01 * float(
        abs(table.input_energy).sum("structure").max()
    )
    assert float(table.energy_balance_error.max()) < 1e-6


def test_a_link_of_shear_buildings_is_at_the_lower_roof():
    low = sl.ShearBuilding([2e5] * 2, [1e8, 4e8], [3.0] * 2, 0.05)
    high = sl.ShearBuilding([2e5] * 4, [2e8] * 4, [3.0] * 4, 0.05)
    link = sl.Link(1e11)
    table = sl.pound([low, high], FAR, SPRING, record(), link=link)
    apart = table.displacement.sel(structure=1) - table.displacement.sel(structure=2)
    size = float(abs(table.displacement).max())
    assert float(abs(apart.sel(floor=2)).max()) < 1e-3 * size
    assert float(abs(apart.sel(floor=1)).max()) > 1e-2 * size
    assert float(table.energy_balance_error.max()) < 1e-6


def test_only_the_linked_neighbours_have_a_link():
    row = [*pair(), sl.Bilinear(0.7, 0.05, mass=1e5)]
    table = sl.pound(row, [FAR, FAR], SPRING, record(), link=[None, sl.Link(1e7)])
    assert table.link.values.tolist() == [2]
    free = sl.pound(row, [FAR, FAR], SPRING, record())
    assert "link_force" not in free
    first = [t.displacement.sel(structure=1) for t in (table, free)]
    np.testing.assert_allclose(*first, rtol=0, atol=1e-8 * float(abs(first[0]).max()))
    assert float(table.amplification.sel(structure=2)) != pytest.approx(1, abs=1e-3)
    assert float(table.amplification.sel(structure=1)) == pytest.approx(1, abs=1e-8)


@pytest.mark.parametrize(
    ("link", "told"),
    [
        ([sl.Link(1e7), None], "2 given; allowed: one between each two"),
        (["glue"], "link = 'glue' is of the wrong kind"),
        (sl.Link([1e7, 2e7]), "link: stiffness is an array"),
    ],
)
def test_bad_links(link, told):
    with pytest.raises((ValueError, TypeError), match=told):
        sl.pound(pair(), FAR, SPRING, record(), link=link)
