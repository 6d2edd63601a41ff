"""Time steps of structures whose hysteresis law is given as a function; compiled for each law."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from stochlin.kernels.basics.compiled import compiled, not_kept
from stochlin.kernels.simulation.stepping import LANES

SECANT_STEPS = 12
CLOSE = 1e-12


def law_middle(law: Callable[..., Any]) -> Any:
    """``z`` at the middle of a step and at its end, as `bouc_wen_middle`, for ``z' = law(v, z, own)``.

    Implicit midpoint rule by the secant method, which asks for no derivative; explicit midpoint rule
    where a jump of the law leaves it without solution. Second order, first where the law jumps.
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
    """The block of time steps, as `bilinear_block`, of the law with this `law_middle`.

    Its parameters ``own`` stand after the first four of a structure.
    """

    @not_kept
    def block(f, dt, parameters, u, v, z, every, out):
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
                        out[(s + 1) // every - 1, n, lane] = u[n, lane]

    return block
