"""Errors of peaks of `pound` by default time steps: `python benchmarks/peaks_of_steps.py RECORDS`.

RECORDS is a folder with the records elc180.AT2 (El Centro), NIS090.AT2 (Kobe), sct190985.txt (SCT)
and RSN15_KERN_TAF111.txt (Taft). Prints the largest error of a peak displacement, drift, storey
shear and acceleration in per cent: of towers and chains against steps of a 32nd, and of random
pairs that pound against steps of a 16th, with that of nine of ten pairs and the largest.
"""

import sys
import warnings
from pathlib import Path

import numpy as np

import stochlin as sl
from stochlin.applications.pounding.pounding import checked_ensemble
from stochlin.applications.pounding.results import compared_peaks
from stochlin.applications.pounding.rows import build_row, checked_gaps, checked_row
from stochlin.applications.pounding.runs import paces_of, responses, runs_of

RECORDS = {
    "El Centro": ("elc180.AT2", {}),
    "Kobe": ("NIS090.AT2", {"units": "g", "dt": 0.01}),
    "SCT": ("sct190985.txt", {"units": "g", "column": 3, "time_column": 1}),
    "Taft": ("RSN15_KERN_TAF111.txt", {"units": "g", "dt": 0.01}),
}
NAMES = ("displacement", "drift", "storey shear", "acceleration")
USUAL_STEPS = 16
PAIRS = 40
CONTACTS = (
    sl.Kelvin(1e9, restitution=0.65),
    sl.LinearSpring(5e8),
    sl.HertzDamp(2e9, restitution=0.6),
    sl.NoTensionKelvin(2e8, restitution=0.4),
    sl.Kelvin(2e8, restitution=0.3),
)


def peaks(row, gaps, contact, record, steps):
    """Peaks of displacements, drifts, storey shears and accelerations, with steps per contact."""
    neighbours = checked_row(row)
    spaces = checked_gaps(gaps, neighbours.gaps)
    motions, _, _ = checked_ensemble(record, may_be_still=False)
    prepared = build_row(neighbours, spaces, contact, [None] * (len(row) + 1))
    pace = paces_of(prepared, contact, motions.grounds, steps)[0]
    alone = runs_of(prepared, motions.grounds[0], pace, [None] * 3)[:1]
    response = responses(alone, prepared, False, None)[0]
    return [response.peaks, *compared_peaks(prepared, response)[:3]]


def errors(case, finer):
    """Largest relative errors [%] of the peaks of a case, against steps that are so much finer."""
    usual = peaks(*case, USUAL_STEPS)
    fine = peaks(*case, USUAL_STEPS * finer)
    off = [np.abs(u[f > 0] / f[f > 0] - 1) for u, f in zip(usual, fine, strict=True)]
    return [100 * float(column.max(initial=0.0)) for column in off]


def chain(**yields):
    """Storeys of 100 kips/g, 31.54 kips/in, 12 ft and 5 %, as in books on structural dynamics."""
    kip, inch = 4448.2216, 0.0254
    mass = 100 * kip / 9.80665
    return sl.ShearBuilding([mass] * 5, [31.54 * kip / inch] * 5, [144 * inch] * 5, 0.05, **yields)


def tower(storeys, period, coefficient=None):
    """A regular building, elastic without a coefficient of its base shear."""
    strength = {"hardening": 0.05, "base_shear_coefficient": coefficient} if coefficient else {}
    return sl.ShearBuilding.regular(
        period=period, storeys=storeys, storey_height=3.2, mass=3e5, damping=0.05, **strength
    )


def lone_cases(records):
    """Buildings alone by the rows of the table."""
    el_centro, kobe, sct, taft = (records[name] for name in RECORDS)
    yielding = chain(hardening=0.05, yield_drifts=0.01)
    return {
        "elastic chains of 5, 8 and 12 storeys": [
            ([chain()], (), None, el_centro[::2]),
            ([chain()], (), None, el_centro),
            ([tower(8, 0.9)], (), None, kobe),
            ([tower(12, 2.0)], (), None, sct),
        ],
        "yielding towers of 3, 8 and 10 storeys": [
            ([tower(3, 0.3, 0.2)], (), None, taft),
            ([tower(8, 0.9, 0.12)], (), None, kobe),
            ([tower(10, 1.2, 0.1)], (), None, kobe),
        ],
        "a chain of 5 bilinear storeys, El Centro": [([yielding], (), None, el_centro)],
        "a chain of 5 bilinear storeys, Kobe": [([yielding], (), None, kobe)],
    }


def random_structure(random):
    """An oscillator, or a building of two to seven storeys: elastic, bilinear or Bouc-Wen."""
    kind = random.integers(5)
    period = float(np.exp(random.uniform(np.log(0.25), np.log(1.5))))
    if kind == 0:
        return sl.Bilinear(period, 0.05, 0.05, yield_displacement=0.03 * period, mass=2e5)
    storeys = int(random.integers(2, 8))
    coefficient = None if kind == 1 else float(random.uniform(0.08, 0.25))
    regular = tower(storeys, period, coefficient)
    if kind < 4:
        return regular
    shape = regular.masses, regular.stiffnesses, regular.heights, 0.05
    drifts = regular.yield_drifts
    return sl.ShearBuilding(*shape, hardening=0.05, yield_drifts=drifts, law="bouc_wen")


def random_cases(records):
    """Pairs of random structures that pound in parts of three records."""
    random = np.random.default_rng(5)
    parts = (
        records["El Centro"][:1500],
        records["Kobe"][500:2000],
        records["Taft"][200:1700],
    )
    for number in range(PAIRS):
        pair = [random_structure(random), random_structure(random)]
        gap = float(random.uniform(0.003, 0.03))
        yield pair, gap, CONTACTS[number % len(CONTACTS)], parts[number % len(parts)]


def main(folder):
    """Print the table."""
    records = {
        name: sl.read_record(folder / file, **options) for name, (file, options) in RECORDS.items()
    }
    print(f"| structures | {' | '.join(NAMES)} |")
    print("|---" * (1 + len(NAMES)) + "|")
    for row, cases in lone_cases(records).items():
        largest = np.max([errors(case, 32) for case in cases], axis=0)
        print(f"| {row} | {' | '.join(f'{value:.2f}' for value in largest)} |")
    off = np.array([errors(case, 16) for case in random_cases(records)])
    most = off.max(axis=0)
    nine_of_ten = np.quantile(off, 0.9, axis=0)
    pairs = (f"{a:.2f}, {b:.2f}" for a, b in zip(most, nine_of_ten, strict=True))
    print(f"| random pairs that pound: largest, of nine of ten | {' | '.join(pairs)} |")


if __name__ == "__main__":
    warnings.simplefilter("ignore", sl.DoubtfulInput)
    main(Path(sys.argv[1]))
