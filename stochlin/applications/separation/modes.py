"""Elastic modes of two structures on one ground, combined by the CQC in both and in their difference.

The CQC (complete quadratic combination) of one building is the root of ``sum_ij a_i a_j rho_ij D_i D_j``
over its modes: ``D`` are the spectral displacements of their oscillators, ``a`` the displacements of the
floor over these, and ``rho`` their correlations. With ``-a`` for the modes of building 2, the same sum
over the modes of both is the square of the gap. Written as eq. (3), its peaks are the CQC of each
building, and its correlation is ``sum_ij a_i b_j rho_ij D_i D_j`` over the modes of one and the other,
over the product of both peaks.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import scipy.linalg
import xarray as xr

from stochlin.applications.separation.critical_gap import equation_3
from stochlin.applications.separation.storeys import (
    check_levels,
    combined,
    facing_heights,
    of_storeys,
    weights_at,
)
from stochlin.applications.sites.spectra import checked_spectrum, interpolated
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.systems import Modes
from stochlin.messages import DoubtfulInput
from stochlin.models.buildings.base import MODE
from stochlin.models.grounds import Ground
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.rules.codes import Neighbours
from stochlin.models.structures import Structure
from stochlin.models.systems import AnyStructure, Arrangement, arrangement_of
from stochlin.solver.correlation.correlation import correlate
from stochlin.solver.simulation.finite_motions import HEIGHT
from stochlin.solver.tables import labels
from stochlin.solver.tables.checks import check_scalars

OTHER = f"{MODE}_2"
SAME_DAMPING = 0.01  # difference of damping ratios, as a share, up to which they are equal


class SpectralPeaks(NamedTuple):
    """Displacements of one or two buildings by the CQC of their modes under a spectrum."""

    peaks: list[Any]  # of each building [m], over the heights if one has storeys; None of none
    heights: list[Any]  # of each building, for rules of codes [m]
    neighbours: Neighbours
    rho: xr.DataArray  # correlation of both

    def apart(self, peak_1: Any, peak_2: Any) -> xr.DataArray:
        """CQC of the difference [m] with these peaks."""
        difference: xr.DataArray = xr.apply_ufunc(equation_3, peak_1, peak_2, self.rho)
        return difference

    def variables(self) -> dict[str, xr.DataArray]:
        """Variables of the table."""
        known = {"peak_1": self.peaks[0], "peak_2": self.peaks[1], "rho": self.rho}
        return known if self.peaks[1] is not None else {"peak_1": self.peaks[0]}


def modes_of(system: Arrangement) -> Modes:
    """The elastic modes of all structures of a system, structure by structure.

    Raises a ValueError for a mode that does not vibrate.
    """
    period, damping, moves = zip(*(stack.system.modes() for stack in system.stacks), strict=True)
    modes = Modes(np.concatenate(period), np.concatenate(damping), scipy.linalg.block_diag(*moves))
    worst = int(np.argmax(modes.damping))
    if modes.damping[worst] >= 1:
        raise ValueError(
            f"dampers or Rayleigh damping give the mode of {modes.period[worst]:.3g} s the damping "
            f"ratio {modes.damping[worst]:.3g}; allowed where modes are combined: below 1"
        )
    return modes


def oscillators_of(modes: Modes, dimension: str = MODE) -> Bilinear:
    """The elastic oscillators of the modes."""
    return Bilinear(*(xr.DataArray(values, dims=dimension) for values in modes[:2]))


def combine_modes(
    modes: Modes, displacements: Array, ground: Ground, weights: Sequence[Array]
) -> tuple[Array, Array]:
    """CQC of each structure [m] (structures, heights), and the correlation of both (heights,).

    ``displacements`` [m] are those of the oscillators, ``weights`` of the floors at the heights.
    """
    both = oscillators_of(modes), oscillators_of(modes, OTHER)
    rho = correlate(*both, ground, bias=False).rho.transpose(MODE, OTHER).to_numpy()
    shared = rho * np.outer(displacements, displacements)
    return combined(shared, [row @ modes.moves for row in weights])


def spectral_peaks(
    structures: Sequence[AnyStructure],
    spectrum: xr.DataArray,
    ground: Ground,
    tall: Sequence[Any],
    neighbours: Neighbours,
) -> SpectralPeaks:
    """Displacements of one or two structures by their modes, at the heights where they could meet.

    ``tall`` are their heights [m], if given. Raises a ValueError if an oscillator or the ground has
    arrays as parameters, heights contradict the storeys or the spectrum has no value for a mode.
    """
    check_scalars(ground, "ground", "numbers")
    for n, structure in enumerate(structures, start=1):
        if isinstance(structure, Structure):
            check_scalars(structure, f"modes_{n}", "numbers")
    system, known = arrangement_of(structures), tall[: len(structures)]
    heights = facing_heights(system)
    if has_storeys := not np.isnan(heights).any():
        check_levels(structures, known, neighbours.floors_align)
        neighbours = of_storeys(neighbours, structures, known)
    modes = modes_of(system)
    displacements = spectral_displacements(modes, spectrum)
    sizes, rho = combine_modes(modes, displacements, ground, weights_at(system, heights))
    arrays = [xr.DataArray(values, dims="height") for values in (*sizes, rho)]
    if has_storeys:
        axis = labels.axis("height", HEIGHT, heights, "m")
        arrays, tall = [array.assign_coords(height=axis) for array in arrays], [axis] * len(structures)
    else:
        arrays = [array.squeeze("height") for array in arrays]
    *peaks, correlation = arrays
    of_peaks, of_heights = ([*pair, None][:2] for pair in (peaks, tall))
    return SpectralPeaks(of_peaks, of_heights, neighbours, correlation)


def spectral_displacements(modes: Modes, spectrum: xr.DataArray) -> Array:
    """Displacements [m] of the oscillators of the modes under a spectrum of pseudo-accelerations.

    A mode that is shorter than its shortest period has the ordinate there.
    """
    period, values, damping = checked_spectrum(spectrum)
    if modes.period.max() > period[-1]:
        raise ValueError(
            f"spectrum ends at {period[-1]:g} s, and a mode has {modes.period.max():.3g} s; allowed: a "
            "spectrum up to the longest period of the modes"
        )
    if (np.abs(modes.damping / damping - 1) > SAME_DAMPING).any():
        ends = " to ".join(f"{end:.3g}" for end in np.unique([modes.damping.min(), modes.damping.max()]))
        warnings.warn(
            f"spectrum is of the damping {damping:g}, and the modes have {ends}: its ordinates are "
            "taken as they are",
            DoubtfulInput,
            stacklevel=5,
        )
    ordinates = interpolated(period, values, modes.period)
    displacements: Array = ordinates * (modes.period / (2 * np.pi)) ** 2
    return displacements
