"""Error of every rule for the separation, over modulated motions: `python benchmarks/rules.py`.

30 s under an Amin-Ang envelope (4 s, 15 s, 0.35); hardening 0.02, 0.05, 0.1; T1/T2 from 0.3 to 0.9;
three T2 around the ground's period. Every rule is fed with the simulated mean peaks, except for the
paper's procedure, which has elastic peaks times D. It is judged against the simulated mean of
max |u1 - u2|: its error in the mean over the cases, and the least and largest error. Takes a minute.
"""

import itertools
from collections import defaultdict

import numpy as np

import stochlin as sl
from stochlin.models.envelopes import strong_seconds

QUAKE = sl.AminAng(4.0, 15.0, 0.35)
DURATION, PATHS = 30.0, 1024
HARDENING = (0.02, 0.05, 0.1)
RATIOS = (0.3, 0.5, 0.7, 0.8, 0.9)
GROUNDS = {
    "firm": (sl.KanaiTajimi(2 * np.pi / 15, 0.6), (0.3, 0.6, 1.2)),
    "lake bed": (sl.KanaiTajimi(2.0, 0.05), (0.5, 1.0, 2.0)),
}
FACTORS = (2, 4, 6)
RULES = {
    "elastic": "elastic, eq. (4)",
    "secant": "secant",
    "penzien_1997": "secant at 0.65 of the ductility (Penzien 1997)",
    "iwan_1980": "Iwan 1980",
    "fema_440": "FEMA-440",
}
LINEARIZED, DRIFT, SIMULATED = "linearization", "the drift closure", "simulation"
PAPER = "linearization, with elastic peaks times $D$ (the paper)"


def ensemble(ground, hardening, factor, period):
    """The second structure last, after its neighbours; their motions."""
    structures = [
        sl.Bilinear(ratio * period, 0.05, hardening, reduction_factor=factor) for ratio in (*RATIOS, 1.0)
    ]
    motions = sl.simulate(structures, ground, duration=DURATION, envelope=QUAKE, paths=PATHS)
    uy = [float(sl.linearize(s, ground).yield_displacement) for s in structures]
    return structures, motions, motions.peak_mean.values / uy


def correlations(ground, structures, ductilities):
    """rho of each neighbour with the last structure, by rule."""
    last = structures[-1]
    for n, neighbour in enumerate(structures[:-1]):
        given = {"ductility_1": ductilities[n], "ductility_2": ductilities[-1]}
        for number, s in ((1, neighbour), (2, last)):
            given |= {
                f"{name}_{number}": getattr(s, name) for name in ("period", "damping", "hardening")
            }
        rho = {
            text: float(sl.rules.rho_effective(**given, rule=name).rho) for name, text in RULES.items()
        }
        rho[LINEARIZED] = float(sl.correlate(neighbour, last, ground, closure="gaussian").rho)
        rho[DRIFT] = float(sl.correlate(neighbour, last, ground, closure="drift").rho)
        yield n, rho | {"0 (SRSS)": 0.0, "-1 (sum)": -1.0}


def amplified_peaks(ground, structures):
    """Mean elastic peak of each structure times the linearized D of Fig. 5b."""
    seconds = strong_seconds(DURATION, QUAKE)
    return [
        float(
            sl.peak_response(sl.Bilinear(s.period, s.damping), ground, seconds).peak_mean
            * sl.amplification(s, ground, closure="gaussian").amplification
        )
        for s in structures
    ]


def errors(ground, factor, periods):
    found = defaultdict(list)
    for hardening, period in itertools.product(HARDENING, periods):
        structures, motions, ductilities = ensemble(ground, hardening, factor, period)
        peaks, amplified = motions.peak_mean.values, amplified_peaks(ground, structures)
        apart = motions.separation.values
        stationary = sl.simulate(structures, ground)
        for n, rho in correlations(ground, structures, ductilities):
            truth = np.maximum(apart[:, n, -1], apart[:, -1, n]).mean()
            rho[SIMULATED] = float(stationary.rho[n, -1])
            gaps = {rule: sl.critical_gap(peaks[n], peaks[-1], value) for rule, value in rho.items()}
            gaps[PAPER] = sl.critical_gap(amplified[n], amplified[-1], rho[LINEARIZED])
            for rule, table in gaps.items():
                found[rule].append(float(table.gap) / truth - 1)
    return found


def table():
    """Rows by rule, columns by ground and R: mean (least to largest) error in %."""
    columns = [(name, factor) for name in GROUNDS for factor in FACTORS]
    found = [errors(GROUNDS[name][0], factor, GROUNDS[name][1]) for name, factor in columns]
    heads = [f"{name}, R = {factor}" for name, factor in columns]
    lines = [["$\\rho$ by", *heads], ["---"] * (1 + len(columns))]
    for rule in found[0]:
        percent = [100 * np.array(each[rule]) for each in found]
        cells = [f"{one.mean():+.0f} ({one.min():+.0f} to {one.max():+.0f})" for one in percent]
        lines.append([rule, *cells])
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


if __name__ == "__main__":
    print(table())
