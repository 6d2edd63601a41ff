"""Loops of laws that degrade or come back, and a building by files beside one that degrades."""

from pathlib import Path

import stochlin as sl

TABLE = """\
mode,,1,2
period [s],,0.72,0.118
level [m],mass [t],shape,shape
6,220,1,1
3,300,0.5,-1.467
"""
PUSH = ["displacement [cm],base shear [kN]", "0,0", "2,600", "4,1000", "8,1150", "16,1200"]

pinching = {"pinching": 0.9, "pinching_rate": 1.0, "pinching_start": 0.15}
strong = {"period": 0.6, "damping": 0.05, "hardening": 0.05, "yield_displacement": 0.02}
laws = {
    "decay": sl.BoucWenBaberNoori(**strong, strength_decay=0.02, stiffness_decay=0.05, **pinching),
    "clough": sl.ModifiedClough(**strong),
    "flag": sl.Flag(**strong),
    "backbone": sl.ModifiedClough(
        **strong,
        cracking=0.4,
        uncracked_stiffness=2.5,
        cap_ductility=1.5,
        softening=0.4,
        residual=0.2,
    ),
}
history = [0.05, -0.05, 0.03]
for name, structure in laws.items():
    sl.hysteresis_loop(structure, history, refine=8).to_netcdf(f"{name}.nc")

Path("tower.csv").write_text(TABLE, encoding="utf-8")
Path("push.csv").write_text("\n".join(PUSH), encoding="utf-8")
ideal = sl.bilinear_of(sl.read_pushover("push.csv"))
modes = sl.read_modes("tower.csv")
tower = sl.ModalBuilding.from_table(modes, damping=0.05).with_pushover(ideal)
ground = sl.named_ground("firm", intensity=0.01)
motions = sl.simulate([tower, laws["decay"]], ground, duration=10.0, paths=64)
motions[["peak_mean", "separation_mean"]].to_netcdf("motions.nc")
