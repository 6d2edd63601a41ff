"""Grounds as linear filters of white noise, and the covariances of their motion with an oscillator.

A ground is white noise of two-sided PSD ``S0`` through a linear `Filter` with any number of states.
Filters of one oscillator (Kanai-Tajimi) or two (Clough-Penzien) have closed forms, which are much
faster, in `grounds`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import reduce
from typing import Any, NamedTuple, Self

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization import grounds
from stochlin.kernels.linearization.covariance import EquivalentSystem, Forcing

Entry = Any  # a number, or an array of cells


class Matrices(NamedTuple):
    """The coefficients of a filter as arrays, whose leading dimensions are those of the cells."""

    matrix: Array  # (..., m, m) state matrix
    noise: Array  # (..., m) factors of the white noise on the rates of the states
    output: Array  # (..., m) factors of the states in the forcing of the structures


@dataclass(frozen=True)
class Filter:
    """A ground as a linear filter: ``q' = matrix q + noise n(t)``, acceleration ``output . q``.

    Parameters
    ----------
    intensity : number or array of cells
        Two-sided PSD ``S0`` of the white noise ``n`` [m^2/s^3].
    states : tuple of str
        Names of the ``m`` states. Without states the ground acceleration is the white noise itself.
    matrix : (m, m) numbers or arrays of cells
        State matrix as nested lists; its eigenvalues have negative real parts.
    noise, output : (m,) numbers or arrays of cells
        Factors of the noise on the rates of the states, and of the states in the acceleration.
    oscillators : sequence of numbers or arrays of cells
        Stiffness and damping of the soil's oscillator, then those of a high-pass oscillator, of
        filters that consist of these.

    Raises
    ------
    ValueError
        If the sizes do not agree.
    """

    intensity: Entry
    states: tuple[str, ...] = ()
    matrix: Sequence[Sequence[Entry]] = ()
    noise: Sequence[Entry] = ()
    output: Sequence[Entry] = ()
    oscillators: Sequence[Entry] = ()

    def __post_init__(self) -> None:
        sizes = {len(self.states), len(self.matrix), len(self.noise), len(self.output)}
        if len(sizes.union(map(len, self.matrix))) > 1:
            raise ValueError(
                f"a ground filter of {len(self.states)} states has a matrix of rows of "
                f"{[len(row) for row in self.matrix]}, {len(self.noise)} numbers of noise and "
                f"{len(self.output)} of output; allowed: a row, a column, a number for each state"
            )

    @classmethod
    def kanai_tajimi(cls, intensity: Entry, frequency: Entry, damping: Entry) -> Filter:
        """The Kanai-Tajimi ground, eqs. (11) and (12): white noise through one oscillator.

        ``frequency`` is ``wg`` [rad/s] and ``damping`` ``xig``.
        """
        soil = frequency**2, 2 * damping * frequency
        matrix = (0.0, 1.0), (-soil[0], -soil[1])
        return cls(intensity, ("xg", "xg_rate"), matrix, (0.0, 1.0), soil, soil)

    def clough_penzien(self, frequency: Entry, damping: Entry) -> Filter:
        """The Kanai-Tajimi ground through a high-pass oscillator of ``wf`` [rad/s] and ``xif``."""
        layer = (frequency**2, 2 * damping * frequency)
        zeros = (0.0, 0.0)
        output = (*self.output, -layer[0], -layer[1])
        matrix = (*((*row, *zeros) for row in self.matrix), (*zeros, 0.0, 1.0), output)
        states = (*self.states, "xf", "xf_rate")
        noise = (*self.noise, *zeros)
        return Filter(self.intensity, states, matrix, noise, output, (*self.oscillators, *layer))

    def at(self, cells: Any) -> Self:
        """The filter of a selection of the cells."""
        return replace(self, **{f.name: _at(getattr(self, f.name), cells) for f in fields(self)})

    @property
    def arrays(self) -> Matrices:
        """The coefficients as arrays over the cells."""
        entries = [*self.output, *self.noise, *(entry for row in self.matrix for entry in row)]
        cells = np.broadcast_shapes(*map(np.shape, entries))
        m = len(self.states)
        wide = [np.broadcast_to(np.asarray(entry, float), cells) for entry in entries]
        stacked = np.stack(wide, axis=-1) if wide else np.zeros((*cells, 0))
        return Matrices(
            stacked[..., 2 * m :].reshape(*cells, m, m), stacked[..., m : 2 * m], stacked[..., :m]
        )

    @property
    def in_closed_form(self) -> bool:
        """Whether the filter is of oscillators alone, or white noise."""
        return len(self.oscillators) == len(self.states)

    @property
    def growth(self) -> float:
        """Largest rate [1/s] at which free motions grow, below 0 if they decay, over all cells.

        Oscillators decay, since their damping is positive.
        """
        if self.oscillators:
            return -np.inf
        matrix = self.arrays.matrix
        finite = matrix[np.isfinite(matrix).all(axis=(-2, -1))]
        return float(np.linalg.eigvals(finite).real.max(initial=-np.inf))

    @property
    def fastest(self) -> Entry:
        """Largest natural frequency of the filter [rad/s]; 0 without states."""
        if self.oscillators:
            return np.sqrt(reduce(np.maximum, self.oscillators[::2]))
        return np.abs(np.linalg.eigvals(self.arrays.matrix)).max(axis=-1, initial=0.0)

    def transmission(self, frequency: Array) -> Array:
        """The PSD over ``S0`` at frequencies [rad/s], ``|output (i w - matrix)^-1 noise|^2``.

        For oscillators it is eq. (12), times that of the high-pass oscillator.
        """
        if not self.states:
            return np.ones_like(frequency, float)
        if self.oscillators:
            share: Any = 1.0
            pairs = zip(self.oscillators[::2], self.oscillators[1::2], strict=True)
            for stiffness, damping in pairs:
                ratio = frequency**2 / stiffness
                spread = damping**2 / stiffness * ratio
                passed = 1 + spread if stiffness is self.oscillators[0] else ratio**2
                share = share * passed / ((1 - ratio) ** 2 + spread)
            return share
        matrix, noise, output = self.arrays
        resolved = resolvent(1j * np.asarray(frequency, float), matrix, noise)
        return np.abs((output * resolved).sum(axis=-1)) ** 2

    def forcing(self, system: EquivalentSystem) -> Forcing:
        """Covariances of the forcing with the structure's states."""
        if self.in_closed_form:
            ground = self.intensity, *self.oscillators
            return grounds.forcing_of(system, grounds.Soil(ground, len(self.oscillators) // 2))
        output = self.arrays.output
        return Forcing(*((output * row).sum(axis=-1) for row in self.correlations(system)))

    def later(self, system: EquivalentSystem, s: Array) -> Array:
        """Laplace transform of the covariance of the later forcing with the present displacement.

        It is ``Int_0^inf E[f(t + tau) mu(t)] e^(-s tau) dtau``. After ``t`` the filter moves
        freely, apart from noise that is independent of ``mu(t)``. The cells are (n, 1), and ``s``
        is (n, nodes).
        """
        if not self.states:
            return np.zeros_like(s)
        matrix, _, output = self.arrays
        return (output * resolvent(s, matrix, self.correlations(system)[0])).sum(axis=-1)

    def correlations(self, system: EquivalentSystem) -> Array:
        """Covariances ``C`` (3, ..., m) of ``mu``, ``mu'``, ``y`` with the filter's states ``q``.

        They solve ``A C + C F' + b E[f q'] = 0``, in units in which all quantities are of order
        one.
        """
        if not self.states:
            return np.empty((3, *np.shape(system.stiffness), 0))
        if self.oscillators:
            solve = grounds.kanai_tajimi if len(self.states) == 2 else grounds.clough_penzien
            _, ends, *layer = solve(system, (self.intensity, *self.oscillators))
            parts = grounds.driven_rows(system, self.oscillators[:2], ends), *layer
            rows: Any = (sum(pairs, ()) for pairs in zip(*parts, strict=True))
            return np.moveaxis(np.array([np.broadcast_arrays(*row) for row in rows]), 1, -1)
        soil = self.arrays
        m = len(self.states)
        cells = np.broadcast_shapes(
            soil.noise.shape[:-1], *map(np.shape, (*system, self.intensity))
        )
        matrix = np.broadcast_to(soil.matrix, (*cells, m, m)).reshape(-1, m, m)
        noise = np.broadcast_to(soil.noise, (*cells, m)).reshape(-1, m)
        output = np.broadcast_to(soil.output, (*cells, m)).reshape(-1, m)
        wide = [np.broadcast_to(row, cells).ravel() for row in (*system, self.intensity)]
        w2, d, h, p, k, intensity = wide
        covariance = stationary(matrix, noise)
        w = np.sqrt(w2)
        std = np.sqrt(np.diagonal(covariance, axis1=-2, axis2=-1))
        std = np.where(std > 0, std, 1.0)
        of_structure = np.zeros((w.size, 3, 3))
        right = np.zeros((w.size, 3, m, 1))
        of_structure[:, 0, 1] = w
        of_structure[:, 1, 0] = -w
        of_structure[:, 1, 1] = -d
        of_structure[:, 1, 2] = h / w
        of_structure[:, 2, 0] = k
        of_structure[:, 2, 1] = p * w
        of_structure[:, 2, 2] = -k
        drive = 2 * np.pi * intensity[:, None] * (covariance @ output[..., None])[..., 0] / std
        right[:, 1, :, 0] = drive / w[:, None]
        of_soil = matrix * std[:, None] / std[..., None]
        cross = _sylvester_of_matrices(of_structure, of_soil, right)[..., 0]
        cross *= std[:, None]
        cross[:, 1] *= w[:, None]
        return cross.swapaxes(0, 1).reshape(3, *cells, m)


def _at(entry: Any, cells: Any) -> Any:
    """The selected cells of a number, an array, or nested sequences of these."""
    if isinstance(entry, (list, tuple)):
        return tuple(_at(item, cells) for item in entry)
    return entry[cells] if np.ndim(entry) else entry


def resolvent(s: Array, matrix: Array, right: Array) -> Array:
    """``(s - matrix)^-1 right``, for each cell and each ``s``."""
    left = s[..., None, None] * np.eye(matrix.shape[-1]) - matrix
    return np.linalg.solve(left, np.broadcast_to(right, left.shape[:-1])[..., None])[..., 0]


def stationary(matrix: Array, noise: Array) -> Array:
    """Stationary covariance (n, m, m) of filter states for white noise of unit intensity in time.

    NaN in cells whose matrix is not stable.
    """
    m = noise.shape[1]
    both = np.concatenate([matrix.reshape(-1, m * m), noise], axis=1)
    alike, which = np.unique(both, axis=0, return_inverse=True)
    alike[~np.isfinite(alike).all(axis=1)] = 0.0
    matrix = alike[:, : m * m].reshape(-1, m, m)
    noise = alike[:, m * m :]
    stable = np.linalg.eigvals(matrix).real.max(axis=-1) < 0
    safe = np.where(stable[:, None, None], matrix, -np.eye(m))
    scale = np.ones_like(noise)
    for _ in range(2):  # solve again in units of the standard deviations, which is more accurate
        unit = safe * scale[:, None, :] / scale[..., None]
        push = noise / scale
        drive = push[:, :, None, None] * push[:, None, :, None]
        covariance = _sylvester_of_matrices(unit, unit, drive)[..., 0]
        covariance = covariance * scale[..., None] * scale[:, None, :]
        std = np.sqrt(np.maximum(np.diagonal(covariance, axis1=-2, axis2=-1), 0))
        scale = np.where(std > 0, std, 1.0)
    return np.where(stable[:, None, None], covariance, np.nan)[which.ravel()]


def _sylvester_of_matrices(a: Array, b: Array, right: Array) -> Array:
    """``X`` of ``A X + X B' + right = 0``, for each cell and each entry of the last dimension."""
    p = a.shape[-1]
    q = b.shape[-1]
    left = a[..., :, None, :, None] * np.eye(q)[:, None, :]
    left = left + np.eye(p)[:, None, :, None] * b[..., None, :, None, :]
    x = np.linalg.solve(left.reshape(-1, p * q, p * q), -right.reshape(-1, p * q, right.shape[-1]))
    return x.reshape(right.shape)
