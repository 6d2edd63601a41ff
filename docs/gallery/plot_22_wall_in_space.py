"""
A wall fixed in space
=====================

A mass of 25 kg on 98 696 N/m with a damping of 7 %, whose base is shaken at its own frequency of 10
Hz, beside a wall that does not move with the ground. Ten impacts in a second; dots are published
values of code_aster (SDND102), whose step of 0.25 ms is an eighth of a contact.
"""

import warnings

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

import stochlin as sl
from stochlin.charts import CURVES, STYLE

plt.rcParams.update(STYLE)
warnings.simplefilter("ignore")  # no building has 25 kg, or a record of one frequency
w = 20 * np.pi
time = 1e-4 * np.arange(10_001)
base = xr.DataArray(np.sin(w * time), dims="time", coords={"time": time}, attrs={"units": "m/s^2"})
mass = sl.Bilinear(2 * np.pi * np.sqrt(25 / 98_696), damping=0.07, mass=25.0)
start = sl.Start(ground_velocity=-1 / w)
table = sl.pound([mass, sl.Wall("space")], 5e-4, sl.LinearSpring(5.76e7), base, start=start)
published = [-3.58082, -1.22321, -1.88760, -1.89772, -0.684454, -1.11982, -1.20103, -1.07178]

moved = 1e4 * (table.displacement[:, 0] - table.wall_displacement)
color, dash = CURVES[0]
figure, panels = plt.subplots(2, 1, figsize=(7.2, 3.6), sharex=True, layout="constrained")
panels[0].plot(time, moved, color=color, linestyle=dash, label="stochlin")
panels[0].plot(
    [0.05, 0.156, 0.25, 0.4, 0.5, 0.8, 0.9, 1.0], published, "o", ms=4, label="code_aster"
)
panels[0].axhline(5, color="0.5", lw=0.8, label="wall")
panels[0].set(ylabel="in space [0.1 mm]", ylim=(-10, 7))
panels[1].plot(time, 1e-3 * table.contact_force[:, 0], color=color, linestyle=dash)
panels[1].set(ylabel="contact force [kN]", xlabel="time [s]", xlim=(0, 1))
figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper right", ncols=3)
