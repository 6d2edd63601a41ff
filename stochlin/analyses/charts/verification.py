"""A design chart by linearization beside the same by simulation."""

from __future__ import annotations

from dataclasses import replace

import xarray as xr

from stochlin.analyses.charts.design import ChartSettings, chart_functions

FORMULAS = ("fig3a", "fig3b")  # eq. (4), on white noise: nothing is linearized


def verify_chart(name: str, settings: ChartSettings) -> xr.Dataset:
    """A chart by linearization and by simulation, and their difference.

    Parameters
    ----------
    name : str
        Of a chart with yielding structures, as `chart_functions` lists them.
    settings : ChartSettings

    Returns
    -------
    xarray.Dataset
        The chart, ``rho_simulated``, ``rho_standard_error`` and ``rho_difference`` (linearized less
        simulated); likewise for ``amplification``.

    Raises
    ------
    ValueError
        If there is nothing to simulate under this name.
    """
    functions = chart_functions(replace(settings, method="linearization"))
    if name not in functions or name in FORMULAS:
        allowed = ", ".join(key for key in functions if key not in FORMULAS)
        raise ValueError(f"NAME = {name!r} cannot be verified; allowed: {allowed}")
    chart = functions[name]()
    simulated = chart_functions(replace(settings, method="simulation"))[name]()
    shown = "rho" if "rho" in chart else "amplification"
    units = {"units": "1"}
    error = f"{shown}_standard_error"
    chart[f"{shown}_simulated"] = simulated[shown].assign_attrs(units, long_name=f"{shown}, simulated")
    chart[error] = simulated[error]
    chart[f"{shown}_difference"] = (chart[shown] - simulated[shown]).assign_attrs(
        units, long_name=f"{shown}, linearized less simulated"
    )
    largest = float(simulated[error].max())
    return chart.assign_attrs(
        title=f"{chart.attrs['title']}: linearized against simulated",
        comment=f"Simulated on {simulated.attrs['paths']} paths; standard error at most {largest:.2g}.",
    )
