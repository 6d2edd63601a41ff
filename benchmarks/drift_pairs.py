"""Pairs that judge the drift closure's caution: `python benchmarks/drift_pairs.py FILE --work FOLDER`.

For each of five kinds a hundred grounds with four structures each, simulated to half a per cent: the
whole domain, stiff structures on narrow-band ground, the resonance after yield (T within 14 % of
sqrt(hardening) Tg), nearly equal structures, and Clough-Penzien ground. The closure was not fitted to
them. Takes ten minutes or so on two cores; a run that was stopped goes on with what is in FOLDER. FILE
(.nc) takes them all. Times are in ground periods.
"""

import numpy as np
import xarray as xr
from arguments import file_and_work

import stochlin as sl
from stochlin.analyses.tables.storage import save_table, whole_file

KINDS = ("domain", "stiff", "ridge", "equal", "cp")
GROUNDS, STRUCTURES, FIRST = 100, 4, 1000
YEAR = 20261122  # of the seeds
# Parameters stand at the ends of their ranges, too, and may not be rounded beyond them.
KEPT = {"ground": float, "structures": float, "displacement_std": np.float32, "rho": np.float32}
COLUMNS = ("period", "damping", "hardening", "strength")


def drawn(kind, number):
    """Ground and structures: uniform in their logarithms."""
    random = np.random.default_rng([YEAR, number, KINDS.index(kind)])

    def some(low, high, size=None):
        return np.exp(random.uniform(np.log(low), np.log(high), size))

    n = STRUCTURES
    ground = [some(0.03, 0.1 if kind == "stiff" else 1.0), np.nan, np.nan]
    if kind == "cp":
        ground[1:] = some(2.0, 25.0), some(0.2, 1.3)
    hardening, strength, damping = some(0.02, 0.5, n), some(0.3, 4.0, n), some(0.01, 0.1, n)
    period = some(0.25, 4.0) * some(0.577, 1.732, n)
    if kind == "stiff":
        period = some(0.2, 0.5, n)
    if kind == "ridge":
        period = np.sqrt(hardening) * some(0.86, 1.16, n)
    if kind == "equal":
        period = some(0.2, 5.0) * some(0.9, 1.1, n)
        strength = np.clip(some(0.3, 4.0) * some(0.8, 1.25, n), 0.3, 4.0)
        hardening = np.clip(some(0.02, 0.5) * some(0.7, 1.4, n), 0.02, 0.5)
        damping = np.clip(some(0.01, 0.1) * some(0.7, 1.4, n), 0.01, 0.1)
    return ground, [np.clip(period, 0.2, 5.0), damping, hardening, strength]


def models(ground, columns):
    """The same, as stochlin takes them."""
    damping, high_pass_period, high_pass_damping = ground
    soil = sl.KanaiTajimi(1.0, damping)
    if np.isfinite(high_pass_period):
        soil = sl.CloughPenzien(1.0, damping, high_pass_period, high_pass_damping)
    period, damping, hardening, strength = columns
    return sl.Bilinear(period, damping, hardening, reduction_factor=3 * strength), soil


def simulated(kind, number):
    """Parameters, standard deviations and correlations of one ground."""
    ground, columns = drawn(kind, number)
    cases = zip(*columns, strict=True)
    table = sl.simulate(
        [models(ground, case)[0] for case in cases],
        models(ground, columns)[1],
        paths=128,
        relaxation_times=10,
        steps_per_period=16,
        seed=number,
    )
    if (table.status > 1).any():
        raise ArithmeticError(f"{kind} {number}: not stationary")
    return {
        "ground": np.array(ground),
        "structures": np.stack(columns),
        "displacement_std": table.displacement_std.values,
        "rho": table.rho.values,
    }


def kept(folder, kind, number):
    path = folder / f"{kind}_{number}.npz"
    if not path.exists():
        result = simulated(kind, number)
        with whole_file(path) as temporary:
            np.savez(temporary, **result)
        print(path.stem, flush=True)
    return dict(np.load(path))


def labelled(parts):
    """All of them over kind, ground and structure."""
    dims = {
        "ground": ("property",),
        "structures": ("column", "structure"),
        "displacement_std": ("structure",),
        "rho": ("structure", "structure_2"),
    }
    return xr.Dataset(
        {
            name: (
                ("kind", "number", *own),
                np.array([[part[name] for part in row] for row in parts], KEPT[name]),
            )
            for name, own in dims.items()
        },
        coords={
            "kind": list(KINDS),
            "property": ["damping", "high_pass_period", "high_pass_damping"],
            "column": list(COLUMNS),
        },
        attrs={
            "title": "Simulated pairs of bilinear structures",
            "history": "benchmarks/drift_pairs.py",
        },
    )


def main():
    options = file_and_work(__doc__)
    numbers = range(FIRST, FIRST + GROUNDS)
    save_table(
        labelled([[kept(options.work, kind, n) for n in numbers] for kind in KINDS]), options.file
    )


if __name__ == "__main__":
    main()
