"""Hysteresis loops: the force of a structure along a displacement that is prescribed."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.simulation.laws import BILINEAR, by_number
from stochlin.kernels.simulation.paths import FLAG, follow
from stochlin.messages import brief
from stochlin.models.arguments import Whole, as_numbers, checked
from stochlin.models.structures import Structure
from stochlin.solver.tables import labels
from stochlin.solver.tables.checks import check_scalars

ALLOWED = "two or more finite numbers in metres, along one dimension"


@checked
def hysteresis_loop(
    structure: Structure, displacement: Any, *, refine: Annotated[int, Whole(1)] = 50
) -> xr.Dataset:
    """Restoring force of a structure along a prescribed displacement, from the undamaged state.

    Parameters
    ----------
    structure : Bilinear, BoucWen, Hysteretic or another oscillator
        Structure with scalar parameters, elastic or with a yield displacement. Forces per mass hold
        for its period; a storey has the law of `ShearBuilding.oscillator`.
    displacement : array
        Displacements [m], such as the turns of a test in cycles. It moves straight from 0 to the
        first and from each to the next. The rate has no effect on laws that do not depend on it.
    refine : int
        Number of points of the result on each of these ways.

    Returns
    -------
    xarray.Dataset
        Over ``point``: ``displacement`` [m]; ``force_per_mass`` [m/s^2], the restoring force
        without viscous damping; ``z`` [-], the hysteretic displacement over the yield displacement,
        NaN if the structure is elastic; and ``hysteretic_work_per_mass`` [m^2/s^2], the work of the
        part of the force that belongs to ``z``, which contains what unloading will give back.

    Raises
    ------
    ValueError, TypeError
        If the structure has arrays or a reduction factor, or the displacements are not finite
        numbers.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (5) to (7).

    Examples
    --------
    >>> import stochlin as sl
    >>> rocking = sl.Flag(0.6, 0.05, hardening=0.05, yield_displacement=0.02)
    >>> loop = sl.hysteresis_loop(rocking, [0.05, -0.05, 0.0])
    >>> bool(abs(loop.force_per_mass[-1]) < 1e-12)
    True
    """
    check_scalars(structure, "structure", "scalars, since a loop is of one structure")
    if structure.reduction_factor is not None:
        raise ValueError("structure has a reduction_factor; allowed: its yield_displacement")
    turns = np.concatenate([[0.0], _turns(displacement)])
    values = structure.cells()
    square = (2 * np.pi / values["period"]) ** 2
    uy = values.get("yield_displacement", np.nan)
    alpha = values["hardening"] if structure.yields else 1.0
    share = np.arange(1, refine + 1) / refine
    u = np.concatenate([[0.0], (turns[:-1, None] + share * np.diff(turns)[:, None]).ravel()])
    z = _states(structure, u / uy) if structure.yields else np.full(u.size, np.nan)
    couple = (1 - alpha) * square * uy if structure.yields else 0.0
    force = couple * np.nan_to_num(z)
    work = np.concatenate([[0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(u))])
    columns = {
        "displacement": u,
        "force_per_mass": alpha * square * u + force,
        "z": z,
        "hysteretic_work_per_mass": work,
    }
    table = xr.Dataset({name: ("point", column) for name, column in columns.items()})
    table = labels.label(table)
    call = f"hysteresis_loop(refine={refine})"
    return labels.with_run_information(table, "Hysteresis loop", call, {"structure": structure})


def _turns(displacement: Any) -> Array:
    """The prescribed displacements as numbers."""
    turns = as_numbers("displacement", displacement, ALLOWED)
    if turns.ndim != 1 or turns.size < 2 or not np.isfinite(turns).all():
        raise ValueError(f"displacement = {brief(displacement)}; allowed: {ALLOWED}")
    return turns


def _states(structure: Structure, extension: Array) -> Array:
    """``z`` at these extensions over the yield displacement."""
    step = structure.step()
    law, parameters = (FLAG, [2.0]) if step == BILINEAR else (step, structure.law_parameters())
    columns = np.array([float(parameter) for parameter in parameters]).reshape(-1, 1)
    z = np.empty(extension.size)
    follow(by_number((law,)), law.states, extension, columns, z)
    return z
