"""Charts that the command line does not make with these settings."""

import stochlin as sl

settings = sl.charts.ChartSettings(points=7, damping=0.02, hardening=0.1, closure="drift")
sl.charts.chart_functions(settings)["fig5a"]().to_netcdf("fig5a.nc")
sl.charts.restitution_chart().isel(damping_ratio=slice(None, None, 20)).to_netcdf("restitution.nc")
wave = sl.read_record("wave.txt", dt=0.02, units="g")
sl.charts.portrait_chart(wave, period=1.0, damping=0.05).isel(time=slice(None, None, 50)).to_netcdf(
    "portrait.nc"
)
