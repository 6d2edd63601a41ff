"""Errors of `pounding_probability` by formula, elastic pairs: `python benchmarks/elastic_pairs.py`.

For elastic structures the moments are exact, so that the errors are those of crossing theory. Of
each of 200 random pairs (periods 0.2 to 4 s, damping 0.01 to 0.1, on three grounds, in motions of
30 s with an envelope and of 15 s without) the confidence is compared at the gaps that 10 to 90 % of
2048 simulated motions do not close, and the gap for 90 % with the simulated one. Takes a minute.
"""

import itertools

import numpy as np
import xarray as xr

import stochlin as sl

PAIRS, PATHS = 200, 2048
PERIODS, DAMPING = (0.2, 4.0), (0.01, 0.1)  # log-uniform
GROUNDS = {
    "broad band": sl.KanaiTajimi(0.42, 0.6, 0.002),
    "lake bed": sl.KanaiTajimi(2.0, 0.05, 0.002),
    "firm": sl.named_ground("firm", 0.002),
}
MOTIONS = {
    "with envelope": {"duration": 30.0, "envelope": sl.AminAng(4.0, 15.0, 0.35)},
    "without": {"duration": 15.0},
}
SHARES = np.array([0.1, 0.3, 0.5, 0.7, 0.9])  # of motions without pounding


def error_of(pair, ground, motion, seed):
    """Errors of the confidence at each of the shares, and relative error of the last's gap."""
    apart = sl.simulate(pair, ground, paths=PATHS, seed=seed, **motion).separation[:, 0, 1].values
    gaps = np.quantile(apart, SHARES)
    formula = sl.pounding_probability(*pair, ground, gaps, paths=0, points=2, **motion)
    confidence = formula.confidence_of_no_pounding.isel(time=-1).values
    return confidence - SHARES, float(formula.required_gap) / gaps[-1] - 1


def errors():
    """Errors of all pairs: ``confidence`` over pair and share, ``gap`` over pair."""
    random = np.random.default_rng(20)
    kinds = itertools.cycle(itertools.product(GROUNDS.values(), MOTIONS.values()))
    results = []
    for seed, (ground, motion) in zip(range(PAIRS), kinds, strict=False):
        drawn = [np.exp(random.uniform(*np.log(ends), 2)) for ends in (PERIODS, DAMPING)]
        pair = [sl.Bilinear(period, damping) for period, damping in zip(*drawn, strict=True)]
        results.append(error_of(pair, ground, motion, seed))
    confidence, gap = zip(*results, strict=True)
    return xr.Dataset(
        {"confidence": (("pair", "share"), list(confidence)), "gap": ("pair", list(gap))}
    )


if __name__ == "__main__":
    for name, values in errors().items():
        ends = np.percentile(values, [0, 2.5, 50, 97.5, 100])
        print(f"{name}: least, 2.5 %, median, 97.5 %, largest error: {np.round(ends, 3)}")
