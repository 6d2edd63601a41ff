"""Response on one linear branch of a hysteresis law, under a ground acceleration that is linear in time.

Between two changes of stiffness the displacement follows ``x'' + D x' + K x = push + slope t``. The
unit of time is a sub-step of ``h`` seconds, with ``w h`` at most `LONGEST` for the stiffest branch.
The Taylor series from the start of the branch then gives the solution to rounding error, for any
damping ratio below 1 and any period, without the cancellations of the closed form. The branch ends when
a polynomial (a displacement, a velocity, or the distance of two structures) leaves an interval.
"""

from stochlin.kernels.basics.compiled import compiled

LONGEST = 1 / 3  # largest w h [rad]; the damping D = 2 xi w h is then below 2/3
TERMS = 18  # of the Taylor series; the first term left out is below (2/3)^18 / 18!, 1e-19
MARKS = 8  # room for the roots of one polynomial between 0 and 1, of which there are at most 4


@compiled
def expand(c, velocity, push, slope, damping, stiffness):
    """Write Taylor coefficients of ``x(t)`` to ``c`` (TERMS,); ``x(0) = 0``, ``x'(0) = velocity``."""
    c[0] = 0.0
    c[1] = velocity
    c[2] = (push - damping * velocity) / 2
    c[3] = (slope - 2 * damping * c[2] - stiffness * velocity) / 6
    for n in range(4, TERMS):
        c[n] = -(damping * (n - 1) * c[n - 1] + stiffness * c[n - 2]) / (n * (n - 1))


@compiled
def evaluate(c, t):
    """Value and derivative at ``t`` of the polynomial with coefficients ``c``, by Horner's scheme."""
    value, rate = c[TERMS - 1], 0.0
    for n in range(TERMS - 2, -1, -1):
        rate = rate * t + value
        value = value * t + c[n]
    return value, rate


@compiled
def first_exit(c, lower, upper, end, rows, marks):
    """Time at which a polynomial first leaves the interval from ``lower`` to ``upper``, up to ``end``.

    The second result is the side by which it leaves: 1 above, -1 below, 0 for no exit. Between the roots
    of its derivative the polynomial is monotone, as is each derivative between the roots of the next.
    Starting from the third derivative, all roots are therefore found, and no exit is missed however
    brief it is, provided that the third derivative changes sign at most once. Working space: ``rows``
    (4, TERMS), ``marks`` (2, MARKS).
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
    breaks = marks[0]  # roots of the first derivative, from the last pass, m = 1
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
def _roots(c, end, breaks, count, roots):
    """Find the roots up to ``end`` of a polynomial that is monotone between ``count`` sorted ``breaks``.

    They are written to ``roots``; the result is their number.
    """
    number, lo, before = 0, 0.0, evaluate(c, 0.0)[0]
    for i in range(count + 1):
        hi = breaks[i] if i < count else end
        after = evaluate(c, hi)[0]
        if before < 0 < after or before > 0 > after:
            roots[number] = _root(c, 0.0, lo, hi, after > 0)
            number += 1
        if after != 0 or before == 0:  # at a zero on a break, compare the signs on both sides of it
            lo, before = hi, after
    return number


@compiled
def _root(c, target, lo, hi, rising):
    """Time from ``lo`` to ``hi`` at which the polynomial equals ``target``: bracketed Newton steps."""
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
