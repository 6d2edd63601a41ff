"""Correlation by eq. (4), of linear structures, and of yielding ones with effective properties."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import partial, reduce

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.correlation.closed_forms import white_noise_correlation
from stochlin.models.arguments import checked
from stochlin.models.parameters import Parameter
from stochlin.models.rules.effective_properties import EffectiveRule, YieldingPair, effective_rule
from stochlin.models.structures import LinearPair
from stochlin.solver.linearization.equivalent_systems import Solved
from stochlin.solver.tables import labels
from stochlin.solver.tables.checks import check_table
from stochlin.solver.tables.lazy import Cells, cellwise, in_blocks, valid_cells

EQ_4 = ("period_eq_1", "period_eq_2", "damping_eq_1", "damping_eq_2")  # arguments of eq. (4)


def by_eq_4(pair: Iterable[Cells], *statuses: Cells) -> tuple[Cells, Cells]:
    """Eq. (4) of both periods and both damping ratios, with the worst of the statuses.

    It is NaN where this is a failure, and a failure where it is NaN.
    """
    rho, status = cellwise(partial(_eq_4, len(statuses)), *statuses, *pair, kinds=(float, np.int8))
    return rho, status


@np.errstate(invalid="ignore", divide="ignore")  # invalid cells become NaN by their status
def _eq_4(statuses: int, *cells: Array) -> tuple[Array, Array]:
    rho = white_noise_correlation(*cells[statuses:])
    status = reduce(np.maximum, cells[:statuses])
    status = np.where((status < labels.NOT_CONVERGED) & np.isnan(rho), labels.NOT_PHYSICAL, status)
    return np.where(status < labels.NOT_CONVERGED, np.minimum(rho, 1), np.nan), status


@checked
def rho_white_noise(
    period_1: Parameter, period_2: Parameter, damping_1: Parameter, damping_2: Parameter
) -> xr.Dataset:
    """Correlation coefficient of displacements of two linear oscillators in white noise, eq. (4).

    The equation is exact for the stationary response to one white noise. For any other ground, and
    for structures that yield, it is approximate, as the paper says.

    Parameters
    ----------
    period_1, period_2 : float or array
        Periods [s], positive; all parameters broadcast by dimension name.
    damping_1, damping_2 : float or array
        Damping ratios [-], in (0, 1).

    Returns
    -------
    xarray.Dataset
        Over the dimensions of the parameters: ``rho`` [-] and ``status``.

    Raises
    ------
    ValueError, TypeError
        If a scalar is out of range, a value is not a number, or dimensions do not fit.

    References
    ----------
    Der Kiureghian, A. (1979), UCB/EERC-79/32; Jeng, Kasai and Maison (1992), Earthquake Spectra 8.

    Examples
    --------
    >>> import stochlin as sl
    >>> round(float(sl.rho_white_noise(0.9, 1.0, 0.05, 0.05).rho), 6)
    0.473028
    """
    pair = LinearPair(period_1, period_2, damping_1, damping_2)
    return labels.with_run_information(
        labels.label(in_blocks(_linear_table, {"pair": pair})),
        "Stationary correlation of two linear structures under white noise, eq. (4)",
        "rho_white_noise()",
        {"pair": pair},
    )


def _linear_table(pair: LinearPair) -> xr.Dataset:
    check_table(4, pair)
    rho, status = by_eq_4(pair.cells().values(), labels.status_where(valid_cells(pair)))
    return xr.Dataset({"rho": rho, "status": status})


@checked
def rho_effective(
    period_1: Parameter,
    period_2: Parameter,
    damping_1: Parameter,
    damping_2: Parameter,
    hardening_1: Parameter,
    hardening_2: Parameter,
    ductility_1: Parameter,
    ductility_2: Parameter,
    rule: str | EffectiveRule = "iwan_1980",
) -> xr.Dataset:
    """Correlation of two yielding structures by eq. (4) with effective periods and damping ratios.

    Parameters
    ----------
    period_1, period_2 : float or array
        Elastic periods [s], positive; all parameters broadcast by dimension name.
    damping_1, damping_2 : float or array
        Viscous damping ratios [-], in (0, 1).
    hardening_1, hardening_2 : float or array
        Hardening ratios [-], in (0, 1].
    ductility_1, ductility_2 : float or array
        Peak ductilities [-], positive; below 1 the structure is elastic.
    rule : str or EffectiveRule
        Rule for effective periods and damping ratios, one of `effective_rule_names` or a rule
        object.

    Returns
    -------
    xarray.Dataset
        Over the dimensions of the parameters: ``rho`` [-], ``period_eq_1`` and ``_2`` [s],
        ``damping_eq_1`` and ``_2`` [-], ``status``.

    Raises
    ------
    ValueError, TypeError
        If the rule is unknown, a scalar is out of range or not a number, or dimensions do not fit.

    Notes
    -----
    The result does not depend on the ground. Compared with nonlinear simulation, separations by
    such rules are off by tens of per cent in both directions, most of all on narrow-band ground.

    References
    ----------
    Jeng, Kasai and Maison (1992), Earthquake Spectra 8, for the method; the dataset also has the
    reference of the rule.

    Examples
    --------
    >>> import stochlin as sl
    >>> pair = {"damping_1": 0.05, "damping_2": 0.05, "hardening_1": 0.05, "hardening_2": 0.05}
    >>> table = sl.rules.rho_effective(
    ...     0.7, 1.0, ductility_1=4.0, ductility_2=4.0, **pair, rule="secant"
    ... )
    >>> elastic = sl.rho_white_noise(0.7, 1.0, 0.05, 0.05)
    >>> bool(table.rho > elastic.rho)
    True
    """
    chosen = effective_rule(rule)
    pair = YieldingPair(
        period_1, period_2, damping_1, damping_2, hardening_1, hardening_2, ductility_1, ductility_2
    )
    table = labels.label(in_blocks(partial(_effective_table, chosen), {"pair": pair}))
    return labels.with_run_information(
        table.assign_attrs(rule=chosen.describe()),
        f"Stationary correlation of two yielding structures by eq. (4) and the rule {chosen.name}",
        f"rho_effective(rule={chosen.name!r})",
        {"pair": pair},
        f"{labels.PAPER} {chosen.reference}.",
    )


def _effective_table(rule: EffectiveRule, pair: YieldingPair) -> xr.Dataset:
    valid = valid_cells(pair)
    effective = effective_properties(pair.cells(), rule, valid)
    rho, status = by_eq_4(effective.values(), labels.status_where(valid))
    return xr.Dataset({"rho": rho, **effective, "status": status})


def effective_properties(
    values: Mapping[str, Cells], rule: EffectiveRule, valid: Cells = True
) -> dict[str, Cells]:
    """Effective periods [s] and damping ratios, each over the dimensions of its structure.

    ``values`` has the names of `YieldingPair`. Cells that are not ``valid`` are NaN.
    """
    properties: dict[str, Cells] = dict.fromkeys(EQ_4, np.nan)

    @np.errstate(all="ignore")  # invalid cells, and periods that overflow, are NaN
    def effective(good: Array, *parameters: Array) -> tuple[Array, Array]:
        mu, alpha, period, xi = (np.where(good, value, np.nan) for value in parameters)
        longer = period * rule.period_ratio(mu, alpha)
        return np.where(np.isfinite(longer), longer, np.nan), rule.damping(mu, alpha, xi)

    names = "ductility", "hardening", "period", "damping"
    for n in (1, 2):
        columns = [values[f"{name}_{n}"] for name in names]
        properties[f"period_eq_{n}"], properties[f"damping_eq_{n}"] = cellwise(
            effective, valid, *columns, kinds=(float, float)
        )
    return properties


def effective_pair(solved: Solved, rule: EffectiveRule) -> dict[str, Cells]:
    """Effective properties of two linearized structures at peak ductilities ``p ductility_std``.

    The ductility of an elastic structure is 0, so that it keeps its period and damping ratio.
    """
    values: dict[str, Cells] = {}
    for n, structure in enumerate(solved.structures, start=1):
        parameters = structure.cells()
        side = solved.labelled(n - 1, ["ductility_std"])
        values |= {f"{name}_{n}": parameters[name] for name in ("period", "damping")}
        values[f"hardening_{n}"] = parameters.get("hardening", 1.0)
        values[f"ductility_{n}"] = parameters["peak_factor"] * side["ductility_std"]
    peaks = {f"ductility_peak_{n}": values[f"ductility_{n}"] for n in (1, 2)}
    return effective_properties(values, rule) | peaks
