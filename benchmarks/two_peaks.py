"""The drift closure's parts on ground with two spectral peaks: `python benchmarks/two_peaks.py`.

docs/gallery/two_peaked_pairs.nc has 200 random pairs of unequal bilinear structures with their
simulated moments. Prints the errors of every part; with `--simulate`, simulates the pairs anew, in
a minute or so.
"""

import sys
from dataclasses import dataclass

import numpy as np
import xarray as xr
from drift_pairs import FILE, MOMENTS, difference, parts, structures

import stochlin as sl
from stochlin.files.storage import save_table
from stochlin.kernels.correlation.errors import error_of_difference
from stochlin.models.grounds import Calibration, Filter, Ground, KanaiTajimi
from stochlin.models.parameters import PERIODS, POSITIVE, Parameter, Range, parameter

PAIRS = FILE.with_name("two_peaked_pairs.nc")
STRUCTURE = ("period", "damping", "hardening", "strength")
SOIL = ("damping", "second_period", "second_damping", "share")
GROUNDS, PATHS = 100, 128
STANDARD_ERROR = "standard_error"  # relative, of the simulated deviation of u_1 - u_2


@dataclass(frozen=True)
class TwoPeaks(Ground):
    """Two soils of Kanai and Tajimi side by side, which one white noise moves.

    The drift closure corrects on it as if there were the first soil alone.
    """

    name = "two peaks"
    calibration = Calibration(KanaiTajimi.calibration.rho_errors, soil=("period", "damping"))
    period: Parameter = parameter("s", "period of the first soil", PERIODS)
    damping: Parameter = parameter("1", "its damping ratio", Range())
    second_period: Parameter = parameter("s", "period of the second soil", PERIODS)
    second_damping: Parameter = parameter("1", "its damping ratio", Range())
    share: Parameter = parameter("1", "factor on the motion of the second soil", POSITIVE)
    intensity: Parameter = parameter("m^2/s^3", "two-sided PSD of the white noise", POSITIVE, 1.0)

    @staticmethod
    def filter(values):
        """The sum of both accelerations."""
        w_1 = 2 * np.pi / values["period"]
        w_2 = 2 * np.pi / values["second_period"]
        first = [w_1**2, 2 * values["damping"] * w_1]
        second = [w_2**2, 2 * values["second_damping"] * w_2]
        return Filter(
            values["intensity"],
            states=("x", "x_rate", "y", "y_rate"),
            matrix=[
                [0, 1, 0, 0],
                [-first[0], -first[1], 0, 0],
                [0, 0, 0, 1],
                [0, 0, -second[0], -second[1]],
            ],
            noise=[0, 1, 0, 1],
            output=[*first, *(values["share"] * term for term in second)],
        )


def simulated_pairs():
    """Two random pairs on each ground, whose first soil has 1 s and the higher peak."""
    random, rows = np.random.default_rng(11), []

    def between(low, high, size=None):
        return np.exp(random.uniform(np.log(low), np.log(high), size))

    for seed in range(GROUNDS):
        first = between(0.04, 0.2)
        second = between(2.0, 5.0) ** random.choice([-1, 1])
        soil = [first, second, between(first, 0.25), between(0.4, 1.0)]
        mean, ratio = between(0.35, 2.9, 2), between(3**-0.5, 3**0.5, 2)
        limits = ((0.01, 0.1), (0.02, 0.5), (0.3, 4.0))
        periods = np.ravel([mean * ratio, mean / ratio], "F")
        parameters = [periods, *(between(*ends, 4) for ends in limits)]
        buildings = [
            sl.Bilinear(*values, reduction_factor=3 * R)
            for *values, R in zip(*parameters, strict=True)
        ]
        table = sl.simulate(buildings, TwoPeaks(1.0, *soil), paths=PATHS, seed=seed)
        std, rho = table.displacement_std.values, table.rho.values
        share, off = (
            table[f"{name}_standard_error"].values for name in ("displacement_std", "rho")
        )
        for n in (0, 2):
            sides = [values[k] for k in (n, n + 1) for values in parameters]
            moments = std[n], std[n + 1], rho[n, n + 1]
            errors = share[n] / std[n], share[n + 1] / std[n + 1], off[n, n + 1] / (1 - moments[2])
            certain, _ = error_of_difference(
                std[n], errors[0], std[n + 1], errors[1], moments[2], errors[2], 0.0
            )
            rows.append([*soil, *sides, *moments, certain])
    names = [f"ground_{name}" for name in SOIL]
    names += [*(f"{name}_{n}" for n in (1, 2) for name in STRUCTURE), *MOMENTS, STANDARD_ERROR]
    columns = zip(names, np.transpose(rows), strict=True)
    return xr.Dataset({name: ("case", column) for name, column in columns})


def errors(pairs):
    """Of every part: errors of standard deviations, of rho and, with sign, of the difference."""
    of_parts, ground = {}, TwoPeaks(1.0, *(pairs[f"ground_{name}"] for name in SOIL))
    exact = [pairs[name].values for name in MOMENTS]
    for name, values in parts(structures(pairs), ground).items():
        std = [abs(values[n] / exact[n] - 1) for n in (0, 1)]
        apart = difference(*values) / difference(*exact) - 1
        of_parts[name] = np.concatenate(std), abs(values[2] - exact[2]), apart
    return of_parts


if __name__ == "__main__":
    if "--simulate" in sys.argv:
        save_table(simulated_pairs().assign_attrs(history="benchmarks/two_peaks.py"), PAIRS)
    pairs = xr.load_dataset(PAIRS, engine="scipy")
    print("standard errors up to", pairs[STANDARD_ERROR].max().item())
    for name, (std, rho, apart) in errors(pairs).items():
        cells = std.mean(), np.percentile(std, 95), rho.mean(), abs(apart).mean(), apart.min()
        print(f"{name:16}", *(f"{value:.3f}" for value in cells), (apart < -0.2).sum())
