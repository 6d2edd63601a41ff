"""Fig. 3: eq. (4) over the period ratio, of elastic structures and with rules for yielding ones."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
import xarray as xr

from stochlin._version import __version__
from stochlin.applications.figures.charts import USUAL_SETTINGS, ChartSettings, register_chart
from stochlin.models.arguments import Points, checked
from stochlin.models.rules.effective_properties import (
    EffectiveRule,
    effective_rule,
    effective_rule_names,
)
from stochlin.solver.correlation.equation_4 import rho_effective, rho_white_noise
from stochlin.solver.tables import labels

PAPER_RULE = "jeng_kasai_maison_1992_unverified"
CURVE_DAMPINGS = (0.01, 0.02, 0.05, 0.1, 0.2)  # of the curves of Fig. 3a
RATIO_ENDS = (0.25, 4.0)  # first and last period ratio of an axis
ESTIMATES = (
    "Estimates, which do not depend on the ground. Compared with nonlinear simulation, separations "
    "by them are off by tens of per cent in both directions."
)
ALIKE_CURVES = 0.01  # of rho, below which two curves cannot be told apart
RHO_VARIABLES = {"rho": ("1", "correlation coefficient ρ")}


@register_chart("fig3a", place=30)
@checked
def white_noise_chart(settings: ChartSettings = USUAL_SETTINGS) -> xr.Dataset:
    """Fig. 3a: eq. (4) over the period ratio, for several damping ratios.

    Parameters
    ----------
    settings : ChartSettings, optional
        Parameters of the charts, of which ``points`` is used.

    Returns
    -------
    xarray.Dataset
        ``rho`` [-] over (``damping``, ``period_ratio``).

    Examples
    --------
    >>> from stochlin.charts import ChartSettings, white_noise_chart
    >>> chart = white_noise_chart(ChartSettings(points=5))
    >>> bool((chart.rho.sel(period_ratio=1, method="nearest") > 0.999).all())
    True
    """
    damping = labels.axis("damping", "damping ratio", list(CURVE_DAMPINGS))
    table = rho_white_noise(ratio_axis(settings.fine_points), 1.0, damping, damping)
    table = table.transpose("damping", "period_ratio")
    return labels.label(table, RHO_VARIABLES).assign_attrs(
        chart="curves",
        title="Stationary correlation of linear structures under white noise, eq. (4)",
        caption="Linear structures of equal damping ratio on white noise ground.",
        comment="Exact for stationary response.",
    )


@register_chart("fig3b", place=30)
def _fig3b(settings: ChartSettings) -> xr.Dataset:
    structures = settings.damping, settings.hardening, settings.ductility
    return effective_rules_chart(*structures, settings.fine_points, settings.curves)


@checked
def effective_rules_chart(
    damping: float,
    hardening: float,
    ductility: float,
    points: Points = 321,
    rules: Sequence[str | EffectiveRule] | None = None,
) -> xr.Dataset:
    """Fig. 3b: eq. (4) with effective periods and damping ratios, one curve for each rule.

    The rule of the paper is that of Jeng, Kasai and Maison (1992). Its constants could not be
    verified, as the picture says. The text of the paper does not state damping, hardening and
    ductility.

    Parameters
    ----------
    damping, hardening : float
        Damping ratio and hardening ratio [-] of both structures.
    ductility : float
        Peak ductility [-] of both structures.
    points : int
        Number of period ratios, from 1/4 to 4.
    rules : list of str or EffectiveRule, optional
        Names of `stochlin.rules.effective_rule_names` or of unverified rules, or rule objects. The
        default is all verified rules, and that of the paper last.

    Returns
    -------
    xarray.Dataset
        ``rho`` [-] over ``rule`` and ``period_ratio``, the ratio of the elastic periods; NaN beyond
        the ductility to which a rule was fitted. The coordinates ``reference`` and ``mark`` over
        ``rule`` state the source of a rule and how it was checked.

    Raises
    ------
    ValueError, TypeError
        If a rule is unknown.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), Fig. 3b; Jeng, Kasai and Maison (1992), Earthquake Spectra 8.

    Examples
    --------
    >>> from stochlin.charts import effective_rules_chart
    >>> chart = effective_rules_chart(
    ...     0.05, 0.05, ductility=4.0, points=5, rules=["iwan_1980", "secant"]
    ... )
    >>> chart.rule.values.tolist()
    ['iwan_1980', 'secant']
    """
    chosen = [effective_rule(rule) for rule in rules or (*effective_rule_names(), PAPER_RULE)]
    ratio = ratio_axis(points, "elastic period ratio T1/T2")
    both = {"damping": damping, "hardening": hardening, "ductility": ductility}
    pair = {f"{name}_{n}": value for name, value in both.items() for n in (1, 2)}
    tables = [rho_effective(ratio, 1.0, **pair, rule=rule)[["rho", "status"]] for rule in chosen]
    for table, rule in zip(tables, chosen, strict=True):
        table["rho"] = table.rho.where(ductility <= rule.largest_ductility)
    curves = {
        rule.title or rule.name: table.rho for rule, table in zip(chosen, tables, strict=True)
    }
    remarks = [
        f"{' and '.join(names)} differ by less than {ALIKE_CURVES:g}."
        for names in combinations(curves, 2)
        if float(abs(curves[names[0]] - curves[names[1]]).max()) < ALIKE_CURVES
    ]
    remarks += [f"{rule.title or rule.name}: {rule.reason}." for rule in chosen if rule.reason]
    chart = along_rules(tables, chosen).transpose(..., "rule", "period_ratio")
    return labels.label(chart, RHO_VARIABLES).assign_attrs(
        chart="curves",
        title="Stationary correlation of bilinear structures by eq. (4) with effective properties",
        caption=f"White noise. Bilinear structures: ξ = {damping:g}, α = {hardening:g}, peak "
        f"ductility {ductility:g} of both; ratio of the elastic periods",
        comment=" ".join([ESTIMATES, *remarks]),
        references="; ".join([labels.PAPER, *(rule.reference for rule in chosen)]),
        history=f"stochlin {__version__}: rho_effective()",
    )


def ratio_axis(points: int, long_name: str = "period ratio T1/T2") -> xr.DataArray:
    """Period ratios of an axis."""
    return labels.axis("period_ratio", long_name, np.geomspace(*RATIO_ENDS, points))


def along_rules(tables: Sequence[xr.Dataset], rules: Sequence[EffectiveRule]) -> xr.Dataset:
    """Tables of single rules joined over ``rule``, with the source and the mark of each rule."""
    names = [rule.name for rule in rules]
    axis = labels.axis("rule", "rule for effective properties", names, units=None)
    table = xr.concat(tables, dim=axis, combine_attrs="drop_conflicts")
    for name, text in (("reference", "source of the rule"), ("mark", "how the rule was checked")):
        entries = [getattr(rule, name) for rule in rules]
        table = table.assign_coords({name: ("rule", entries, {"long_name": text})})
    return table
