"""Covariances of a structure with ground filters of one or two oscillators, in closed form.

The Sylvester equation ``A C + C F' + R = 0`` of a structure with a filter oscillator ``F`` is solved in
the algebra of polynomials in ``F``: by its characteristic polynomial ``F^2 = -stiffness - e F``, so
that every element ``a + b F`` is a pair of numbers. The derivative by a coefficient of ``A`` (slip or
relaxation) solves the same equation, with the derivative of ``A`` times ``C`` in place of ``R``. Pairs
of numbers such as ``u`` are covariances of one state of the structure with the two states of an
oscillator.
"""

import math

from stochlin.kernels.basics.compiled import called_often, entry

OF_KANAI_TAJIMI = 8  # rows of an equivalent system and of a ground of one oscillator
NOTHING = 0.0, 0.0  # a pair of zeros


@called_often
def _apply(oscillator, u):
    """``F u`` with the companion matrix ``F = [[0, 1], [-stiffness, -damping]]``."""
    return u[1], -oscillator[0] * u[0] - oscillator[1] * u[1]


@called_often
def _divide(oscillator, a, b, u):
    """``(a + b F)^-1 u``, by the conjugate ``a - b e - b F``, with the damping ``e``."""
    stiffness, damping = oscillator
    norm = a * a - a * b * damping + b * b * stiffness
    fu = _apply(oscillator, u)
    conjugate = a - b * damping
    return (conjugate * u[0] - b * fu[0]) / norm, (conjugate * u[1] - b * fu[1]) / norm


@called_often
def _sylvester(system, oscillator, r_mu, r_v, r_y):
    """Rows of ``C`` for ``mu``, ``mu'`` and ``y``, from the rows ``r_mu``, ``r_v``, ``r_y`` of ``R``."""
    w2, d, h, p, k = system
    stiffness, e = oscillator
    a2, a1, a0 = d + k, w2 + d * k - h * p, (w2 - h) * k
    # D(-F) = constant + linear F, with the structure's characteristic polynomial D.
    constant = a0 - (e + a2) * stiffness
    linear = stiffness - e * e - a2 * e - a1
    moved = _apply(oscillator, r_mu)
    drive = r_v[0] + d * r_mu[0] - moved[0], r_v[1] + d * r_mu[1] - moved[1]
    moved = _apply(oscillator, drive)
    right = (
        k * drive[0] - moved[0] + h * (r_y[0] - p * r_mu[0]),
        k * drive[1] - moved[1] + h * (r_y[1] - p * r_mu[1]),
    )
    mu = _divide(oscillator, constant, linear, right)
    moved = _apply(oscillator, mu)
    velocity = -moved[0] - r_mu[0], -moved[1] - r_mu[1]
    flow = k * mu[0] + p * velocity[0] + r_y[0], k * mu[1] + p * velocity[1] + r_y[1]
    return mu, velocity, _divide(oscillator, k, -1.0, flow)


@called_often
def _signal(oscillator, rows):
    """Covariances of ``mu``, ``mu'`` and ``y`` with ``stiffness x + damping x'`` of a filter oscillator.

    ``rows`` are those with its states ``x`` and ``x'``.
    """
    (mu, mu_rate), (v, v_rate), (y, y_rate) = rows
    stiffness, damping = oscillator
    return (
        stiffness * mu + damping * mu_rate,
        stiffness * v + damping * v_rate,
        stiffness * y + damping * y_rate,
    )


@called_often
def _less(left, right):
    """Difference of two pairs of numbers."""
    return left[0] - right[0], left[1] - right[1]


@called_often
def _less3(left, right):
    """Difference of two triples of numbers."""
    return left[0] - right[0], left[1] - right[1], left[2] - right[2]


@called_often
def _of_soil(system, soil, right):
    """Covariances with the soil oscillator, and their derivatives by slip and by relaxation.

    ``right`` are the covariances of the soil's states with the ground acceleration.
    """
    rows = _sylvester(system, soil, NOTHING, right, NOTHING)
    by_slip = _sylvester(system, soil, NOTHING, NOTHING, rows[1])
    by_relaxation = _sylvester(system, soil, NOTHING, NOTHING, _less(rows[0], rows[2]))
    return rows, by_slip, by_relaxation


@called_often
def _kanai_tajimi(system, ground):
    """Forcing, its derivatives and covariances on a Kanai-Tajimi ground, eqs. (11) and (12).

    The ground acceleration is ``f = wg^2 xg + 2 xig wg xg'``.
    """
    intensity, stiffness, damping = ground
    soil = stiffness, damping
    noise = math.pi * intensity / damping, math.pi * intensity
    rows, by_slip, by_relaxation = _of_soil(system, soil, noise)
    return _signal(soil, rows), _signal(soil, by_slip), _signal(soil, by_relaxation), rows


@called_often
def _with_layer(system, layer, still, signal, gained):
    """Covariances with the high-pass oscillator, which the acceleration of the soil drives.

    ``signal`` are the covariances of the structure with this acceleration, ``still`` is that of the
    ground acceleration with the oscillator's displacement, and ``gained`` is a further right-hand side.
    """
    mu, v, y = signal
    return _sylvester(system, layer, (0.0, mu), (still, v), (gained[0], gained[1] + y))


@called_often
def _clough_penzien(system, ground):
    """Forcing, its derivatives and covariances on a Clough-Penzien ground.

    The ground acceleration is ``f = xf'' = f_soil - wf^2 xf - 2 xif wf xf'``. The high-pass oscillator
    ``xf`` is itself a linear structure on the soil. The equations are block triangular, and are solved
    first for the soil and then for the high-pass oscillator.
    """
    intensity, stiffness, damping, layer_stiffness, layer_damping = ground
    soil, layer = (stiffness, damping), (layer_stiffness, layer_damping)
    noise = math.pi * intensity / damping, math.pi * intensity
    alone = layer_stiffness, layer_damping, 0.0, 0.0, math.sqrt(layer_stiffness)
    x, v, _ = _sylvester(alone, soil, NOTHING, noise, NOTHING)
    still = -(stiffness * v[0] + damping * v[1]) / layer_damping
    # The covariances of the soil's states q with f = f_soil - wf^2 xf - 2 xif wf xf'.
    right = (
        noise[0] - layer_stiffness * x[0] - layer_damping * v[0],
        noise[1] - layer_stiffness * x[1] - layer_damping * v[1],
    )
    of_soil, soil_by_slip, soil_by_relaxation = _of_soil(system, soil, right)
    signal, by_slip, by_relaxation = (
        _signal(soil, of_soil), _signal(soil, soil_by_slip), _signal(soil, soil_by_relaxation)
    )  # fmt: skip
    rows = _with_layer(system, layer, still, signal, NOTHING)
    by_slip = _less3(by_slip, _signal(layer, _with_layer(system, layer, 0.0, by_slip, rows[1])))
    gained = _less(rows[0], rows[2])
    moved = _with_layer(system, layer, 0.0, by_relaxation, gained)
    by_relaxation = _less3(by_relaxation, _signal(layer, moved))
    return _less3(signal, _signal(layer, rows)), by_slip, by_relaxation, of_soil, rows


@called_often
def _white_noise(intensity):
    """Forcing by white noise, which does not depend on the structure, and its derivatives."""
    nothing = 0.0, 0.0, 0.0
    return (0.0, math.pi * intensity, 0.0), nothing, nothing


@called_often
def forcing_of(oscillators, system, ground):
    """Forcing of one cell and its derivatives, on a ground with so many oscillators.

    ``ground`` has the intensity, then stiffness and damping of two oscillators, used or not.
    """
    if oscillators == 0:
        return _white_noise(ground[0])
    if oscillators == 1:
        forcing, by_slip, by_relaxation, _ = _kanai_tajimi(system, (ground[0], ground[1], ground[2]))
        return forcing, by_slip, by_relaxation
    forcing, by_slip, by_relaxation, _, _ = _clough_penzien(system, ground)
    return forcing, by_slip, by_relaxation


@entry
def solve(rows, out):
    """Write forcings, their derivatives and covariances of cells to ``out`` (9 + 3 m, n).

    ``rows`` (8, n) are the equivalent system, ``S0``, ``wg^2`` and ``2 xig wg`` of Kanai-Tajimi grounds;
    (10, n) those with ``wf^2`` and ``2 xif wf`` of the high-pass oscillator of Clough-Penzien grounds.
    The covariances are those of ``mu``, then ``mu'`` and ``y``, with the ``m`` states of the filter.
    """
    for n in range(out.shape[1]):
        system = rows[0][n], rows[1][n], rows[2][n], rows[3][n], rows[4][n]
        if len(rows) == OF_KANAI_TAJIMI:
            of_one = _kanai_tajimi(system, (rows[5][n], rows[6][n], rows[7][n]))
            forcing, by_slip, by_relaxation, (mu, v, y) = of_one
            _write(out, n, (*forcing, *by_slip, *by_relaxation, *mu, *v, *y))
        else:
            ground = rows[5][n], rows[6][n], rows[7][n], rows[8][n], rows[9][n]
            of_both = _clough_penzien(system, ground)
            forcing, by_slip, by_relaxation, (mu, v, y), (layer_mu, layer_v, layer_y) = of_both
            covariances = *mu, *layer_mu, *v, *layer_v, *y, *layer_y
            _write(out, n, (*forcing, *by_slip, *by_relaxation, *covariances))


@called_often
def _write(out, n, numbers):
    """Write the numbers of a cell to its column."""
    for row in range(len(numbers)):
        out[row, n] = numbers[row]
