"""Equivalent coefficients, eqs. (9) and (10), from the moments of one element."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from stochlin.models.laws.hysteretic import law_of
from stochlin.models.parameters import POSITIVE, Model, Parameter, Range, parameter
from stochlin.models.structures import GAUSSIAN, Structure
from stochlin.solver.linearization.equivalent_systems import in_columns
from stochlin.solver.tables import labels
from stochlin.solver.tables.cells import flat
from stochlin.solver.tables.lazy import in_blocks

if TYPE_CHECKING:
    import sympy


@dataclass(frozen=True)
class Moments(Model):
    """Moments of the ductility rate and the hysteretic displacement ``z`` of an element."""

    of_arguments = True

    velocity_std: Parameter = parameter("1/s", "standard deviation of the ductility rate", POSITIVE)
    z_std: Parameter = parameter("1", "standard deviation of z", POSITIVE)
    velocity_z_corr: Parameter = parameter(
        "1", "correlation of the ductility rate and z", Range(-1.0, 1.0)
    )


def equivalent_coefficients(
    velocity_std: Parameter,
    z_std: Parameter,
    velocity_z_corr: Parameter,
    law: str | sympy.Expr = "bilinear",
    **law_parameters: Any,
) -> xr.Dataset:
    """Equivalent coefficients of ``z' = -c_eq v - k_eq z``, eqs. (9) and (10), for given moments.

    They are the coefficients of the linear regression of ``G(v, z)`` on ``v`` and ``z``, for the
    hysteresis law ``z' = G(v, z)`` and a Gaussian joint density.

    Parameters
    ----------
    velocity_std : float or array
        Standard deviation of the ductility rate ``v`` [1/s], positive. It is the velocity over the
        yield displacement, or for a storey the drift rate over the yield drift.
    z_std : float or array
        Standard deviation of ``z`` [-], positive.
    velocity_z_corr : float or array
        Correlation [-] of ``v`` and ``z``, between -1 and 1. All parameters broadcast by dimension
        name.
    law : str or sympy.Expr
        Hysteresis law: ``"bilinear"``, ``"bouc_wen"``, another registered one, or an expression as
        for `Hysteretic`.
    **law_parameters : float or array
        Parameters of the law [-], such as ``beta=0.6, gamma=0.4``.

    Returns
    -------
    xarray.Dataset
        Over the dimensions of the parameters: ``c_eq`` [-], ``k_eq`` [1/s] and ``status``.

    Raises
    ------
    ValueError, TypeError
        If a scalar is out of range or not a number, the law is unknown, or dimensions do not fit.
    ArithmeticError
        If a single case is beyond the range of numbers; in a table the cell is NaN.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (8) to (10); the available text lacks the coefficients,
    which are derived here for the bilinear law. Wen, Y. K. (1980), J. Appl. Mech. 47, for the
    Bouc-Wen law.

    Examples
    --------
    >>> import stochlin as sl
    >>> found = sl.equivalent_coefficients(velocity_std=1.0, z_std=0.5, velocity_z_corr=0.3)
    >>> round(float(found.c_eq), 10), round(float(found.k_eq), 10)
    (-0.9649205716, 0.162719435)

    The coefficients that `linearize` returns are those for its moments:

    >>> one = sl.linearize(sl.Bilinear(1.0, 0.05, 0.05, reduction_factor=4), sl.WhiteNoise(0.01))
    >>> rate = one.velocity_std / one.yield_displacement
    >>> again = sl.equivalent_coefficients(rate, one.z_std, one.velocity_z_corr)
    >>> bool(abs(again.k_eq / one.k_eq - 1) < 1e-9)
    True
    """
    moments = Moments(velocity_std, z_std, velocity_z_corr)
    structure = law_of(law, {"period": 1.0, "damping": 0.05}, law_parameters)
    models: dict[str, Model] = {"moments": moments, "law": structure}
    table = in_blocks(_of_moments, models)
    labels.raise_if_lone_failure(table, "equivalent_coefficients", *models.values())
    law_name = law if isinstance(law, str) else f"{law}"
    return labels.with_run_information(
        labels.label(table),
        "Equivalent coefficients, eqs. (9) and (10)",
        f"equivalent_coefficients(law={law_name!r})",
        models,
    )


@np.errstate(all="ignore")  # cells out of range are NaN
def _of_moments(moments: Moments, law: Structure) -> xr.Dataset:
    cells = flat({"moments": moments, "law": law}, settled=False)
    moments = cells.models["moments"]
    valid = cells.models["law"]
    parameters = (parameter.to_numpy() for parameter in valid.law_parameters())
    rows = in_columns([*moments.cells().values(), *parameters], cells.where.size)
    slip, relaxation = law.closure(GAUSSIAN)(rows[:3], rows[3:]).coefficients
    table = xr.Dataset({"c_eq": cells.array(slip - 1), "k_eq": cells.array(relaxation)})
    return table.assign(status=labels.status_where(table.c_eq.notnull() & table.k_eq.notnull()))
