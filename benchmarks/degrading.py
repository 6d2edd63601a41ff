"""What degradation does to gaps in recorded earthquakes: `python benchmarks/degrading.py RECORDS`.

RECORDS is a folder whose table suites.csv lists two suites, as `read_records` takes it; records from its
folder mexico_city are of a lake bed, the others are the far field. Records of a suite are scaled to its
mean spectrum over the periods of the buildings. Two buildings of 1.0 and 0.6 s stand side by side, with
the bilinear law and with laws that degrade, all of the same stiffness and strength. Takes two
minutes.
"""

from __future__ import annotations

import argparse
import warnings
from pathlib import Path

import numpy as np
import xarray as xr

import stochlin as sl
from stochlin.messages import DoubtfulInput

PERIODS = (1.0, 0.6)  # s
RATIOS = {"far field": 4.0, "lake bed": 2.0}  # of the mean elastic peak and the yield displacement
BAND = (0.3, 2.0)  # s, between which records meet the mean spectrum of their suite
LAWS = {
    "bilinear": (sl.Bilinear, {}),
    "peak-oriented": (sl.ModifiedClough, {}),
    "degrading, pinching": (
        sl.BoucWenBaberNoori,
        {"exponent": 2.0, "strength_decay": 0.02, "stiffness_decay": 0.05, "pinching": 0.9},
    ),
    "flag": (sl.Flag, {"beta": 0.9}),
}


def suites_of(folder: Path) -> dict[str, dict[str, xr.DataArray]]:
    """Both suites, each scaled to its mean spectrum over `BAND`."""
    records = sl.read_records(folder / "suites.csv")
    suites = {
        "far field": {name: record for name, record in records.items() if "mexico_city" not in name},
        "lake bed": {name: record for name, record in records.items() if "mexico_city" in name},
    }
    return {name: _scaled(suite) for name, suite in suites.items()}


def _scaled(suite: dict[str, xr.DataArray]) -> dict[str, xr.DataArray]:
    periods = np.geomspace(*BAND, 16)
    period = xr.DataArray(periods, dims="period", coords={"period": periods})
    logs = [
        np.log(sl.response_spectrum(record, period, 0.05).pseudo_acceleration)
        for record in suite.values()
    ]
    mean = np.exp(sum(logs) / len(logs)).assign_attrs(damping=0.05)
    return sl.scale_records(suite, spectrum=mean, band=BAND)


def _residual(structure: sl.Bilinear, record: xr.DataArray) -> float:
    """Size of the drift [m] at rest after a record."""
    return abs(float(sl.respond(structure, record, damage=True).residual_drift))


def main() -> None:
    """Print a line for each suite and law."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("records", type=Path)
    folder = parser.parse_args().records
    warnings.simplefilter("ignore", DoubtfulInput)
    for name, suite in suites_of(folder).items():
        elastic = sl.recorded_gap(*(sl.Bilinear(period, 0.05) for period in PERIODS), suite)
        yields = [float(peak.mean()) / RATIOS[name] for peak in (elastic.peak_1, elastic.peak_2)]
        gaps, pairs = {}, {}
        for law, (kind, own) in LAWS.items():
            pairs[law] = [
                kind(period, 0.05, 0.05, yield_displacement=uy, **own)
                for period, uy in zip(PERIODS, yields, strict=True)
            ]
            gaps[law] = sl.recorded_gap(*pairs[law], suite)
        print(f"{name}: {len(suite)} records, yield displacements {yields[0]:.4f} and {yields[1]:.4f} m")
        usual = gaps["bilinear"].separation
        for law, table in gaps.items():
            ratio = np.log(table.separation / usual)
            ductility = [float((table[f"peak_{n}"] / yields[n - 1]).mean()) for n in (1, 2)]
            residual = float(np.mean([_residual(pairs[law][0], record) for record in suite.values()]))
            share = float((table.separation > usual.quantile(0.9)).mean())
            print(
                f"  {law:20s} median gap over bilinear {float(np.exp(ratio.median())):.2f}, "
                f"scatter {float(ratio.std()):.2f}, largest {float(np.exp(ratio.max())):.2f}; "
                f"beyond the gap for 90 % of bilinear pairs: {share:.2f}; "
                f"peak ductility {ductility[0]:.1f} and {ductility[1]:.1f}; "
                f"residual drift of the first {100 * residual:.2f} cm"
            )


if __name__ == "__main__":
    main()
