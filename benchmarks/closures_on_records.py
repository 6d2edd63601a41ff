"""The drift closure's parts beside records: `python benchmarks/closures_on_records.py RECORDS`.

RECORDS is a folder whose table suites.csv lists records with their event; of its folder far_field
the first of each earthquake counts, as it stands. Prints, for every part and R, the computed
standard deviation of u_1 - u_2 over its root mean square in the strong part of a record, less 1:
geometric means over six pairs, with the mean over the records and its standard error.

The stationary ground is fitted to the strong part, which brings 90 % of the energy, and has its
mean square. The estimator of the fit may stand after RECORDS, such as psd; otherwise it is whittle.
Displacements at yield follow from the recorded elastic response, of which R is.
"""

import csv
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from drift_pairs import difference, parts

import stochlin as sl
from stochlin.applications.records.records import strong_part
from stochlin.models.grounds import rms_acceleration

PERIODS = ((0.3, 0.45), (0.5, 0.8), (1.0, 0.6), (1.0, 1.4), (1.8, 1.2), (2.5, 1.5))  # s
FACTORS = (None, 2, 4)  # the first: elastic
DAMPING, HARDENING, PEAK_FACTOR = 0.05, 0.05, 3


def rms(values):
    return float(np.sqrt((values**2).mean()))


def chosen(folder):
    """The first record of each earthquake."""
    files = {}
    with (folder / "suites.csv").open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            if row["file"].startswith("far_field") and not row["flag"]:
                files.setdefault(row["event"], row["file"])
    records = sl.read_records(folder / "suites.csv")
    return [records[name] for name in files.values()]


def building(period, factor, elastic):
    """One that yields at its recorded ``elastic`` response by a ``factor``."""
    if factor is None:
        return sl.Bilinear(period, DAMPING)
    yields = PEAK_FACTOR * rms(elastic) / factor
    return sl.Bilinear(period, DAMPING, HARDENING, yield_displacement=yields)


def ratios(record, estimator):
    """Computed over recorded deviation of u_1 - u_2, (R, pair), of every part."""
    strong = strong_part(record)
    ground = replace(sl.fit_ground(record, estimator=estimator), scatter=0.0)
    level = (rms(strong) / rms_acceleration(ground)) ** 2
    ground = replace(ground, intensity=level * ground.intensity)

    def moved(structure):
        return sl.respond(structure, record).displacement.sel(time=strong.time)

    quotients = {}
    for factor in FACTORS:
        for pair in PERIODS:
            sides = [building(T, factor, moved(sl.Bilinear(T, DAMPING))) for T in pair]
            relative = rms(moved(sides[0]) - moved(sides[1]))
            for name, values in parts(sides, ground).items():
                computed = np.squeeze(difference(*values))
                quotients.setdefault(name, []).append(computed / relative)
    return {name: np.reshape(values, (len(FACTORS), -1)) for name, values in quotients.items()}


if __name__ == "__main__":
    folder, estimator = [*sys.argv[1:], "whittle"][:2]
    of_records = [ratios(record, estimator) for record in chosen(Path(folder))]
    print(f"{len(of_records)} records; R =", *("elastic" if R is None else R for R in FACTORS))
    for name in of_records[0]:
        logs = np.array([np.log(of_record[name]).mean(axis=-1) for of_record in of_records])
        error = logs.std(axis=0, ddof=1) / np.sqrt(len(of_records))
        cells = zip(np.exp(logs.mean(axis=0)) - 1, error, strict=True)
        print(f"{name:16}", *(f"{mean:+.2f} ({width:.2f})" for mean, width in cells))
