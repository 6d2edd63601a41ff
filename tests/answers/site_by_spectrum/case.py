"""From a spectrum to motions, and from a motion back to a ground and an envelope."""

import shutil
from pathlib import Path

import numpy as np

import stochlin as sl

G = 9.80665
some = slice(None, None, 40)
sl.asce_7(G, 0.6 * G, 8.0)[some].to_netcdf("asce_7.nc")
code = sl.eurocode_8(0.25 * G, "B")
code[some].to_netcdf("eurocode_8.nc")
periods = np.round(0.05 * np.arange(81), 2)
rows = [
    f"{t:g},{a / G:.6f}" for t, a in zip(periods, code.interp(period=periods).values, strict=True)
]
Path("site.csv").write_text("T [s],Sa [g]\n" + "\n".join(rows) + "\n", encoding="utf-8")
target = sl.read_spectrum("site.csv", elastic=True)
Path("site.csv").unlink()
envelope = sl.AminAng(2.0, 12.0, 0.4)
ground = sl.fit_ground(target, duration=20.0, envelope=envelope, filters=1)
print(ground.source)
both = sl.ParallelGround([ground, sl.CloughPenzien(0.1, 0.5, 1.0, 0.6, intensity=1e-3)])
print(both.psd([1.0, 10.0, 100.0]).values)
spectrum = sl.simulated_spectrum(ground, target, 20.0, envelope, paths=64)
spectrum.isel(period=slice(None, None, 8)).to_netcdf("spectrum.nc")
motions = sl.simulated_motions(ground, 20.0, envelope, paths=2, step=0.02, scatter=0.0)
motions[:, ::50].to_netcdf("motions.nc")
Path("suite").mkdir()
for name, each in zip("ab", motions, strict=True):
    each.to_series().to_csv(f"suite/{name}.csv")
read = sl.read_records("suite", units="m/s^2")
suite = sl.scale_records(read, sa=5.0, period=0.5)
print({name: f"{record.attrs['scale']:.5f}" for name, record in suite.items()})
one, two = (sl.Bilinear(T, 0.05) for T in (0.5, 0.8))
print(sl.recorded_gap(one, two, suite).separation_quantile.values)
shutil.rmtree("suite")
hazard = sl.HazardCurve([1.0, 2.0, 4.0], [1e-2, 2e-3, 3e-4])
law = sl.PowerLawHazard(k0=1e-2, k=2.5, measure="sa", period=0.5)
print(hazard.intensity(475), hazard.frequency(3.0), law.intensity(475), law.frequency(3.0))
for asked in ({"pga": hazard.intensity(475)}, {"sa": law.intensity(475), "period": law.period}):
    strong = sl.scale_ground(sl.named_ground("firm", 1.0), 20.0, envelope, **asked, paths=64)
    print(strong.intensity, strong.source)
motion = sl.fit_motion(motions[1], filters=1)
print(type(motion).__name__ == "FittedMotion", motion.duration)
