"""What yielding leaves behind: residual drifts, dissipated energies, ductilities, the Park-Ang index."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from stochlin.analyses.damage.variables import VARIABLES
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.floors import ELEMENT
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief
from stochlin.models.parameters import NOT_NEGATIVE, Model, Parameter, Range, parameter
from stochlin.models.systems import Arrangement

DECAY_TIMES = 4.0  # of free vibration, in which vibrations decay to 2 %
MOST_INTERVALS = 1e6  # of free vibration
RESIDUAL, ENERGY, PEAK, CUMULATIVE = (
    "residual_drift",
    "dissipated_energy",
    "peak_ductility",
    "cumulative_ductility",
)
DAMAGE = RESIDUAL, ENERGY, PEAK, CUMULATIVE
OF_STRUCTURE = "hysteretic_energy"  # of all elements of a structure


@dataclass(frozen=True)
class ParkAng(Model):
    """The parameters of the index of Park and Ang: they describe the elements, and have no default."""

    of_arguments = True

    ultimate_ductility: Parameter = parameter(
        "1", "ductility at which an element fails in monotonic loading", Range(1.0)
    )
    beta: Parameter = parameter("1", "factor on the dissipated energy", NOT_NEGATIVE)


def free_intervals(slowest: float, dt: float) -> int:
    """Intervals ``dt`` [s] of free vibration until vibrations have decayed, from the slowest decay [s].

    Raises a ValueError if they are too many.
    """
    intervals = DECAY_TIMES * slowest / dt
    if intervals > MOST_INTERVALS:
        raise ValueError(
            f"damage = True: vibrations take {slowest:.3g} s to decay to 1/e, so that a structure comes "
            "to rest too late; give it more damping, or leave out damage"
        )
    return int(np.ceil(intervals))


def damage_of(drift: Array, energy: Array, strength: Array, stiffness: Array) -> dict[str, Array]:
    """Quantities of elements by name, from their peak drifts [m] and dissipated energies [J].

    Where nothing can yield the ``strength`` [m] is infinite.
    """
    capacity = stiffness * strength**2
    return {ENERGY: energy, PEAK: drift / strength, CUMULATIVE: 1 + energy / capacity}


def damage_of_elements(system: Arrangement, stretch: Array, spent: Array) -> dict[str, Array]:
    """`damage_of` all that is watched, from the elements of the structures (..., n)."""
    storeys = system.storeys
    of_elements = damage_of(stretch, spent, storeys.strength, storeys.elastic)
    elastic = {ENERGY: 0.0, PEAK: 0.0, CUMULATIVE: 1.0}
    return {name: system.of_elements(a, elastic[name], np.nan) for name, a in of_elements.items()}


def residual_drifts(system: Arrangement, rest: Array) -> Array:
    """Drifts of all that is watched (..., w) [m] from the coordinates at rest (..., n)."""
    drifts: Array = rest @ (system.drifts @ system.displacements).T
    return drifts


def park_ang(table: xr.Dataset, ultimate_ductility: Parameter, beta: Parameter) -> xr.Dataset:
    """Damage index of Park and Ang for every storey, from a response with ``damage=True``.

    ``D = mu/mu_u + beta E/(Fy uy mu_u)``, with the peak ductility ``mu``, the dissipated energy ``E``,
    and the yield force ``Fy`` at the yield drift ``uy``. ``D`` of 1 means failure.

    Parameters
    ----------
    table : xarray.Dataset
        Result of `simulate`, `respond` or `pound` with ``damage=True``.
    ultimate_ductility : float or DataArray
        Ductility ``mu_u`` at which an element fails if it is loaded in one direction [-], above 1.
        Arrays broadcast by dimension name, for instance over ``element``.
    beta : float or DataArray
        Factor ``beta`` on the dissipated energy [-], at least 0. It follows from tests of such elements.

    Returns
    -------
    xarray.Dataset
        Over the dimensions of the ductilities: ``park_ang`` [-]. If it is over ``path`` or ``record``,
        also the mean over the motions, ``park_ang_mean``, with its standard error. For buildings with
        storeys ``park_ang_of_structure`` [-] over ``structure``, and its mean, is the index of a whole
        building: that of its storeys, weighted by the energies they dissipate. It is 0 where nothing is
        dissipated.

    Raises
    ------
    ValueError, TypeError
        If the table has no ductilities, or a parameter is out of range.

    References
    ----------
    Park, Y.-J. and Ang, A. H.-S. (1985), J. Struct. Eng. ASCE 111, 722-739, for the index; Park, Y.-J.,
    Ang, A. H.-S. and Wen, Y. K. (1985), J. Struct. Eng. ASCE 111, 740-757, for that of a building.

    Examples
    --------
    >>> import stochlin as sl
    >>> frame = sl.ModifiedClough(0.6, 0.05, hardening=0.05, yield_displacement=0.02)
    >>> ground = sl.KanaiTajimi(0.4, 0.6, 0.02)
    >>> table = sl.simulate([frame], ground, paths=32, duration=10.0, damage=True)
    >>> index = sl.park_ang(table, ultimate_ductility=6, beta=0.1)
    >>> bool((index.park_ang > table.peak_ductility / 6).all())
    True
    """
    if not isinstance(table, xr.Dataset) or not {PEAK, CUMULATIVE} <= set(table.variables):
        raise ValueError(
            f"table = {brief(table)} has no {PEAK} and {CUMULATIVE}; allowed: the result of simulate, "
            "respond or pound with damage=True"
        )
    limits = ParkAng(ultimate_ductility, beta)
    values = limits.arrays()
    index = (table[PEAK] + values["beta"] * (table[CUMULATIVE] - 1)) / values["ultimate_ductility"]
    columns = {"park_ang": index.where(limits.valid())}
    if ELEMENT in index.dims:
        energy = table[ENERGY].where(index.notnull())
        weighted = (energy * index).groupby("element_structure").sum()
        whole = energy.groupby("element_structure").sum()
        of_structure = (weighted / whole.where(whole > 0)).fillna(0.0)
        of_structure = of_structure.rename(element_structure="structure")
        names = table.get("structure", xr.DataArray(of_structure.structure.values, dims="structure"))
        columns["park_ang_of_structure"] = of_structure.assign_coords(structure=names)
    over = [name for name in ("path", "record") if name in index.dims]
    for name, values_of in list(columns.items()) if over else ():
        count = values_of.notnull().sum(over)
        mean = columns[f"{name}_mean"] = values_of.sum(over) / count.where(count > 0)
        variance = ((values_of - mean) ** 2).sum(over) / (count - 1).where(count > 1)
        columns[f"{name}_mean_standard_error"] = (variance / count) ** 0.5
    return labels.with_run_information(
        labels.label(xr.Dataset(columns), VARIABLES),
        "Damage index of Park and Ang",
        "park_ang()",
        {"limits": limits},
        "Park, Y.-J. and Ang, A. H.-S. (1985). Mechanistic seismic damage model for reinforced "
        "concrete. J. Struct. Eng. ASCE 111, 722-739.",
    )
