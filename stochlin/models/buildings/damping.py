"""Viscous damping of buildings with storeys: one ratio for all modes, or that of Rayleigh damping."""

from __future__ import annotations

from typing import Any

from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief
from stochlin.models.arguments import OneOf, Whole

MODELS = MODAL, RAYLEIGH = "modal", "rayleigh"
OF_RAYLEIGH = "damping_model", "damping_modes"  # parameters of a building
ONE_PER_MODE = (
    "allowed by modes: damping as one number, or one for each mode, which is xi (wi wj/w + w)/(wi + wj) "
    "at the frequency w if Rayleigh damping is xi in the modes i and j"
)


def checked_modes(prefix: str, model: str, modes: Any, storeys: int) -> tuple[int, int] | None:
    """The two modes of Rayleigh damping, None of modal damping; a ValueError if they do not fit.

    ``prefix`` begins the messages.
    """
    OneOf(MODELS)(f"{prefix}damping_model", model)
    if model == MODAL:
        if modes is not None:
            raise ValueError(
                f'{prefix}damping_modes = {brief(modes)} belongs to damping_model = "{RAYLEIGH}", and '
                f'every mode has the same ratio by "{MODAL}"; write that model, or leave the modes out'
            )
        return None
    if storeys == 1:
        raise ValueError(
            f'{prefix}damping_model = "{model}" has its ratio in two modes, and one storey has one; '
            f'allowed: "{MODAL}", which is the same there'
        )
    known = Whole(1, storeys)
    listed = list(modes) if isinstance(modes, (tuple, list)) else []
    if len(listed) != 2 or not all(map(known.contains, listed)) or listed[0] == listed[1]:
        told = "is not given" if modes is None else f"= {brief(modes)}"
        raise ValueError(
            f"{prefix}damping_modes {told}; allowed: two different modes, each {known}, as "
            f"[1, {min(3, storeys)}]"
        )
    return int(listed[0]), int(listed[1])


def mode_ratios(ratio: float, frequencies: Array, modes: tuple[int, int] | None) -> Array:
    """Damping ratios of the modes of these circular frequencies (n,) [rad/s].

    With the two modes of Rayleigh damping, ``C = a0 M + a1 K``, it is ``a0/(2 w) + a1 w/2`` with
    ``a0 = 2 xi wi wj/(wi + wj)`` and ``a1 = 2 xi/(wi + wj)``.
    """
    w = frequencies
    if modes is None:
        return ratio + 0 * w
    first, second = (w[number - 1] for number in modes)
    shares: Array = (first * second / w + w) / (first + second)
    return ratio * shares
