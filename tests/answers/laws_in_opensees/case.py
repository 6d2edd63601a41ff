"""Buildings that degrade or come back, along prescribed displacements and in a motion of 5 s."""

import numpy as np
import xarray as xr

import stochlin as sl

time = 0.02 * np.arange(251)
shaking = 3.0 * np.sin(2 * np.pi * time * (0.7 + 0.1 * time)) * np.sin(np.pi * time / 5)
motion = xr.DataArray(shaking, dims="time", coords={"time": time}, attrs={"units": "m/s^2"})
turns = 0.02 * np.array([1.5, -1.5, 3.0, -3.0, 1.0, -4.0, 4.0])
hardens = {"period": 0.8, "damping": 0.05, "hardening": 0.05, "yield_displacement": 0.02}
level = hardens | {"hardening": 1e-9}
smooth = hardens | {"beta": 0.6, "exponent": 1.5}
pinched = {"pinching": 0.9, "pinching_rate": 1.0, "pinching_start": 0.15, "pinching_width": 0.2}
pinched |= {"pinching_spread": 0.01, "pinching_coupling": 0.4}
capped = {"cap_ductility": 2.5, "softening": 0.3, "residual": 0.4}
laws = {
    "flag": sl.Flag(**hardens, beta=0.7),
    "decay": sl.BoucWenBaberNoori(**smooth, strength_decay=0.02, stiffness_decay=0.05),
    "pinching": sl.BoucWenBaberNoori(**smooth, **pinched),
    "unloading": sl.ModifiedClough(**level, **capped),
    "cap": sl.ModifiedClough(**level, **capped, unloading_exponent=0.0),
}
loops = [
    sl.hysteresis_loop(law, turns, refine=400).force_per_mass[400::400] for law in laws.values()
]
force = xr.concat(loops, "law").rename(point="turn").assign_coords(law=list(laws))
histories = [sl.respond(law, motion, refine=16).displacement for law in laws.values()]
answer = xr.Dataset(
    {"force": force, "peak": ("law", [np.abs(u).max().item() for u in histories])}
).assign_coords(turn=np.arange(7) + 1)
answer["force"].attrs = {"long_name": "force per mass", "units": "m s-2"}
answer["peak"].attrs = {"long_name": "peak displacement", "units": "m"}
answer.to_netcdf("answer.nc")
