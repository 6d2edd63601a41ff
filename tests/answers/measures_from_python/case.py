"""What helps two elastic buildings that stand 3 cm apart."""

import numpy as np
import xarray as xr

import stochlin as sl

pair = [sl.Bilinear(T, 0.05, mass=m) for T, m in ((0.6, 2e5), (1.0, 3e5))]
measures = {
    "dampers": sl.Measure(added_damping_1=0.1, added_damping_2=0.1),
    "link": sl.Measure(link=sl.Link(damping_constant=4e5)),
    "rubber": sl.Measure(contact=sl.Kelvin(5e6, restitution=0.4)),
    "pads": sl.Measure(contact=sl.Kelvin(5e7, restitution=0.4), bumper_thickness=0.01),
    "walls": sl.Measure(stiffening_1=2.0, stiffening_2=1.5),
    "fluid": sl.Measure(
        link=[sl.Link(0.0, 2e5, damping_exponent=0.5, structures=(s, s), floors=(1, 0)) for s in (1, 2)]
    ),
}
time = 0.02 * np.arange(300)
record = xr.DataArray(
    1.5 * np.sin(7 * time) * np.sin(np.pi * time / 6), dims="time", coords={"time": time}
)
options = {"contact": sl.Kelvin(1e8, restitution=0.65), "records": {"made": record}}
firm = sl.named_ground("firm", intensity=0.002)
sl.mitigate(*pair, firm, 10.0, 0.03, measures, paths=64, confidence=0.8, **options).to_netcdf(
    "measures.nc"
)
