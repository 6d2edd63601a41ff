"""A linear branch of a structure, under a ground acceleration that is linear in time; compiled.

Between two changes of stiffness a displacement follows ``x'' + D x' + K x = push + slope t``. Time is
counted in sub-steps, of at most LONGEST radians of the stiffest branch: the Taylor series from the
start of a stretch is then the solution to rounding, for any damping and for periods however long,
and has none of the cancellations of the closed form. A change of branch is an exit of such a
polynomial from an interval: of a displacement, a velocity, or a distance between two structures.
"""

from stochlin.kernels.basics.compiled import compiled

LONGEST = 1 / 3  # w h; damping D = 2 xi w h is then below 2/3
TERMS = 18  # the first term left out is below (2/3)^18 / 18!, 1e-19
MARKS = 8  # roots of one polynomial between 0 and 1: at most 4 are sought


@compiled
def expand(c, velocity, push, slope, damping, stiffness):
    """Taylor coefficients ``c`` (TERMS,) of ``x(t)`` with ``x(0) = 0``, ``x'(0) = velocity``."""
    c[0] = 0.0
    c[1] = velocity
    c[2] = (push - damping * velocity) / 2
    c[3] = (slope - 2 * damping * c[2] - stiffness * velocity) / 6
    for n in range(4, TERMS):
        c[n] = -(damping * (n - 1) * c[n - 1] + stiffness * c[n - 2]) / (n * (n - 1))


@compiled
def evaluate(c, t):
    """Value and derivative of the polynomial at ``t``."""
    value, rate = c[TERMS - 1], 0.0
    for n in range(TERMS - 2, -1, -1):
        rate = rate * t + value
        value = value * t + c[n]
    return value, rate


@compiled
def transition(damping, stiffness, c):
    """Displacement and velocity after one sub-step, per unit of velocity, push and slope."""
    expand(c, 1.0, 0.0, 0.0, damping, stiffness)
    xv, vv = evaluate(c, 1.0)
    expand(c, 0.0, 1.0, 0.0, damping, stiffness)
    xp, vp = evaluate(c, 1.0)
    expand(c, 0.0, 0.0, 1.0, damping, stiffness)
    xs, vs = evaluate(c, 1.0)
    return xv, xp, xs, vv, vp, vs


@compiled
def first_exit(c, lower, upper, end, rows, marks):
    """Time at which the polynomial first leaves the interval, and by which side: 1, -1, or 0 for never.

    The polynomial is monotone between the roots of its derivative, and so is that between those of
    the second and third, so that no exit is lost however briefly it lasts, as long as the third
    derivative changes its sign at most once. Working space: ``rows`` (4, TERMS), ``marks`` (2, MARKS).
    """
    for n in range(TERMS):
        rows[0, n] = c[n]
    for m in range(1, 4):
        for n in range(TERMS - 1):
            rows[m, n] = (n + 1) * rows[m - 1, n + 1]
        rows[m, TERMS - 1] = 0.0
    count = 0
    for m in range(3, 0, -1):
        count = _roots(rows[m], end, marks[m % 2], count, marks[1 - m % 2])
    breaks = marks[0]  # where the row m = 1 has left its roots
    lo, before = 0.0, evaluate(c, 0.0)[0]
    for i in range(count + 1):
        hi = breaks[i] if i < count else end
        after = evaluate(c, hi)[0]
        if after > upper:
            return (_root(c, upper, lo, hi, True) if before < upper else lo), 1
        if after < lower:
            return (_root(c, lower, lo, hi, False) if before > lower else lo), -1
        lo, before = hi, after
    return end, 0


@compiled
def _roots(c, end, breaks, count, found):
    """Roots of a polynomial that is monotone between ``breaks``; returns their number."""
    number, lo, before = 0, 0.0, evaluate(c, 0.0)[0]
    for i in range(count + 1):
        hi = breaks[i] if i < count else end
        after = evaluate(c, hi)[0]
        if before < 0 < after or before > 0 > after:
            found[number] = _root(c, 0.0, lo, hi, after > 0)
            number += 1
        if after != 0 or before == 0:  # a root on a break is a change of sign only if both sides say so
            lo, before = hi, after
    return number


@compiled
def _root(c, target, lo, hi, rising):
    """Where the polynomial passes the target, by Newton's method kept inside its bracket."""
    t = 0.5 * (lo + hi)
    for _ in range(100):
        value, rate = evaluate(c, t)
        if (value > target) == rising:
            hi = t
        else:
            lo = t
        new = t - (value - target) / rate
        if not lo <= new <= hi:
            new = 0.5 * (lo + hi)
        if abs(new - t) <= 1e-16 + 2e-16 * t:
            return new
        t = new
    return t
