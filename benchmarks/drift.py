"""The drift closure against simulation: `python benchmarks/drift.py --work FOLDER [--save FILE]`.

500 random pairs of unequal structures, drawn after the method was fixed, each simulated to about 1 %;
a run that was stopped goes on with what is in FOLDER. Prints the errors of every closure, and where in
the domain those of the drift closure are. FILE (.nc) takes the pairs, the simulations and what the
closures say; the gallery draws it.
"""

import argparse
import itertools
from pathlib import Path

import numpy as np
import xarray as xr

import stochlin as sl
from stochlin.analyses.correlation.drift.derived import derived_correlation
from stochlin.analyses.linearization.equivalent_systems import solve_derived
from stochlin.analyses.linearization.tolerance import USUAL
from stochlin.analyses.simulation import rare_yielding
from stochlin.analyses.tables.storage import save_table

PAIRS, SEED = 500, 20261207
CLOSURES = ("gaussian", "clipped", "narrow_band", "drift")
WHITE = 1 / 6  # share of the pairs on white noise
HARDENING, STRENGTH, DAMPING = (0.02, 0.5), (0.3, 4.0), (0.01, 0.1)
GROUND_DAMPING, PERIOD, RATIO = (0.03, 1.0), (0.2, 5.0), 3.0
EDGES = (0.2, 0.5, 0.9, 5.0)  # of the shorter period over that of the ground
BANDS = (0.03, 0.1, 0.3, 1.0)


def drawn():
    """Parameters of the pairs, over `case`: uniform in their logarithms; the ground's period is 1."""
    random = np.random.default_rng(SEED)

    def some(low, high, size=PAIRS):
        return np.exp(random.uniform(np.log(low), np.log(high), size))

    pairs = {"ground_damping": some(*GROUND_DAMPING), "white": random.random(PAIRS) < WHITE}
    for number in (1, 2):
        pairs |= {
            f"hardening_{number}": some(*HARDENING),
            f"strength_{number}": some(*STRENGTH),
            f"damping_{number}": some(*DAMPING),
        }
    periods = some(*PERIOD, (20 * PAIRS, 2))
    near = np.abs(np.log(periods[:, 0] / periods[:, 1])) <= np.log(RATIO)
    pairs["period_1"], pairs["period_2"] = periods[near][:PAIRS].T
    return xr.Dataset({name: ("case", values) for name, values in pairs.items()})


def models(pairs):
    """Structures and ground of one case or of many."""
    structures = [
        sl.Bilinear(
            pairs[f"period_{n}"],
            pairs[f"damping_{n}"],
            pairs[f"hardening_{n}"],
            reduction_factor=3 * pairs[f"strength_{n}"],
        )
        for n in (1, 2)
    ]
    white = bool(pairs.white.all())
    return *structures, sl.WhiteNoise() if white else sl.KanaiTajimi(1.0, pairs.ground_damping)


def simulated(pairs, case):
    """Both standard deviations, rho and their standard errors."""
    *structures, ground = models(pairs.isel(case=case).map(float))
    table = sl.simulate(structures, ground, seed=case, steps_per_period=16)
    if (table.status > 1).any():
        raise ArithmeticError(f"case {case} is not stationary")
    error = table.displacement_std_standard_error / table.displacement_std
    return [
        *table.displacement_std.values,
        float(table.rho[0, 1]),
        float(error.max()),
        float(table.rho_standard_error[0, 1]),
    ]


def truth(pairs, folder):
    file, rows = folder / f"pairs_{SEED}.npy", []
    if file.exists():
        rows = np.load(file).tolist()
    while len(rows) < PAIRS:
        rows.append(simulated(pairs, len(rows)))
        if len(rows) % 50 == 0:
            np.save(file, rows)
            print(f"{len(rows)} of {PAIRS} simulated", flush=True)
    return np.array(rows).T


def candidates(pairs):
    """Standard deviations and rho by every closure."""
    *structures, ground = models(pairs)
    for closure in CLOSURES:
        table = sl.correlate(*structures, ground, closure=closure)
        sigma = [table[f"displacement_std_{n}"].values for n in (1, 2)]
        yield closure, (*sigma, table.rho.values)
        if closure == "gaussian":
            sigma = [s / (1 + table[f"bias_{n}"].values) for n, s in enumerate(sigma, start=1)]
            yield "gaussian, map of the bias where known", (*sigma, table.rho.values)
    sides = [solve_derived(structure, ground, "drift", USUAL) for structure in structures]
    sigma = [side.displacement_std.values for side in sides]
    yield "drift, as derived", (*sigma, derived_correlation(*sides).values)


def difference(sigma_1, sigma_2, rho):
    return np.sqrt(sigma_1**2 + sigma_2**2 - 2 * rho * sigma_1 * sigma_2)


def errors(found, exact):
    """Relative of both sigmas, absolute of rho, relative of std(u1 - u2)."""
    sigma = np.stack([found[n] / exact[n] - 1 for n in (0, 1)])
    return sigma, found[2] - exact[2], difference(*found) / difference(*exact) - 1


def line(name, sigma, rho, apart):
    known = ~np.isnan(apart)
    size, apart = np.abs(sigma[~np.isnan(sigma)]), apart[known]
    unsafe = (apart < -0.2).sum()
    print(
        f"{name:40s}{known.sum():5d}{size.mean():8.3f}{np.quantile(size, 0.95):8.3f}"
        f"{np.abs(rho[known]).mean():8.3f}{np.abs(apart).mean():8.3f}{apart.min():8.2f}{unsafe:6d}"
    )


def saved(pairs, exact, found, path):
    """All of it over `case` and `closure`, simulation first."""
    units = {"displacement_std_1": "m", "displacement_std_2": "m", "rho": "1"}
    values = np.stack([exact[:3], *(found[closure] for closure in CLOSURES)])
    table = pairs.assign_coords(closure=["simulation", *CLOSURES]).assign_attrs(
        title="Random pairs of bilinear structures, simulated and by every closure",
        comment="The ground period is 1 s; strength is R/p.",
        history="benchmarks/drift.py",
        stochlin_version=sl.__version__,
    )
    for name, unit in units.items():
        table[name] = ("closure", "case"), values[:, list(units).index(name)], {"units": unit}
    save_table(table, path)


def main():
    rare_yielding.MOST_STEPS = np.inf  # all is simulated that closures are held against
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--work", type=Path, required=True)
    parser.add_argument("--save", type=Path)
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    pairs = drawn()
    exact = truth(pairs, options.work)
    print(f"standard error: sigma {exact[3].mean():.4f} in the mean, rho {exact[4].mean():.4f}")
    print(f"{'':40s}{'n':>5}{'sigma':>8}{'95 %':>8}{'rho':>8}{'u1-u2':>8}{'worst':>8}{'<-20%':>6}")
    white, shown, values = pairs.white.values, {}, {}
    for kind, here in (("Kanai-Tajimi", ~white), ("white noise", white)):
        for name, found in candidates(pairs.isel(case=here)):
            result = errors(found, exact[:3, here])
            shown.setdefault(name, []).append(result)
            values.setdefault(name, np.empty((3, PAIRS)))[:, here] = found
            line(f"{kind}: {name}", *result)
    for name, (soil, noise) in shown.items():
        line(f"all: {name}", *(np.concatenate(both, axis=-1) for both in zip(soil, noise, strict=True)))
    if options.save:
        saved(pairs, exact, values, options.save)
    print("drift on Kanai-Tajimi ground, by the shorter period over the ground's and by ground damping")
    shorter = np.minimum(pairs.period_1, pairs.period_2).values[~white]
    band = pairs.ground_damping.values[~white]
    for low, high in itertools.pairwise(EDGES):
        for narrow, wide in itertools.pairwise(BANDS):
            cell = (shorter >= low) & (shorter < high) & (band >= narrow) & (band < wide)
            if cell.any():
                part = [result[..., cell] for result in shown["drift"][0]]
                line(f"  T/Tg {low:g} to {high:g}, xig {narrow:g} to {wide:g}", *part)


if __name__ == "__main__":
    main()
