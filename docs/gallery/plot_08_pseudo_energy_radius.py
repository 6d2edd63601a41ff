r"""
Pseudo energy radius
====================

The response of an elastic structure in the plane of :math:`u` and :math:`\dot u/\omega`, eq. (1),
and the circle of its largest radius. The motion is synthetic; to use a record, read it with
`stochlin.read_record`.
"""

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.patches import Circle

from stochlin.charts import STYLE, portrait_chart

plt.rcParams.update(STYLE)
time = 0.02 * np.arange(1500)
noise = np.random.default_rng(1).standard_normal(time.size)
filtered = np.convolve(noise, np.exp(-1.5 * time) * np.sin(8 * time), "full")[: time.size]
shape = np.minimum(time / 4, 1) * np.exp(-0.25 * np.maximum(time - 12, 0))
record = xr.DataArray(
    0.3 * shape * filtered, dims="time", coords={"time": time}, attrs={"units": "m/s^2"}
)
chart = portrait_chart(record, period=1.0, damping=0.05)

figure, axes = plt.subplots(figsize=(4.6, 5.0), layout="constrained")
axes.plot(chart.displacement, chart.velocity_over_frequency, color="0.45", lw=0.8, label="trace")
radius = float(chart.pseudo_energy_radius)
circle = Circle((0, 0), radius, fill=False, ls="--", lw=1.4, label=f"$r_{{PER}}$ = {radius:.3f} m")
axes.add_patch(circle)
axes.set(xlabel="$u$ [m]", ylabel=r"$\dot u/\omega$ [m]", aspect="equal")
axes.set_title("period 1 s, damping 0.05, synthetic motion", size=9)
figure.legend(loc="outside lower center", ncols=2)
