"""Frames of Bouc-Wen storeys by the method of Runge and Kutta, without anything of the library."""

from math import pi
from typing import NamedTuple

import numpy as np
from scipy.linalg import eigh

PATHS, OWN_PATHS, OWN_STEP = 1024, 4096, 0.005
POLYNOMIAL = [
    0.00042516035818070537,
    -0.0034087076598092536,
    0.021272612064048006,
    0.9554664534582995,
]


class Frame(NamedTuple):
    """A frame of storeys; z is a hysteretic drift, in metres."""

    m: np.ndarray  # (storeys,)
    k: np.ndarray  # (storeys,)
    xi: float  # in all modes, or in two of them
    alpha: float
    n: float
    beta: np.ndarray | float  # (storeys, 1), or one of all storeys
    gamma: np.ndarray | float
    rayleigh: tuple = ()  # the two modes, from 1

    def modes(self):
        """Squares of the circular frequencies, and the shapes of the modes."""
        return eigh(self.stiffness(), np.diag(self.m))

    def stiffness(self):
        """The matrix of the elastic frame."""
        k = self.k
        return np.diag(k) + np.diag([*k[1:], 0.0]) - np.diag(k[1:], 1) - np.diag(k[1:], -1)

    def factors(self):
        """``a0`` and ``a1`` of Rayleigh damping, from ``xi = a0/(2 w) + a1 w/2`` in both modes."""
        w = np.sqrt(self.modes()[0])[[n - 1 for n in self.rayleigh]]
        return np.linalg.solve(np.stack([1 / w, w], axis=1) / 2, [self.xi, self.xi])

    def damping(self):
        """The damping matrix over the masses."""
        squares, shapes = self.modes()
        if self.rayleigh:
            a0, a1 = self.factors()
            return a0 * np.eye(self.m.size) + a1 * self.stiffness() / self.m[:, None]
        return shapes @ np.diag(2 * self.xi * np.sqrt(squares)) @ shapes.T * self.m

    def peaks(self, motions, step):
        """Of the drifts and floors in motions (steps, motions), whose values last for a step."""
        damping = self.damping()

        def rates(state, ground):
            u, v, z = state
            drift, rate = between(u), between(v)
            bent = (
                self.beta * abs(rate) * abs(z) ** (self.n - 1) * z
                + self.gamma * rate * abs(z) ** self.n
            )
            shear = self.k[:, None] * (self.alpha * drift + (1 - self.alpha) * z)
            net = shear - np.vstack([shear[1:], np.zeros_like(shear[:1])])
            return np.array([v, -ground - damping @ v - net / self.m[:, None], rate - bent])

        state = np.zeros((3, self.m.size, motions.shape[1]))
        peaks = np.zeros_like(state[:2])
        for ground in motions:
            a = rates(state, ground)
            b = rates(state + step / 2 * a, ground)
            c = rates(state + step / 2 * b, ground)
            d = rates(state + step * c, ground)
            state = state + step / 6 * (a + 2 * b + 2 * c + d)
            peaks = np.maximum(peaks, abs(np.array([between(state[0]), state[0]])))
        return peaks


def between(floors):
    """Of the storeys, from floor to floor."""
    return np.diff(floors, axis=0, prepend=0.0)


def library_numbers(steps, groups, first=0):
    """The random numbers of the library, by a second program: xoshiro256+, four parts of its bits.

    Their sum is made normal up to its ninth moment by a polynomial. A group has 32 motions.
    """
    numbers = range(first, first + groups)
    seeds = [np.random.SeedSequence(0, spawn_key=(group,)) for group in numbers]
    s = np.hstack([seed.generate_state(4 * 32, np.uint64).reshape(4, 32) for seed in seeds])
    numbers = np.empty((steps, s.shape[1]))
    for row in numbers:
        bits, shifted = s[0] + s[3], s[1] << np.uint64(17)
        s[2] ^= s[0]
        s[3] ^= s[1]
        s[1] ^= s[2]
        s[0] ^= s[3]
        s[2] ^= shifted
        s[3] = (s[3] << np.uint64(45)) | (s[3] >> np.uint64(19))
        x = sum(
            (bits >> np.uint64(16 * part) & np.uint64(65535)).astype(float) for part in range(4)
        )
        x = (x - 2 * 65535) / np.sqrt((2.0**32 - 1) / 3)
        row[:] = x * np.polyval(POLYNOMIAL, x**2)
    return numbers


def answers_and_numbers(frame, strength, end, limits):
    """Mean peak drifts and probabilities of exceeding the limits [mm], with what the manual says.

    ``strength`` is the intensity ``2 pi S0`` of the white noise, which lasts to the ``end``.
    """
    # The same motions: steps are parts of the fourth period, white noise has its mean over each.
    squares, _ = frame.modes()
    step = 2 * pi / np.sqrt(squares[3]) / 256
    white = library_numbers(int(np.ceil(end / step)), PATHS // 32) * np.sqrt(strength / step)
    peaks, _ = frame.peaks(-white, step)
    exceedance = np.mean(peaks > limits[..., None] / 1000, axis=-1)
    # Motions of its own, four times as many; distances of the probabilities over their standard
    # errors.
    own = np.random.default_rng(1).standard_normal((round(end / OWN_STEP), OWN_PATHS))
    own_peaks, _ = frame.peaks(own * np.sqrt(strength / OWN_STEP), OWN_STEP)
    own_exceedance = np.mean(own_peaks > limits[..., None] / 1000, axis=-1)
    variance = own_exceedance * (1 - own_exceedance)
    apart = abs(exceedance - own_exceedance) / np.sqrt(variance / PATHS + variance / OWN_PATHS)
    numbers = {
        **{
            "large": limits[0],
            "larger": limits[1],
            "paths": PATHS,
            "own_paths": OWN_PATHS,
            "end": end,
        },
        **{"step": 1000 * step, "own_step": 1000 * OWN_STEP},
        **{"apart": apart.max(), "within_one": np.sum(apart < 1), "compared": apart.size},
    }
    return {"mean": peaks.mean(axis=-1), "exceedance": exceedance}, numbers
