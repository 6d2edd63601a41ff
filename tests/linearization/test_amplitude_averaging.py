"""The narrow-band closure where three amplitudes are possible, beside a search over all of them."""

import numpy as np
import pytest

import stochlin as sl
from stochlin.kernels.linearization.amplitude_averaging import equivalent_system
from stochlin.kernels.linearization.covariance import own_covariance

pytestmark = pytest.mark.oracle


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
def test_of_three_solutions_the_smallest_is_taken(share):
    """Yielding tunes the structure to the ground, whose period is more than three times as long.

    The strength of the ground is between those at which two of the solutions vanish.
    """
    period, damping, hardening = 0.6, 0.001, 0.02
    ground = sl.KanaiTajimi(period=2.0, damping=0.01)
    assumed = np.geomspace(0.01, 1e3, 20_001)
    shape = [np.full(assumed.size, value) for value in (2 * np.pi / period, damping, hardening)]
    system = equivalent_system(assumed, *shape)
    forcing = ground.lone_filter().at(np.zeros(assumed.size, int)).forcing(system)
    # Assumed over computed standard deviation on this ground, for a yield displacement of 1 m.
    ratio = assumed / np.sqrt(own_covariance(system, forcing).mu_mu)
    falls = np.flatnonzero(np.diff(ratio) < 0)
    top, bottom = np.log(ratio[[falls[0], falls[-1] + 1]])
    strength = np.exp(bottom + share * (top - bottom))  # at which the two standard deviations agree
    (crossings,) = np.nonzero(np.diff(ratio > strength))
    assert crossings.size == 3
    structure = sl.Bilinear(period, damping, hardening, yield_displacement=1 / strength)
    found = strength * sl.linearize(structure, ground, "narrow_band").displacement_std
    assert assumed[crossings[0]] <= float(found) <= assumed[crossings[0] + 1]
