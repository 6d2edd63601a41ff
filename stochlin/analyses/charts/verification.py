"""A design chart by linearization beside the same by simulation."""

from __future__ import annotations

from dataclasses import replace

import xarray as xr

from stochlin.analyses.charts.charts import ChartSettings, chart_functions
from stochlin.messages import brief


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
    allowed = [key for key, function in functions.items() if "ground" in function.keywords]
    if name not in allowed:
        raise ValueError(f"NAME = {brief(name)} cannot be verified; allowed: {', '.join(allowed)}")
    chart = functions[name]()
    simulated = chart_functions(replace(settings, method="simulation"))[name]()
    shown = next((str(key) for key in simulated if f"{key}_standard_error" in simulated), None)
    kind = simulated.attrs["chart"]
    if shown is None or kind not in ("curves", "plane"):
        raise ValueError(
            f"NAME = {brief(name)} is no chart of curves or of a plane with a simulation to it"
        )
    units = {"units": "1"}
    error = f"{shown}_standard_error"
    chart[f"{shown}_simulated"] = simulated[shown].assign_attrs(units, long_name=f"{shown}, simulated")
    chart[error] = simulated[error]
    chart[f"{shown}_difference"] = (chart[shown] - simulated[shown]).assign_attrs(
        units, long_name=f"{shown}, linearized less simulated"
    )
    largest = float(simulated[error].max())
    return chart.assign_attrs(
        chart=f"compared_{kind}",
        title=f"{chart.attrs['title']}: linearized against simulated",
        comment=f"Simulated on {simulated.attrs['paths']} paths; standard error at most {largest:.2g}.",
    )
