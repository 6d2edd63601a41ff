"""Charts that the command line does not make with these settings."""

import stochlin as sl

settings = sl.charts.ChartSettings(points=7, damping=0.02, hardening=0.1)
sl.charts.chart_functions(settings)["fig5a"]().to_netcdf("fig5a.nc")
sl.charts.restitution_chart().isel(damping_ratio=slice(None, None, 32)).to_netcdf("restitution.nc")
wave = sl.read_record("wave.txt", dt=0.02, units="g")
sl.charts.portrait_chart(wave, period=1.0, damping=0.05).isel(time=slice(None, None, 50)).to_netcdf(
    "portrait.nc"
)
sl.charts.energy_chart(wave, 1.0, 0.05, hardening=0.05, reduction_factor=4.0).isel(
    time=slice(None, None, 50)
).to_netcdf("energies.nc")
sl.charts.recorded_gap_chart(wave, 0.05, points=5).to_netcdf("critical_gap.nc")
