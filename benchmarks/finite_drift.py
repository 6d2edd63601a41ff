"""Errors of gaps by the drift closure in time: `python benchmarks/finite_drift.py`.

docs/gallery/finite_pairs.nc has 300 random yielding pairs of five families in motions of finite
length, with their simulated gaps for 50, 84, 90 and 98 %. Prints the errors of
`stochlin.passage_gap` for these pairs, and of what is left of it without one of its parts. With
`--simulate SEED`, draws and simulates other pairs, in a minute or two.
"""

import sys
import warnings
from contextlib import ExitStack
from unittest.mock import patch

import numpy as np
import xarray as xr
from drift_pairs import FILE

import stochlin as sl
from stochlin.files.storage import save_table
from stochlin.kernels.linearization import levels as of_structures
from stochlin.solver.correlation import levels as pairs_at_levels
from stochlin.solver.linearization import levels as structures_at_levels

PAIRS = FILE.with_name("finite_pairs.nc")
PATHS, SEED = 4096, 7
CONFIDENCES = (0.5, 0.84, 0.9, 0.98)
MIDDLE = 2  # number of the confidence of 90 %
BROAD = {
    "Kanai-Tajimi 0.42 s": sl.KanaiTajimi(0.42, 0.6, 0.01),
    "Kanai-Tajimi 1 s": sl.KanaiTajimi(1.0, 0.3, 0.01),
    "white noise": sl.WhiteNoise(0.01),
    "firm": sl.named_ground("firm", 0.01),
    "ec8_b": sl.named_ground("ec8_b", 0.01),
}
NARROW = {
    "lake bed": sl.KanaiTajimi(2.0, 0.05, 0.01),
    "Mexico City": sl.named_ground("mexico_city_1985_yeh_wen", 0.01),
}
GROUNDS = BROAD | NARROW
PARAMETERS = ("period", "damping", "hardening", "reduction_factor")
PERIODS, DAMPING, HARDENING, FACTORS = (0.2, 3.0), (0.02, 0.08), (0.02, 0.2), (1.5, 8.0)
SECONDS = (10.0, 60.0)
# Of each family the grounds, the number of pairs, and what is drawn otherwise: the largest ratio of
# the two periods and of the two reduction factors, the cycles of the longer period, the reduction
# factors.
FAMILIES = {
    "broad band": (BROAD, 150, {}),
    "narrow band": (NARROW, 60, {}),
    "alike": (BROAD, 30, {"ratios": (1.06, 1.2)}),
    "short": (BROAD, 30, {"cycles": (1.5, 5.0)}),
    "weak": (BROAD, 30, {"factors": (8.0, 15.0)}),
}


def envelope_of(number, seconds):
    """One of four envelopes for a motion of this length."""
    return (
        None,
        sl.AminAng(0.13 * seconds, 0.5 * seconds, 10 / seconds),
        sl.GammaEnvelope(2.0, 10 / seconds),
        sl.ShinozukaSato(3.2 / seconds, 20 / seconds),
    )[number]


def drawn(seed):
    """The pairs over ``case``: family, ground, envelope, duration and parameters."""
    random, rows = np.random.default_rng(seed), []

    def between(ends, ratio=None):
        first, second = np.exp(random.uniform(*np.log(ends), 2))
        return (first, second) if ratio is None else (first, first * ratio ** random.uniform(-1, 1))

    for family, (grounds, count, other) in FAMILIES.items():
        ratios = other.get("ratios", (None, None))
        for number in range(count):
            periods, factors = (
                between(PERIODS, ratios[0]),
                between(other.get("factors", FACTORS), ratios[1]),
            )
            sides = [*zip(periods, between(DAMPING), between(HARDENING), factors, strict=True)]
            cycles = other.get("cycles")
            seconds = (
                random.uniform(*SECONDS)
                if cycles is None
                else max(periods) * random.uniform(*cycles)
            )
            ground = [*grounds][number % len(grounds)]
            rows.append([family, ground, random.integers(4), seconds, *sides[0], *sides[1]])
    names = ["family", "ground", "envelope", "seconds"]
    names += [f"{name}_{n}" for n in (1, 2) for name in PARAMETERS]
    columns = zip(names, zip(*rows, strict=True), strict=True)
    return xr.Dataset({name: ("case", list(column)) for name, column in columns})


def cases_of(pairs):
    """Structures, ground and motion of each pair."""
    for number in range(pairs.sizes["case"]):
        case = pairs.isel(case=number)
        both = [[float(case[f"{name}_{n}"]) for name in PARAMETERS] for n in (1, 2)]
        structures = [sl.Bilinear(*values, reduction_factor=factor) for *values, factor in both]
        seconds = float(case.seconds)
        envelope = envelope_of(int(case.envelope), seconds)
        yield (
            structures,
            GROUNDS[str(case.ground.values)],
            {"duration": seconds, "envelope": envelope},
        )


def simulated(pairs):
    """The pairs with their simulated gaps [m] over ``confidence``."""
    gaps = []
    for seed, (structures, ground, motion) in enumerate(cases_of(pairs)):
        table = sl.simulate(structures, ground, paths=PATHS, seed=seed, **motion)
        gaps.append(np.quantile(table.separation[:, 0, 1], CONFIDENCES))
    return pairs.assign(gap=(("case", "confidence"), gaps), confidence=list(CONFIDENCES))


def errors(pairs, confidences=CONFIDENCES):
    """Relative errors of the gaps over case and confidence, and the caution flag."""
    rows, flags = [], []
    for structures, ground, motion in cases_of(pairs):
        tables = [sl.passage_gap(*structures, ground, **motion, confidence=c) for c in confidences]
        rows.append([float(table.required_gap) for table in tables])
        flags.append(int(tables[0].caution))
    needed = pairs.gap.sel(confidence=list(confidences))
    return xr.Dataset({"error": needed.copy(data=rows) / needed - 1, "caution": ("case", flags)})


def errors_of_confidence(pairs):
    """Errors of the probability of no pounding (case, confidence) with the simulated gaps."""
    rows = []
    for (structures, ground, motion), gaps in zip(cases_of(pairs), pairs.gap.values, strict=True):
        gap = xr.DataArray(gaps, dims="gap")
        stays = sl.passage_gap(*structures, ground, **motion, gap=gap).no_pounding_probability
        rows.append(stays.values - CONFIDENCES)
    return np.array(rows)


def _without_map(rows):
    return lambda *args: rows(*args)._replace(correction=np.ones_like(args[-2]))


def _without_slow_mode(rows):
    def all_fast(*args):
        of_all = rows(*args)
        slow = of_all.slow_push**2 / (2 * of_all.slow_rate)
        return of_all._replace(
            displacement=np.sqrt(of_all.displacement**2 + slow), slow_push=0 * of_all.slow_push
        )

    return all_fast


def _at_once(difference):
    def prompt(first, second, *others):
        sides = (
            s._replace(rows=s.rows._replace(growth=0 * s.rows.growth + 1e3))
            for s in (first, second)
        )
        return difference(*sides, *others)

    return prompt


def _without_lag(tables, growth, squares, step):
    ends = np.concatenate([squares[:1], 0.5 * (squares[1:] + squares[:-1]), squares[-1:]])
    return np.maximum(np.repeat(ends[:, None], tables.rows.shape[1], axis=1), of_structures.AT_REST)


def _gaussian(cells, ground, course):
    return np.empty((0, 0, 0))


# What replaces a function of a module, by what is left out.
ROWS, ADDED = structures_at_levels.structure_rows, pairs_at_levels.pair_rows
LEFT_OUT = {
    "nothing": (),
    "the map of simulations": (
        (structures_at_levels, "structure_rows", _without_map(ROWS)),
        (
            pairs_at_levels,
            "pair_rows",
            lambda first, second, added: ADDED(first, second, 0 * added),
        ),
    ),
    "the lag of the level, (14)": ((structures_at_levels, "lagged", _without_lag),),
    "the slow mode, (16)": ((structures_at_levels, "structure_rows", _without_slow_mode(ROWS)),),
    "the lag of the correlation, (17)": (
        (pairs_at_levels, "difference", _at_once(pairs_at_levels.difference)),
    ),
    "the level of the load, (20)": ((pairs_at_levels, "_levels_of_load", _gaussian),),
}


def ablation(pairs):
    """Errors of the gaps for 90 % (case,) without each of the parts."""
    without = {}
    for part, changes in LEFT_OUT.items():
        with ExitStack() as stick:
            for module, name, other in changes:
                stick.enter_context(patch.object(module, name, other))
            without[part] = errors(pairs, CONFIDENCES[MIDDLE : MIDDLE + 1]).error[:, 0]
    return without


def in_words(error):
    """Mean, mean absolute, 95 % of absolute, and worst unsafe error in %."""
    percent = 100 * np.asarray(error)
    size = abs(percent)
    numbers = percent.mean(), size.mean(), np.percentile(size, 95), percent.min()
    rounded = [round(float(number)) + 0 for number in numbers]  # no sign of zeros
    mean, absolute, most, worst = rounded
    return f"{mean:+d} / {absolute} / {most} / {worst:+d}"


if __name__ == "__main__":
    warnings.simplefilter("ignore", sl.ImplausibleInput)  # envelopes of short motions
    if "--simulate" in sys.argv:
        made = simulated(drawn(int(sys.argv[-1])))
        save_table(made.assign_attrs(history="benchmarks/finite_drift.py"), PAIRS)
    pairs = xr.load_dataset(PAIRS, engine="scipy")
    table = errors(pairs)
    off = errors_of_confidence(pairs)
    for flag in (0, 1):
        ends = np.percentile(off[table.caution == flag], [0, 2.5, 97.5, 100])
        print(
            f"confidence with caution {flag}: least, 2.5 %, 97.5 %, largest error",
            np.round(ends, 2),
        )
    print("mean / mean absolute / 95 % of absolute / worst [%], for", *CONFIDENCES)
    kinds = {family: pairs.family == family for family in FAMILIES}
    kinds |= {"caution 0": table.caution == 0, "caution 1": table.caution == 1}
    for kind, which in kinds.items():
        print(
            f"{kind:12}",
            int(which.sum()),
            *(in_words(row[which]) for row in table.error.T),
            sep=" | ",
        )
    narrow = pairs.ground.isin(list(NARROW))
    for part, error in ablation(pairs).items():
        print(f"without {part}: {in_words(error[~narrow])}; narrow bands {in_words(error[narrow])}")
