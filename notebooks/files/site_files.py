"""The files of a made-up site: records in the format of K-NET, and hazard curves of OpenQuake.

The records are two simulated motions on medium ground, and the hazard is a formula. Run it in the
folder in which the files are wanted.
"""

from pathlib import Path

import numpy as np

import stochlin as sl

RATE, DURATION = 100, 24.0  # [Hz], [s]
GAL, COUNTS = 3920, 6182761  # the factor of the counts
OFFSET = -2300  # counts
SITES = ((-99.1400, 19.4300), (-99.0500, 19.4000))
LEVELS = np.geomspace(0.02, 4.0, 15)  # [g]
# ln of the annual frequency of exceedance: c0 + c1 ln a + c2 (ln a)^2, with the acceleration a in g
CURVES = {
    "PGA": (-9.6, -2.6, -0.17),
    "SA(0.5)": (-8.0, -2.5, -0.20),
    "SA(1.0)": (-8.6, -2.4, -0.20),
}
YEARS = 50.0

HEADER = """\
Origin Time       2024/03/11 05:14:00
Lat.              36.120
Long.             138.350
Depth. (km)       21
Mag.              6.4
Station Code      MDE001
Station Lat.      36.3010
Station Long.     138.5020
Station Height(m) 212
Record Time       2024/03/11 05:14:16
Sampling Freq(Hz) {rate}Hz
Duration Time(s)  {duration:g}
Dir.              {direction}
Scale Factor      {gal}(gal)/{counts}
Max. Acc. (gal)   {largest:.3f}
Last Correction   2024/03/11 05:14:01
Memo.             made by stochlin, not recorded
"""


def write_records(folder: Path) -> None:
    """Both horizontal components, eight counts a line."""
    ground = sl.named_ground("medium", intensity=0.008)
    motions = sl.simulated_motions(ground, DURATION, sl.AminAng(3, 11, 0.3), paths=2, seed=11)
    time = np.arange(round(RATE * DURATION)) / RATE
    for path, direction in enumerate(("N-S", "E-W")):
        motion = motions.isel(path=path).interp(time=time, kwargs={"fill_value": 0.0})
        counts = np.round(100 * motion.to_numpy() * COUNTS / GAL).astype(int) + OFFSET
        largest = np.abs(counts - counts.mean()).max() * GAL / COUNTS
        words = {"rate": RATE, "duration": DURATION, "direction": direction, "largest": largest}
        text = HEADER.format(**words, gal=GAL, counts=COUNTS)
        lines = (
            "".join(f"{count:9d}" for count in counts[n : n + 8]) for n in range(0, counts.size, 8)
        )
        name = f"MDE001.{direction[0]}{'S' if direction[0] == 'N' else 'W'}"
        (folder / name).write_text(text + "\n".join(lines) + "\n", encoding="ascii")


def write_hazard(folder: Path) -> None:
    """Mean hazard curves at both sites, a file for each intensity measure."""
    for measure, (c0, c1, c2) in CURVES.items():
        stated = f"generated_by='OpenQuake engine 3.20.1', kind='mean', investigation_time={YEARS}"
        columns = ",".join(["lon", "lat", "depth", *(f"poe-{level:.7f}" for level in LEVELS)])
        rows = [f"#,,,,,,,\"{stated}, imt='{measure}'\"", columns]
        for factor, (lon, lat) in zip((1.0, 1.3), SITES, strict=True):
            log = np.log(LEVELS)
            poe = -np.expm1(-YEARS * factor * np.exp(c0 + c1 * log + c2 * log**2))
            values = ",".join(f"{value:.6E}" for value in poe)
            rows.append(f"{lon:.5f},{lat:.5f},0.00000,{values}")
        name = f"hazard_curve-mean-{measure}_17.csv"
        (folder / name).write_text("\n".join(rows) + "\n", encoding="ascii")


write_records(Path())
write_hazard(Path())
