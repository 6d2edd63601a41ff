"""Displacements of two structures where they could meet: storeys, and the CQC of elastic modes.

The CQC (complete quadratic combination) of one building is the root of ``sum_ij a_i a_j rho_ij D_i
D_j`` over its modes: ``D`` are the spectral displacements of their oscillators, ``a`` the
displacements of the floor over these, and ``rho`` their correlations. With ``-a`` for the modes of
building 2, the same sum over the modes of both is the square of the gap. Written as eq. (3), its
peaks are the CQC of each building, and its correlation is ``sum_ij a_i b_j rho_ij D_i D_j`` over
the modes of one and the other, over the product of both peaks.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence

import numpy as np
import scipy.linalg
import xarray as xr

from stochlin.applications.sites.spectra import checked_spectrum, interpolated
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.systems import Modes
from stochlin.kernels.linearization.systems.response import StationaryResponse
from stochlin.messages import DoubtfulInput
from stochlin.models.buildings.base import MODE
from stochlin.models.grounds import Ground, WhiteNoise
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.links import Link
from stochlin.models.rules.codes import Site
from stochlin.models.structures import AnyStructure
from stochlin.models.systems import LEVEL, Assembly, assembly_of, slabs_on_columns
from stochlin.solver.correlation.correlation import correlate
from stochlin.solver.linearization.systems.systems import linearized_motion
from stochlin.solver.simulation.statistics import ABOVE_GROUND
from stochlin.solver.simulation.structures_in_motion import at_height, meeting_heights
from stochlin.solver.tables import labels
from stochlin.solver.tables.checks import check_scalars

OTHER_MODE = f"{MODE}_2"
SAME_DAMPING = 0.01  # difference of damping ratios, as a share, up to which they are equal


def facing_heights(system: Assembly) -> Array:
    """Heights [m] at which two structures could meet, or of the floors of one; NaN if unknown."""
    return meeting_heights(*system.sticks) if system.sticks[1:] else system.sticks[0].levels


def weights_at(system: Assembly, heights: Array) -> list[Array]:
    """Displacement of each structure at the heights, as weights of all floors (heights, floors)."""
    numbers = range(len(system.sticks))
    return [np.array([at_height(system, n, height) for height in heights]) for n in numbers]


def linearized_at_roof(
    structures: tuple[AnyStructure, AnyStructure], ground: Ground, links: Sequence[Link]
) -> tuple[float, float]:
    """Correlation [-], and standard deviation of ``u_1 - u_2`` [m], at the lower roof."""
    motion = linearized_motion(structures, ground, links)
    system = assembly_of(structures)
    height = meeting_heights(*system.sticks)[-1]
    floors = system.storeys.shapes
    roof_1 = at_height(system, 0, height)[None] @ floors
    roof_2 = at_height(system, 1, height)[None] @ floors
    rho = correlation_of(motion, roof_1, roof_2)[0]
    std = motion.std(roof_1 - roof_2)[0, 0]
    return float(rho), float(std)


def correlation_of(motion: StationaryResponse, weights_1: Array, weights_2: Array) -> Array:
    """Correlation of two displacements with these weights of the coordinates (k, n), linearized."""
    first = motion.std(weights_1)[0]
    second = motion.std(weights_2)[0]
    apart = motion.std(weights_1 - weights_2)[0]
    rho: Array = (first**2 + second**2 - apart**2) / (2 * first * second)
    return rho


def std_and_rho(covariance: Array, weights: Sequence[Array]) -> tuple[Array, Array]:
    """Standard deviations (s, heights) of sums with these weights; correlation of first and last.

    The weights (heights, n) are those of n quantities with this covariance.
    """
    sizes = np.sqrt([np.einsum("hi,ij,hj->h", w, covariance, w) for w in weights])
    shared = np.einsum("hi,ij,hj->h", weights[0], covariance, weights[-1])
    return sizes, shared / (sizes[0] * sizes[-1])


def site_with_storeys(site: Site, structures: Sequence[AnyStructure]) -> Site:
    """The site for rules of codes, with numbers of storeys and with levels that fit the structures.

    The same structural system counts only if the roofs are level: codes that reduce the gap for it
    also ask for the same height, and with storeys their height is that of the level, which is the
    same for both. Raises a ValueError if a height, a number of storeys or level floors
    contradict them.
    """
    roofs = []
    numbers = {}
    for n, structure in enumerate(structures, start=1):
        height = getattr(site, f"height_{n}")
        storeys = getattr(site, f"storeys_{n}")
        floors = structure.floor_count
        if structure.has_storeys:
            roof = float(structure.levels()[-1])
            if height is not None and abs(height - roof) > LEVEL:
                what = (
                    f"height_{n} = {height:g} m, but the storeys add up to {roof:g} m; leave it out"
                )
                raise ValueError(what)
            if storeys not in (None, floors):
                what = f"storeys_{n} = {storeys:g}, but that building has {floors} storeys"
                raise ValueError(f"{what}; leave it out")
            height = roof
            storeys = floors
        roofs.append(height)
        numbers[f"storeys_{n}"] = storeys
    if site.floors_align:
        _check_floors(structures)
    level = None not in roofs and len({*roofs}) == 1
    return site.with_arrays({**numbers, "same_system": site.same_system and level})


def _check_floors(structures: Sequence[AnyStructure]) -> None:
    """Raise a ValueError if floors of two structures with storeys are not at the same levels."""
    levels = [structure.levels() for structure in structures if structure.has_storeys]
    off = slabs_on_columns(*levels) if len(levels) == 2 else ()
    if off:
        at = ", ".join(f"{levels[side][floor - 1]:g}" for side, floor in off)
        raise ValueError(
            f"floors_align = True, but at {at} m only one of both has a floor; allowed: False"
        )


def modes_of(system: Assembly) -> Modes:
    """The elastic modes of all structures of a system, structure by structure.

    Raises a ValueError for a mode that does not vibrate.
    """
    period, damping, moves = zip(*(stick.system.modes() for stick in system.sticks), strict=True)
    modes = Modes(np.concatenate(period), np.concatenate(damping), scipy.linalg.block_diag(*moves))
    worst = int(np.argmax(modes.damping))
    if modes.damping[worst] >= 1:
        period = modes.period[worst]
        damping = modes.damping[worst]
        what = f"the mode of {period:.3g} s has the damping ratio {damping:.3g}"
        raise ValueError(f"{what}; allowed where modes are combined: below 1")
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
    both = oscillators_of(modes), oscillators_of(modes, OTHER_MODE)
    rho = correlate(*both, ground, bias=False).rho.transpose(MODE, OTHER_MODE).to_numpy()
    shared = rho * np.outer(displacements, displacements)
    return std_and_rho(shared, [row @ modes.moves for row in weights])


def spectral_peaks(
    structures: Sequence[AnyStructure], spectrum: xr.DataArray, site: Site
) -> tuple[Site, xr.DataArray]:
    """The site with displacements by the modes at heights where they could meet, and ``rho`` there.

    Raises a ValueError if an oscillator has arrays as parameters, heights contradict the storeys or
    the spectrum has no value for a mode.
    """
    for n, structure in enumerate(structures, start=1):
        check_scalars(structure, f"modes_{n}", "numbers")
    system = assembly_of(structures)
    heights = facing_heights(system)
    modes = modes_of(system)
    displacements = spectral_displacements(modes, spectrum)
    sizes, rho = combine_modes(modes, displacements, WhiteNoise(1.0), weights_at(system, heights))
    arrays = [xr.DataArray(values, dims="height") for values in (*sizes, rho)]
    if np.isnan(heights).any():  # of oscillators
        *peaks, correlation = (array.squeeze("height") for array in arrays)
    else:
        site = site_with_storeys(site, structures)
        axis = labels.axis("height", ABOVE_GROUND, heights, "m")
        *peaks, correlation = (array.assign_coords(height=axis) for array in arrays)
        site = site.with_arrays({f"height_{n}": axis for n, _ in enumerate(peaks, start=1)})
    return site.with_arrays({f"peak_{n}": peak for n, peak in enumerate(peaks, 1)}), correlation


def spectral_displacements(modes: Modes, spectrum: xr.DataArray) -> Array:
    """Displacements [m] of the oscillators of the modes under a spectrum of pseudo-accelerations.

    A mode that is shorter than its shortest period has the ordinate there.
    """
    period, values, damping = checked_spectrum(spectrum)
    if modes.period.max() > period[-1]:
        what = f"spectrum ends at {period[-1]:g} s, and a mode has {modes.period.max():.3g} s"
        raise ValueError(f"{what}; allowed: a spectrum up to the longest period of the modes")
    if (np.abs(modes.damping / damping - 1) > SAME_DAMPING).any():
        ends = np.unique([modes.damping.min(), modes.damping.max()])
        dampings = " to ".join(f"{end:.3g}" for end in ends)
        warnings.warn(
            f"spectrum is of the damping {damping:g}, and the modes have {dampings}: its "
            "ordinates are taken as they are",
            DoubtfulInput,
            stacklevel=5,
        )
    ordinates = interpolated(period, values, modes.period)
    displacements: Array = ordinates * (modes.period / (2 * np.pi)) ** 2
    return displacements
