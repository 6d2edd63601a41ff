"""
Two towers that pound
=====================

A tower of ten storeys stands beside one of five, with a gap of 2 cm, in a synthetic motion. The
towers meet at the levels of the floors of the lower one, where Kelvin elements stand. Top: the
displacement of both at the level of the lower roof; the curve of the right tower is shifted by the
gap. Bottom: the contact force at this level, and the strength of a storey. Lower floors collide at
the same times, with smaller forces.
"""

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

import stochlin as sl
from stochlin.charts import STYLE

plt.rcParams.update(STYLE)
time = 0.02 * np.arange(1000)
noise = np.random.default_rng(3).standard_normal(time.size)
filtered = np.convolve(noise, np.exp(-3 * time) * np.sin(12 * time), "full")[: time.size]
shaking = 0.4 * filtered * sl.GammaEnvelope(1.0, 0.2).at(time)
record = xr.DataArray(shaking, dims="time", coords={"time": time}, attrs={"units": "m/s^2"})

tall = sl.ShearBuilding(
    [2e5] * 10, [2.5e8] * 10, [3.2] * 10, 0.05, hardening=0.05, yield_drifts=0.01
)
low = sl.ShearBuilding([2e5] * 5, [3e8] * 5, [3.2] * 5, 0.05, hardening=0.05, yield_drifts=0.01)
gap = 0.02
table = sl.pound([tall, low], gap, sl.Kelvin(5e8, restitution=0.65), record)

figure, (top, bottom) = plt.subplots(2, 1, figsize=(6.8, 4.4), sharex=True, layout="constrained")
left, right = (table.displacement.sel(structure=n, floor=5) for n in (1, 2))
top.plot(time, 100 * left, "k", lw=1.2, label="tall, fifth floor")
top.plot(
    time, 100 * (right + gap), color="0.55", lw=2.2, zorder=1, label="low, roof, at its distance"
)
top.set(ylabel="displacement [cm]")
bottom.plot(
    time, table.contact_force.isel(contact=-1) / 1e6, "k", lw=1.2, label="contact, lower roof"
)
bottom.axhline(2.5e8 * 0.01 / 1e6, color="0.5", ls="--", label="strength of a tall storey")
bottom.set(xlabel="time [s]", ylabel="force [MN]", xlim=(0, 16))
for axes in (top, bottom):
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1))
periods = [float(b.periods()[0]) for b in (tall, low)]
contact = "contact stiffness 500 MN/m, restitution 0.65"
top.set_title(f"periods {periods[0]:.2f} and {periods[1]:.2f} s, gap 2 cm, {contact}", size=9)
