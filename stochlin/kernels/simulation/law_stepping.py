"""Time steps of structures whose hysteresis law is a given function, compiled for each law."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from stochlin.kernels.basics.compiled import compiled, not_kept
from stochlin.kernels.simulation.stepping import LANES

SECANT_STEPS = 12  # largest number of steps of the secant method
CLOSE = 1e-12  # tolerance of z


def law_middle(law: Callable[..., Any]) -> Any:
    """The function that steps ``z' = law(v, z, own)``, in the same form as `bouc_wen_middle`.

    It follows the implicit midpoint rule, solved by the secant method, which needs no derivative of the
    law. At a jump of the law the equation may have no solution, and the explicit midpoint rule is taken.
    The error is of second order in the step, and of first order if the law jumps. ``own`` are the
    parameters of the law.
    """
    rate: Any = compiled(law)

    @compiled
    def middle(hyst, start, slope, half, own):
        """Solve ``z = hyst + half law(start - slope z, z, own)``."""
        before, after = hyst, hyst + half * rate(start - slope * hyst, hyst, own)
        z_mid = after
        off_before = before - after
        for _ in range(SECANT_STEPS):
            off = after - hyst - half * rate(start - slope * after, after, own)
            if abs(off) <= CLOSE * (1.0 + abs(after)):
                z_mid = after
                break
            if off == off_before:
                break
            before, after, off_before = after, after - off * (after - before) / (off - off_before), off
        return z_mid, hyst + 2.0 * half * rate(start - slope * z_mid, z_mid, own)

    return middle


def law_block(middle: Any) -> Callable[..., None]:
    """The function for a block of time steps of structures with the law of this `law_middle`.

    It is called as `bilinear_block`. The parameters ``own`` of the law follow the first four parameters
    of a structure.
    """

    @not_kept
    def block(f, dt, parameters, u, v, z, every, out, first):
        half = 0.5 * dt
        for n in range(u.shape[0]):
            d, k, h, scale = parameters[n, :4]
            own = parameters[n, 4:]
            keep, pull, push = 1.0 - half * d - half * half * k, dt * k, dt * scale
            implicit = 1.0 / (1.0 + half * d + half * half * k)
            slope = half * h * implicit
            for s in range(f.shape[0]):
                for lane in range(LANES):
                    vel, hyst = v[n, lane], z[n, lane]
                    base = vel * keep + push * f[s, lane] - pull * u[n, lane]
                    start = 0.5 * (vel + base * implicit)
                    z_mid, z[n, lane] = middle(hyst, start, slope, half, own)
                    v_mid = start - slope * z_mid
                    u[n, lane] += dt * v_mid
                    v[n, lane] = 2.0 * v_mid - vel
                    if (s + 1) % every == 0:
                        out[(s + 1) // every - 1, first + n, lane] = u[n, lane]

    return block
