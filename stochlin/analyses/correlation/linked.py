"""Correlation of two linked structures, by linearization of the coupled system."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Annotated, Any

import numpy as np
import xarray as xr

from stochlin.analyses.correlation.variables import VARIABLES
from stochlin.analyses.linearization.systems.solution import solve_equations
from stochlin.analyses.linearization.systems.systems import (
    check_chain,
    check_laws,
    equations_of_cells,
    solution_table,
)
from stochlin.analyses.linearization.tolerance import USUAL
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.cells import Kinds, flat, in_chunks
from stochlin.analyses.tables.cellwise import is_lazy
from stochlin.models.arguments import checked
from stochlin.models.buildings import MultistoreyBuilding
from stochlin.models.grounds import Ground
from stochlin.models.links import Link
from stochlin.models.parameters import expect
from stochlin.models.structures import Structure
from stochlin.models.systems import check_mass

OF_BOTH = ("rho", "relative_displacement_std", "link_force_std")
OF_DASHPOT = "equivalent_damping_constant"  # only for a dashpot with an exponent
OF_ONE = {
    "displacement_std": "floor",
    "velocity_std": "floor",
    "ductility_std": "element",
    "c_eq": "element",
    "k_eq": "element",
}


def _check_linked(role: str, structure: Structure | MultistoreyBuilding) -> None:
    """Raise an error unless the structure is of one floor, with a mass."""
    if isinstance(structure, MultistoreyBuilding):
        raise TypeError(
            f"{role} has storeys; allowed: structures of one floor. Call "
            "linearize_system([first, second], ground, links=[link])"
        )
    expect(structure, Structure, role)
    check_mass(structure, role)


Linked = Annotated[Structure, _check_linked]


@checked
def correlate_linked(
    first: Linked,
    second: Linked,
    ground: Ground,
    link: Link,
    *,
    closure: str = "gaussian",
) -> xr.Dataset:
    """Response and correlation of two linked structures by statistical linearization.

    Linked structures act on each other. The equivalent coefficients of both are therefore iterated
    together with the covariance of the coupled system, which includes the link. Use `linearize_system`
    for buildings with storeys or more than two structures.

    Parameters
    ----------
    first, second : Bilinear, BoucWen or Hysteretic
        The structures, with a mass [kg]. A ``reduction_factor`` refers to the elastic response of the
        structure without the link.
    ground : WhiteNoise, KanaiTajimi or CloughPenzien
        The ground.
    link : Link
        The link. It may yield, have a dashpot with an exponent, or be a device within one of the
        structures, but have no slack. All parameters but the masses broadcast by dimension name.
    closure : {"gaussian", "clipped"}
        Closure of the linearization, as in `linearize`.

    Returns
    -------
    xarray.Dataset
        Over the dimensions of the parameters: the correlation coefficient ``rho`` [-]; the standard
        deviations ``displacement_std_1`` and ``_2`` [m], ``relative_displacement_std`` [m] of
        ``u_1 - u_2``, ``velocity_std_1`` and ``_2`` [m/s], ``ductility_std_1`` and ``_2`` [-] and
        ``link_force_std`` [N]; the equivalent coefficients ``c_eq_1`` and ``_2`` [-] and ``k_eq_1`` and
        ``_2`` [1/s] of eqs. (9) and (10); and ``status``. If the dashpot of the link has an exponent,
        also ``equivalent_damping_constant`` [N s/m].

    Raises
    ------
    ValueError, TypeError
        If a mass is missing, a structure has storeys, the link has slack, or the closure is unknown.
    ArithmeticError
        If a single case fails; in a table the cell is NaN and its status gives the reason.

    Notes
    -----
    For yielding structures, linearization has the same errors as without a link; nonlinear simulation,
    `simulate` with ``link``, does not have them.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), links between buildings; Westermo, B. D. (1989), Earthquake
    Eng. Struct. Dyn. 18.

    Examples
    --------
    >>> import stochlin as sl
    >>> pair = [sl.Bilinear(T, 0.05, mass=1e6) for T in (0.6, 1.0)]
    >>> ground = sl.WhiteNoise(0.01)
    >>> tied = sl.correlate_linked(*pair, ground, sl.Link(stiffness=1e10))
    >>> round(float(tied.rho), 4), float(tied.status)
    (1.0, 1.0)
    """
    if link.slack is not None:
        raise ValueError(
            "link: slack is given; allowed: none, since a link with slack only pulls, and linearization "
            "requires forces with zero mean; use simulate"
        )
    check_laws((first, second), closure)

    models: dict[str, Any] = {"first": first, "second": second, "ground": ground, "link": link}
    arrays = [array for model in models.values() for array in model.over_cells().values()]
    if is_lazy(*arrays):
        dims = xr.broadcast(*arrays)[0].dims
        kinds: Kinds = dict.fromkeys(_names(link), (dims, float))
        kinds["status"] = dims, np.int8
        table = in_chunks(partial(_linked, closure=closure), models, xr.Dataset(), kinds)
    else:
        table = _linked(models, closure=closure)
    table = labels.label(table, VARIABLES)
    labels.raise_if_lone_failure(table, "correlate_linked", first, second)
    if first.yields or second.yields:
        table = table.assign_attrs(comment=labels.CAUTION_SIGMA)
    return labels.with_run_information(
        table,
        f"Correlation of two linked structures by linearization, {ground.name} ground",
        f"correlate_linked(closure={closure!r})",
        models,
    )


def _names(link: Link) -> list[str]:
    """Names of the variables over all cells, without the status."""
    of_both = [*OF_BOTH, OF_DASHPOT] if link.damping_exponent is not None else OF_BOTH
    return [*of_both, *(f"{name}_{n}" for name in OF_ONE for n in (1, 2))]


def _linked(models: Mapping[str, Any], _: object = None, *, closure: str) -> xr.Dataset:
    """Table of `correlate_linked`, without labels."""
    first, second, ground, link = models.values()
    roles = {"structure_1": first, "structure_2": second, "ground": ground, "link_1": link}
    check_chain(roles)
    cells = flat(roles)
    if not cells.where.size:
        blank = {name: cells.array(np.empty(0)) for name in _names(link)}
        return xr.Dataset({**blank, "status": cells.array(np.empty(0, np.int8), labels.INVALID_INPUT)})
    equations = equations_of_cells(cells, [link])
    whole = solution_table(cells.row, equations, solve_equations(equations, closure, USUAL))
    columns = {"status": cells.array(whole.status.values, labels.INVALID_INPUT)}
    for name in _names(link):
        stem, _, number = name.rpartition("_")
        at = {OF_ONE[stem]: int(number) - 1} if stem in OF_ONE else {"floor": 0, "floor_2": 1, "link": 0}
        array = whole[stem if stem in OF_ONE else name].isel(at, missing_dims="ignore")
        columns[name] = cells.array(array.values)
    return xr.Dataset(columns)
