"""The data of Fig. 3b: eq. (4) for yielding structures, by the rules for effective properties."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from stochlin._version import __version__
from stochlin.analyses.charts.charts import CHARTS, ChartSettings, chosen_rules
from stochlin.analyses.correlation.effective import rho_effective
from stochlin.analyses.tables import labels
from stochlin.models.rules.effective_properties import EffectiveRule, effective_rule_names


def effective_rules_chart(
    damping: float,
    hardening: float,
    ductility: float,
    points: int = 321,
    rules: Sequence[str | EffectiveRule] | None = None,
) -> xr.Dataset:
    """Fig. 3b: eq. (4) with effective periods and dampings, one curve a rule.

    The paper's own rule is that of Jeng, Kasai and Maison (1992). Its constants could not be verified:
    it is drawn where ``rules`` names it, and says so. Nor does the paper state damping, hardening and
    ductility.

    Parameters
    ----------
    damping, hardening, ductility : float
        Of both structures [-]; the ductility is that of the peak.
    points : int
        Period ratios, from 1/4 to 4.
    rules : list of str, optional
        Names of `stochlin.effective_rule_names`, the unverified among them, or rules; without it those
        that are verified.

    Returns
    -------
    xarray.Dataset
        ``rho`` over (``rule``, ``period_ratio``), the ratio of the elastic periods; along ``rule`` the
        coordinates ``reference`` and ``mark``.

    Raises
    ------
    ValueError
        If a rule is unknown, or there is none.
    """
    chosen = chosen_rules(rules, effective_rule_names())
    ratio = labels.axis("period_ratio", "elastic period ratio T1/T2", np.geomspace(0.25, 4, points))
    both = {"damping": damping, "hardening": hardening, "ductility": ductility}
    pair = {f"{name}_{n}": value for name, value in both.items() for n in (1, 2)}
    tables = [rho_effective(ratio, 1.0, **pair, rule=rule)[["rho", "status"]] for rule in chosen]
    doubts = [f"{rule.title or rule.name}: {rule.reason}." for rule in chosen if rule.reason]
    return along_rules(tables, chosen).assign_attrs(
        chart="curves",
        title="Correlation of bilinear structures by eq. (4) with effective properties",
        caption=f"White noise. Bilinear structures: ξ = {damping:g}, α = {hardening:g}, peak ductility "
        f"{ductility:g} of both; ratio of the elastic periods",
        comment=" ".join(
            [
                "Estimates: the ground is not in them. Against simulation they err by tens of per cent "
                "of the separation, both ways.",
                *doubts,
            ]
        ),
        references="; ".join([labels.PAPER, *(rule.reference for rule in chosen)]),
        history=f"stochlin {__version__}: rho_effective()",
    )


def along_rules(tables: Sequence[xr.Dataset], rules: Sequence[EffectiveRule]) -> xr.Dataset:
    """Tables of one rule each, one after the other, with the source of each rule and its mark."""
    names = [rule.name for rule in rules]
    axis = xr.DataArray(names, dims="rule", name="rule", attrs={"long_name": "effective properties"})
    table = xr.concat(tables, dim=axis, combine_attrs="drop_conflicts")
    for name, text in (("reference", "source of the rule"), ("mark", "how the rule was checked")):
        found = [getattr(rule, name) for rule in rules]
        table = table.assign_coords({name: ("rule", found, {"long_name": text})})
    return table


@CHARTS.register("fig3b", place=30)
def _fig3b(settings: ChartSettings) -> xr.Dataset:
    given = settings.damping, settings.hardening, settings.ductility
    return effective_rules_chart(*given, settings.fine_points, settings.rules)
