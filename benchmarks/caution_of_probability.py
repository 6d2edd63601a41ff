"""Cautions of `pounding_probability`: `python benchmarks/caution_of_probability.py --work FOLDER`.

Pairs of the families of `benchmarks/caution.py` in motions of a random length and envelope, one gap a
pair, about the one that half of the motions keep. The confidences by formula at the end of the motion,
with the caution that a simulation of the default size gives them, are compared with another simulation.
A run that was stopped goes on with what is in FOLDER.
"""

import argparse
from pathlib import Path

import numpy as np
from caution import FAMILIES, drawn, models

import stochlin as sl
from stochlin.analyses.tables.storage import whole_file

SEED, PAIRS = 20261126, 150  # pairs of each family
LEVELS, MEDIAN_PATHS, PATHS, OTHER_SEED = (0.7, 1.0, 1.5, 2.2), 128, 8192, 1
STEM, ENDINGS = "confidence_of_no_pounding", ("", "_corrected")


def compared(family, number, seed):
    """Caution, and confidence less the simulated one, by formula and corrected; NaN without it."""
    *pair, ground = models(*drawn(family, number, seed))
    random = np.random.default_rng([seed, FAMILIES.index(family), number, 1])
    duration = float(np.exp(random.uniform(np.log(8.0), np.log(40.0))))
    rise, fall = duration * random.uniform(0.1, 0.25), duration * random.uniform(0.4, 0.7)
    envelope = sl.AminAng(rise, fall, 3.0 / (duration - fall)) if random.random() < 0.8 else None
    motion = {"duration": duration, "envelope": envelope}
    few = sl.simulate(pair, ground, paths=MEDIAN_PATHS, quantiles=[0.5], **motion)
    gap = float(few.separation_quantile[0, 1, 0]) * random.choice(LEVELS)
    table = sl.pounding_probability(*pair, ground, gap, points=21, **motion).isel(time=-1)
    motions = sl.simulate(pair, ground, paths=PATHS, seed=OTHER_SEED, **motion)
    kept = float((motions.separation[:, 0, 1] <= gap).mean())
    return [[float(table[f"caution{end}"]), float(table[STEM + end]) - kept] for end in ENDINGS]


def kept(folder, family, numbers, seed):
    """All pairs of a family, each simulated once."""
    path = folder / f"probability_{family}_{seed}.npz"
    parts = dict(np.load(path)) if path.exists() else {}
    for number in numbers:
        if str(number) not in parts:
            parts[str(number)] = np.array(compared(family, number, seed))
            with whole_file(path) as temporary:
                np.savez(temporary, **parts)
    return np.stack([parts[str(number)] for number in numbers])


def line(name, caution, off):
    caution, off = caution[np.isfinite(off)], off[np.isfinite(off)]
    trusted = off[caution == 0]
    beyond = f"{np.sum(trusted > 0.1):3d} of {trusted.size:4d}, of all {np.sum(off > 0.1):3d}"
    share = trusted.size / max(off.size, 1)
    return f"{name:8s} {off.size:5d} {share:4.0%}   {beyond}   {trusted.max(initial=0):+.2f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--work", type=Path, required=True, help="folder of what is simulated")
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--pairs", type=int, default=PAIRS, help="of each family")
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    parts = {name: kept(options.work, name, range(options.pairs), options.seed) for name in FAMILIES}
    parts["all"] = np.concatenate(list(parts.values()))
    for n, ending in enumerate(ENDINGS):
        print(f"formula{ending}: pairs, share of caution 0, too large by 0.1, and by how much at most")
        for name, part in parts.items():
            print(line(name, *part[:, n].T))


if __name__ == "__main__":
    main()
