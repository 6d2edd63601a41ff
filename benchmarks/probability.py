"""Confidences of no pounding by formula, beside simulation: `python benchmarks/probability.py`.

Random pairs of oscillators on random grounds, a group of pairs on each, in motions of a random length
and envelope; four gaps a pair, about the one that half of the motions keep. The regions within which
`pounding_probability` trusts its formulas were chosen on the even groups and are tested on the odd
ones: prints the errors of both within each region and outside. A run that was stopped goes on with
what is in FOLDER.
"""

import argparse
from pathlib import Path

import numpy as np
import xarray as xr

import stochlin as sl

GROUPS, SEED, PAIRS, PATHS, MEDIAN_PATHS = 84, 20270317, 10, 1024, 128
GAPS = xr.DataArray([0.7, 1.0, 1.5, 2.2], dims="level")
PERIOD, DAMPING, HARDENING, FACTOR, RATIO = (0.2, 3.0), (0.02, 0.1), (0.02, 0.3), (1.0, 9.0), 3.0
GROUND_PERIOD, GROUND_DAMPING, DURATION = (0.2, 2.5), (0.03, 1.0), (8.0, 40.0)
KINDS = ("white", "kanai_tajimi", "kanai_tajimi", "kanai_tajimi", "named")
LIKE, ELASTIC = 0.5, 0.1  # shares of pairs of equal properties, and of elastic pairs


def group(number):
    """Two structures over `case`, ground and motion of one group."""
    random = np.random.default_rng([SEED, number])

    def some(low, high, size=None):
        return np.exp(random.uniform(np.log(low), np.log(high), size))

    kind = KINDS[number // 2 % len(KINDS)]
    if kind == "white":
        ground = sl.WhiteNoise(0.01)
    elif kind == "named":
        names = [n for n in sl.ground_names() if isinstance(sl.named_ground(n), sl.CloughPenzien)]
        ground = sl.named_ground(str(random.choice(names)), 0.01)
    else:
        ground = sl.KanaiTajimi(float(some(*GROUND_PERIOD)), float(some(*GROUND_DAMPING)), 0.01)
    duration = float(some(*DURATION))
    rise, fall = duration * random.uniform(0.1, 0.25), duration * random.uniform(0.4, 0.7)
    envelope = sl.AminAng(rise, fall, 3.0 / (duration - fall)) if random.random() < 0.8 else None
    first = some(*PERIOD, PAIRS)
    second = np.clip(first * some(1 / RATIO, RATIO, PAIRS), *PERIOD)
    alike = random.random(PAIRS) < LIKE
    properties = []
    for limits in (DAMPING, HARDENING, FACTOR):
        one, other = some(*limits, PAIRS), some(*limits, PAIRS)
        properties.append((one, np.where(alike, one, other)))
    (d1, d2), (h1, h2), (r1, r2) = properties
    still = random.random(PAIRS) < ELASTIC
    h1, h2, r1, r2 = (np.where(still, v, x) for v, x in ((1.0, h1), (1.0, h2), (0.01, r1), (0.01, r2)))
    pair = [
        sl.Bilinear(*map(over_cases, (T, d, h)), reduction_factor=over_cases(r))
        for T, d, h, r in ((first, d1, h1, r1), (second, d2, h2, r2))
    ]
    return pair, ground, {"duration": duration, "envelope": envelope, "points": 21}


def over_cases(values):
    return xr.DataArray(values, dims="case")


def found(number):
    """Confidences of one group, and what describes its pairs, over `case` and `level`."""
    pair, ground, motion = group(number)
    options = motion | {"seed": number}
    half = sl.pounding_probability(
        *pair, ground, 0.1, confidence=0.5, paths=MEDIAN_PATHS, **options
    ).required_gap_simulated
    gaps = (half * GAPS).where(half > 0, 1.0)
    table = sl.pounding_probability(*pair, ground, gaps, paths=PATHS, **options)
    columns = [f"confidence_of_no_pounding{end}" for end in ("", "_poisson", "_corrected", "_simulated")]
    kept = table[columns]
    names = ["required_gap", "required_gap_corrected", "required_gap_simulated"]
    flags = sl.pounding_probability(*pair, ground, gaps, paths=0, **options)  # by region
    kept = kept.assign(table[names]).assign(flags[["caution", "caution_corrected"]])
    kept = kept.assign(gap=gaps)
    for n, one in enumerate(pair, start=1):
        for name in ("period", "damping", "hardening", "reduction_factor"):
            kept[f"{name}_{n}"] = one.arrays()[name]
    return kept.drop_vars("time").drop_attrs()


def results(folder, groups):
    parts = []
    for number in range(groups):
        file = folder / f"group_{number}.nc"
        if not file.exists():
            found(number).to_netcdf(file, engine="scipy")
        parts.append(xr.load_dataset(file, engine="scipy"))
    return xr.concat(parts, "group")


def line(name, error, cells):
    error = error.where(cells).values
    error = error[np.isfinite(error)]
    if not error.size:
        return f"{name}: none"
    more = f"too large by more than .1 in {(error > 0.1).mean():.1%}, by {error.max():+.2f} at most"
    return f"{name}: {error.size} cases, {more}, {error.min():+.2f} at least"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--work", type=Path, required=True, help="folder of what is simulated")
    parser.add_argument("--groups", type=int, default=GROUPS)
    told = parser.parse_args()
    found = results(told.work, told.groups).isel(time=-1)
    yields = found.hardening_1 < 1
    for half, groups in (("chosen on", slice(0, None, 2)), ("tested on", slice(1, None, 2))):
        part, own = found.isel(group=groups), yields.isel(group=groups)
        for ending in ("", "_corrected"):
            stem = "confidence_of_no_pounding"
            error = part[f"{stem}{ending}"] - part[f"{stem}_simulated"]
            safe = part[f"caution{ending}"] == 0
            print(line(f"{half}, formula{ending}, elastic", error, ~own))
            print(line(f"{half}, formula{ending}, caution 0", error, own & safe))
            print(line(f"{half}, formula{ending}, elsewhere", error, own & ~safe))


if __name__ == "__main__":
    main()
