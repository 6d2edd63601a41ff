"""Remake the map correcting the drift closure: `python benchmarks/drift_map.py FILE --work FOLDER`.

Simulates 60 structures at a time together with the reference structures, on grounds from narrow to
broad band: their signatures, which are the correlations with the references, whitened. Then
displacements on a coarse grid and on white noise, and between its points where that is too coarse,
and groups of five structures that are nearly equal. Takes two hours or so on two cores; a run that
was stopped goes on with the parts in FOLDER. Then compares with the derived closure. Times are in
ground periods.
"""

import argparse
import itertools
from pathlib import Path

import numpy as np
import xarray as xr

import stochlin as sl
from stochlin.files.storage import whole_file
from stochlin.kernels.correlation.corrections import ENTRIES
from stochlin.kernels.simulation.stepping import LANES
from stochlin.solver.correlation.signatures import (
    OFF_DIAGONAL,
    basis_of,
    derived_signatures,
    drifting_side,
    solved_references,
)
from stochlin.solver.linearization.equivalent_systems import solved_together
from stochlin.solver.simulation import stationary_motions
from stochlin.solver.tables.checks import USUAL_TOLERANCE
from stochlin.solver.tables.interpolation import Grid

HARDENING = (0.02, 0.05, 0.1, 0.2, 0.5)
DAMPING = (0.01, 0.02, 0.05, 0.1)
ELASTIC_DUCTILITY = (3.2, 2.0, 1.25, 1.0, 0.8, 0.63, 0.5, 1 / 3)
GROUND_DAMPING = (0.03, 0.07, 0.17, 0.4, 1.0)
PERIOD = 10 ** (0.1 * np.arange(-7, 8))
# Motions and their length in memories, by elastic ductility: where the drift remembers long, fewer
# do.
PATHS = {3.2: 128, 2.0: 128, 1.25: 128, 1.0: 128, 0.8: 64, 0.63: 64, 0.5: 64, 1 / 3: 32}
MEMORIES = {1 / 3: 4}
LEFT_OUT = (1 / 3, 0.02)  # remembers 18 000 ground periods: corrected as at the next hardening
STEPS_PER_PERIOD = 16
# Displacements on a coarse grid: each part of periods rides on one ground, and the first with a
# period counts. On white noise (infinite ground damping) the period does not matter, and
# ductilities are means.
COARSE_PERIOD = 10 ** (0.05 * np.arange(-20, 21))
COARSE = {
    "elastic_ductility_std": (3.2, 2.0, 1.25, 0.8, 0.5, 1 / 3),
    "hardening": HARDENING,
    "damping": (0.02, 0.05, 0.1),
    "ground_damping": (*GROUND_DAMPING, np.inf),
    "period": COARSE_PERIOD,
}
WINDOWS = (slice(0, 21), slice(10, 31), slice(20, 41))
NOISE_WINDOW = slice(10, 21)
STRUCTURE_STEPS, FEWEST, MOST = 3e9, 64, 256  # of a part, as paths allow between the two limits
# Where displacements are simulated anew, stiff structures on slow ground: near the resonance of the
# yielding structure, T = sqrt(hardening) Tg, and where yielding begins to matter, the map is steep.
FINE = {
    "refined_strength": (0.5, 0.63, 0.71, 0.8, 0.9, 1.0, 1.1, 1.25, 1.6, 2.0),
    "refined_hardening": (0.02, 0.03, 0.05, 0.07, 0.1, 0.14, 0.2, 0.3, 0.5),
    "refined_damping": DAMPING,
    "refined_ground_damping": (0.03, 0.045, 0.07, 0.11, 0.17, 0.4),
    "refined_period": 10 ** (0.05 * np.array([-20, -18, -16, *range(-14, 1)])),
}
# Groups of nearly equal structures, and by how much one of each is off the first in the logarithms
# of period, strength, hardening and damping.
NEAR = {
    "near_strength": (0.5, 0.8, 1.25, 2.0, 3.2),
    "near_hardening": (0.02, 0.05, 0.14, 0.5),
    "near_damping": (0.01, 0.03, 0.1),
    "near_ground_damping": (0.03, 0.1, 0.3, 1.0),
    "near_period": 10 ** (0.14 * np.arange(-5, 6)),
}
# smallest eigenvalue of the correlations in eq. (12), to which smaller ones are raised
LEAST = 1e-3
NEAR_LEFT_OUT = (0.5, 0.02)  # remembers longest
STEPS = np.array([0.02, 0.125, 0.175, 0.175])
SCALES = {"signature_correction": 1e-4, "nearness": 3e-4}
GRID = ("elastic_ductility_std", "hardening", "damping", "ground_damping", "period")
# Period over that of the ground, elastic ductility, hardening, damping. The first ones tell most.
REFERENCES = (
    (0.7, 3.0, 0.2, 0.05),
    (0.45, 3.0, 0.2, 0.05),
    (0.63, 0.01, 0.5, 0.05),
    (0.45, 0.8, 0.05, 0.05),
    (1.5, 1.5, 0.2, 0.05),
    (0.45, 0.8, 0.2, 0.05),
    (0.3, 3.0, 0.2, 0.05),
    (0.3, 3.0, 0.05, 0.05),
    (0.7, 0.8, 0.2, 0.05),
    (0.45, 1.5, 0.05, 0.05),
    (2.3, 1.5, 0.2, 0.05),
    (0.2, 3.0, 0.05, 0.05),
    (1.0, 1.5, 0.2, 0.05),
    (0.2, 0.8, 0.2, 0.05),
    (0.35, 0.5, 0.05, 0.02),
    (3.5, 0.8, 0.2, 0.05),
    (1.0, 3.0, 0.05, 0.05),
    (0.3, 0.8, 0.1, 0.02),
    (0.55, 0.5, 0.1, 0.02),
    (0.25, 2.0, 0.2, 0.05),
)


def building(period, ductility, hardening, damping):
    return sl.Bilinear(period, damping, hardening, reduction_factor=3 * ductility)


def part(ductility, hardening, ground_damping, seed=1):
    """Correlations of structures with references, those between the references, and sigma."""
    structures = [building(p, ductility, hardening, d) for d in DAMPING for p in PERIOD]
    table = sl.simulate(
        structures + [building(*reference) for reference in REFERENCES],
        sl.KanaiTajimi(1.0, ground_damping),
        paths=PATHS[ductility],
        relaxation_times=MEMORIES.get(ductility, 8),
        steps_per_period=STEPS_PER_PERIOD,
        seed=seed,
    )
    if (table.status > 1).any():
        raise ArithmeticError(f"R/p = {ductility}, hardening {hardening}: not stationary")
    count, shape = len(structures), (len(DAMPING), PERIOD.size)
    return {
        "joint": table.rho.values[:count, count:].reshape(*shape, -1),
        "gram": table.rho.values[count:, count:],
        "ductility_std": table.ductility_std.values[:count].reshape(shape),
        "error": table.rho_standard_error.values[:count, count:].reshape(*shape, -1),
        "memory": table.attrs["memory_s"],
    }


def coarse_part(ductility, hardening, ground_damping, seed=1):
    """Ductilities of the structures of the coarse grid, damping by period."""
    white = np.isinf(ground_damping)
    ground = sl.WhiteNoise() if white else sl.KanaiTajimi(1.0, ground_damping)
    ductilities = np.empty((len(COARSE["damping"]), COARSE_PERIOD.size))
    error, memory = np.zeros(1), 0.0
    for row, damping in zip(ductilities, COARSE["damping"], strict=True):
        for window in (NOISE_WINDOW,) if white else WINDOWS[::-1]:
            structures = [building(p, ductility, hardening, damping) for p in COARSE_PERIOD[window]]
            options = {"seed": seed, "steps_per_period": STEPS_PER_PERIOD}
            trial = sl.simulate(
                structures, ground, paths=LANES, relaxation_times=1, **options
            ).attrs
            steps = len(structures) * 25 * trial["memory_s"] / trial["step_s"]
            paths = LANES * round(float(np.clip(STRUCTURE_STEPS / steps, FEWEST, MOST)) / LANES)
            table = sl.simulate(structures, ground, paths=paths, **options)
            if (table.status > 1).any():
                raise ArithmeticError(
                    f"{structures[0].describe()}, {ground.describe()}: not stationary"
                )
            row[window] = table.ductility_std
            row[:] = row[window].mean() if white else row
            relative = table.displacement_std_standard_error / table.displacement_std
            error, memory = np.append(error, relative), max(memory, trial["memory_s"])
    return {"ductility_std": ductilities, "error": error, "memory": memory}


def fine_part(ductility, hardening, ground_damping, seed=4):
    """Ductilities of the structures between the points of the coarse grid."""
    dampings, periods = FINE["refined_damping"], FINE["refined_period"]
    table = sl.simulate(
        [building(p, ductility, hardening, d) for d in dampings for p in periods],
        sl.KanaiTajimi(1.0, ground_damping),
        paths=128 if ductility > 0.6 else 64,
        relaxation_times=8,
        steps_per_period=STEPS_PER_PERIOD,
        seed=seed,
    )
    if (table.status > 1).any():
        raise ArithmeticError(f"R/p = {ductility}, hardening {hardening}: not stationary")
    error = table.displacement_std_standard_error / table.displacement_std
    return {
        "ductility_std": table.ductility_std.values.reshape(len(dampings), -1),
        "error": error.values,
        "memory": table.attrs["memory_s"],
    }


def near_part(ductility, hardening, ground_damping, seed=5):
    """Correlations within each group of nearly equal structures, its middle at the map's point."""
    dampings, periods = NEAR["near_damping"], NEAR["near_period"]
    group = np.concatenate([np.zeros((1, 4)), np.diag(STEPS)]) - STEPS / 5
    middles = [[p, ductility, hardening, d] for d in dampings for p in periods]
    table = sl.simulate(
        [building(*np.exp(np.log(middle) + off)) for middle in middles for off in group],
        sl.KanaiTajimi(1.0, ground_damping),
        paths=32,
        relaxation_times=6,
        steps_per_period=STEPS_PER_PERIOD,
        seed=seed,
    )
    shape = (len(middles), 5, len(middles), 5)
    within = np.arange(len(middles))
    return {
        "rho": table.rho.values.reshape(shape)[within, :, within],
        "error": table.rho_standard_error.values.reshape(shape)[within, :, within],
        "memory": table.attrs["memory_s"],
    }


def saved(folder, ductility, hardening, ground_damping, simulated=part, kind=""):
    path = folder / f"{kind}{ductility:.3g}_{hardening:g}_{ground_damping:g}.npz"
    if not path.exists():
        result = simulated(ductility, hardening, ground_damping)
        with whole_file(path) as temporary:
            np.savez(temporary, **result)
        print(path.stem, f"{result['memory']:.0f}", f"{result['error'].max():.4f}", flush=True)
    return dict(np.load(path))


def grid(period, damping):
    """All structures over the names of the map, and their grounds."""
    axes = {
        "elastic_ductility_std": sorted(ELASTIC_DUCTILITY),
        "hardening": HARDENING,
        "damping": damping,
        "ground_damping": GROUND_DAMPING,
        "period": period,
    }
    arrays = [xr.DataArray(list(v), dims=name, coords={name: list(v)}) for name, v in axes.items()]
    strength, hardening, xi, xig, ratio = arrays
    return building(ratio, strength, hardening, xi), sl.KanaiTajimi(1.0, xig)


def assembled(parts):
    """Simulated signatures and ductilities over the grid."""
    strengths = sorted(ELASTIC_DUCTILITY)
    shape = (len(strengths), len(HARDENING), len(DAMPING), len(GROUND_DAMPING), PERIOD.size)
    signatures, ductility = np.full((*shape, len(REFERENCES)), np.nan), np.full(shape, np.nan)
    for (strength, hardening, ground_damping), result in parts.items():
        at = strengths.index(strength), HARDENING.index(hardening)
        xig = GROUND_DAMPING.index(ground_damping)
        count = len(REFERENCES)
        gram, joint = result["gram"][:count, :count], result["joint"][..., :count]
        signatures[*at, :, xig] = (basis_of(gram) @ joint[..., None])[..., 0]
        ductility[*at, :, xig] = result["ductility_std"]
    return signatures, ductility


def reference_arrays():
    names = ("period", "elastic_ductility_std", "hardening", "damping")
    columns = zip(names, zip(*REFERENCES, strict=True), strict=True)
    return {f"reference_{name}": ("drift_reference", list(column)) for name, column in columns}


def derived(structure, ground):
    """Derived signatures."""
    solved = solved_together((structure,), ground, "drift")
    grounds, place = np.unique(solved.oscillators.soil, axis=1, return_inverse=True)
    of_references = solved_references(
        ground, grounds, USUAL_TOLERANCE, xr.Dataset(reference_arrays())
    )
    rows = derived_signatures(drifting_side(solved.values), of_references, place.ravel())
    (table,) = solved.tables
    return xr.DataArray(table.table(rows.T, ("drift_reference",)), table.shape.coords)


def derived_ductility(structure, ground):
    """Ductilities by the drift closure without its map."""
    table = solved_together((structure,), ground, "drift").dataset()
    clipped = solved_together((structure,), ground, "clipped").dataset()
    return np.hypot(clipped.displacement_std, table.drift_std) / table.yield_displacement


def signature_correction(simulated):
    """Simulated less derived signatures."""
    computed = derived(*grid(PERIOD, DAMPING)).transpose(*GRID, "drift_reference")
    return filled(computed.copy(data=simulated - computed.values))


def filled(correction):
    """Where nothing was simulated, the correction at the next hardening."""
    return correction.fillna(correction.shift(hardening=-1))


def displacement_corrections(coarse, ductility):
    """Logs of simulated over derived on the coarse grid; for less damping by the ratio of both."""
    simulated = on_grid(COARSE, coarse)
    strengths = sorted(simulated.elastic_ductility_std.values)
    simulated = simulated.sel(elastic_ductility_std=strengths)
    soil = exact_over_derived(simulated.isel(ground_damping=slice(-1)))
    white = exact_over_derived(simulated.isel(ground_damping=-1, period=0, drop=True))
    structure, ground = grid(PERIOD, DAMPING[:2])
    logarithm = np.log(derived_ductility(structure, ground)).transpose(*GRID)
    change = filled(logarithm.copy(data=np.log(ductility[:, :, :2])) - logarithm)
    change = change.diff("damping").isel(damping=0, drop=True)  # 0.01 to 0.02
    change = change.sel(elastic_ductility_std=soil.elastic_ductility_std, method="nearest")
    inside = np.log(soil.period.clip(*PERIOD[[0, -1]]))
    change = change.assign_coords(period=np.log(PERIOD)).interp(period=inside.values)
    least = soil.sel(damping=[DAMPING[1]]) - change.assign_coords(period=soil.period.values)
    least = least.assign_coords(damping=[DAMPING[0]]).transpose(*soil.dims)
    return xr.concat([least, soil], "damping").transpose(*soil.dims), white


def exact_over_derived(simulated):
    """The logarithm of simulated ductilities over those by the closure."""
    soil = "ground_damping" in simulated.dims
    names = ("elastic_ductility_std", "hardening", "damping")
    structure = building(simulated.period if soil else 1.0, *(simulated[name] for name in names))
    ground = sl.KanaiTajimi(1.0, simulated.ground_damping) if soil else sl.WhiteNoise()
    derived = derived_ductility(structure, ground)
    return np.log(simulated / derived).transpose(*simulated.dims)


def points(axes):
    """Strength, hardening and ground damping of each part of such a grid."""
    strengths, hardenings, _, ground_dampings, _ = axes.values()
    return list(itertools.product(strengths, hardenings, ground_dampings))


def on_grid(axes, parts, count=()):
    """Parts, damping by period each, over the grid; NaN where there is none."""
    strengths, hardenings, _, ground_dampings, _ = map(list, axes.values())
    whole = np.full([len(axis) for axis in axes.values()] + list(count), np.nan)
    for (strength, hardening, ground_damping), values in parts.items():
        at = strengths.index(strength), hardenings.index(hardening)
        whole[*at, :, ground_dampings.index(ground_damping)] = values
    return xr.DataArray(
        whole,
        dims=[*axes, "nearness_entry"][: whole.ndim],
        coords={name: list(axis) for name, axis in axes.items()},
    )


def refinement(ductility, coarse):
    """What the finer grid adds to the coarse one: nothing at its points, nor where none is."""
    fine = on_grid(FINE, ductility)
    strength, hardening, damping, ground_damping, period = (fine[name] for name in FINE)
    structure, ground = (
        building(period, strength, hardening, damping),
        sl.KanaiTajimi(1.0, ground_damping),
    )
    derived = derived_ductility(structure, ground).transpose(*FINE)
    whole = Grid.of([np.log(coarse[name].values) for name in coarse.dims], coarse.values)
    place = np.array(np.meshgrid(*(np.log(fine[name].values) for name in FINE), indexing="ij"))
    (between,) = whole.at(place.reshape(len(place), -1))
    added = np.log(fine / derived) - between.reshape(fine.shape)
    at_coarse = [
        np.isin(fine[refined].values, coarse[name])
        for name, refined in zip(coarse.dims, FINE, strict=True)
    ]
    at_coarse[2] &= fine.refined_damping.values > DAMPING[0]  # not on the coarse grid
    at_coarse[4] = np.isclose(fine.refined_period.values[:, None], coarse.period.values).any(axis=1)
    added.values[np.ix_(*at_coarse)] = 0
    return added.fillna(0)


def refined(coarse, added):
    """The corrections at the points of both grids together, between which each is interpolated."""
    points = {
        refined: np.union1d(coarse[name].values.round(12), added[refined].values.round(12))
        for name, refined in zip(coarse.dims, FINE, strict=True)
    }
    place = np.array(np.meshgrid(*map(np.log, points.values()), indexing="ij")).reshape(
        len(points), -1
    )
    whole = np.zeros([axis.size for axis in points.values()])
    for grid in (coarse, added):
        axes = [np.log(grid[name].values.round(12)) for name in grid.dims]
        (values,) = Grid.of(axes, grid.values).at(place)  # nothing is added outside the finer grid
        whole += np.nan_to_num(values).reshape(whole.shape)
    return xr.DataArray(whole, coords=points, dims=list(points))


def form_of(share, steps):
    """Matrices G of eq. (12) (ENTRIES, n) from simulated groups of five nearly equal structures.

    The entries are the logarithms of the square roots of the diagonal, and the correlations that
    remain.

    ``share`` (AXES + 1, AXES + 1, n) is ``1 - rho`` of the pairs in each group. The first structure
    is that of the form; each of the others differs from it by one of the ``steps`` (AXES,) of the
    logarithms.
    """
    share = np.clip(share, 0, 0.95)
    form = share / (1 - share)
    matrix = (form[0, 1:, None] + form[0, None, 1:] - form[1:, 1:]) / 2
    matrix = np.moveaxis(matrix, -1, 0)
    slopes, across = _parted(matrix)
    values, vectors = np.linalg.eigh(across)
    # By statistical errors the matrix may not be positive definite.
    _, across = _parted((vectors * np.maximum(values, LEAST)[:, None]) @ np.swapaxes(vectors, 1, 2))
    return np.stack(
        [*np.log(slopes.T / steps[:, None]), *(across[:, i, j] for i, j in OFF_DIAGONAL)]
    )


def _parted(matrix):
    """Square roots of diagonals (n, k) of matrices (n, k, k), and the matrices scaled by them."""
    slopes = np.sqrt(np.diagonal(matrix, axis1=1, axis2=2))
    return slopes, matrix / (slopes[:, :, None] * slopes[:, None])


def nearness(shares):
    """Slopes and their correlations; where they were not simulated, those at the next hardening."""
    forms = {
        point: form_of(np.moveaxis(1 - rho, 0, -1), STEPS).T.reshape(
            len(NEAR["near_damping"]), -1, ENTRIES
        )
        for point, rho in shares.items()
    }
    entries = on_grid(NEAR, forms, (ENTRIES,))
    return entries.fillna(entries.shift(near_hardening=-1))


def labelled(signatures, displacement, white, near):
    table = xr.Dataset(reference_arrays()).assign(
        nearness=near.assign_coords(nearness_entry=np.arange(ENTRIES)),
        signature_correction=signatures.rename(
            elastic_ductility_std="signature_strength", period="signature_period"
        ),
        displacement_correction=displacement.astype("float32"),
        displacement_correction_white_noise=white.astype("float32").rename(
            damping="damping_white_noise"
        ),
    )
    long_names = {
        "elastic_ductility_std": "R/p: elastic standard deviation over the yield displacement",
        "hardening": "hardening ratio of the structure",
        "damping": "damping ratio of the structure",
        "damping_white_noise": "damping ratio of the structure, of the corrections on white noise",
        "ground_damping": "damping ratio of the Kanai-Tajimi ground",
        "signature_strength": "R/p of the structure, of the signatures",
        "signature_period": (
            "period of the structure over the period of the ground, of the signatures"
        ),
        "reference_period": "period of a reference structure over the period of the ground",
        "reference_elastic_ductility_std": "R/p of a reference structure",
        "reference_hardening": "hardening ratio of a reference structure",
        "reference_damping": "damping ratio of a reference structure",
        "signature_correction": "simulated minus derived signature of the structure",
        "displacement_correction": "logarithm of the correction factor, Kanai-Tajimi ground",
        "displacement_correction_white_noise": "logarithm of the correction factor, white noise",
        "refined_strength": "R/p of the structure, of the displacements",
        "refined_hardening": "hardening ratio of the structure, of the displacements",
        "refined_damping": "damping ratio of the structure, of the displacements",
        "refined_ground_damping": "damping ratio of the Kanai-Tajimi ground, of the displacements",
        "refined_period": (
            "period of the structure over the period of the ground, of the displacements"
        ),
        "nearness": (
            "slopes of sqrt(1 - rho) of nearly equal structures, and correlations of the slopes"
        ),
        "nearness_entry": "logarithms of slopes by period, R/p, hardening, damping; correlations",
        "near_strength": "R/p of nearly equal structures",
        "near_hardening": "hardening ratio of nearly equal structures",
        "near_damping": "damping ratio of nearly equal structures",
        "near_ground_damping": (
            "damping ratio of the Kanai-Tajimi ground under nearly equal structures"
        ),
        "near_period": "period of nearly equal structures over the period of the ground",
    }
    for name, long_name in long_names.items():
        table[name].attrs = {"units": "1", "long_name": long_name}
    return table.assign_attrs(
        title="Corrections of the drift closure for bilinear structures, from simulations",
        stochlin_version=sl.__version__,
        history="benchmarks/drift_map.py",
        comment=(
            "The correction factor is the simulated over the derived standard deviation of the "
            "displacement, on a coarse grid. "
            "At the smallest damping ratio they follow from those at "
            "the next one, by the simulated ratio of both; on the finer grid all were simulated. "
            "Structures with the smallest hardening and R/p take too long to simulate, "
            "and have the "
            "corrections of the next hardening. Structures with the "
            "hardening ratio 1, and those that do not yield, are not corrected."
        ),
    )


def main():
    # all is simulated that closures are held against
    stationary_motions.MOST_STEPS_FOR_DRIFT = np.inf
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", type=Path)
    parser.add_argument("--work", type=Path, required=True)
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    wanted = itertools.product(ELASTIC_DUCTILITY, HARDENING[::-1], GROUND_DAMPING)
    parts = {point: saved(options.work, *point) for point in wanted if point[:2] != LEFT_OUT}
    simulated, ductility = assembled(parts)
    coarse = {
        p: saved(options.work, *p, coarse_part, "coarse_")["ductility_std"] for p in points(COARSE)
    }
    displacement, white = displacement_corrections(coarse, ductility)
    fine = {p: saved(options.work, *p, fine_part, "fine_")["ductility_std"] for p in points(FINE)}
    near = {
        p: saved(options.work, *p, near_part, "near_")["rho"]
        for p in points(NEAR)
        if p[:2] != NEAR_LEFT_OUT
    }
    signatures = signature_correction(simulated)
    whole = refined(displacement, refinement(fine, displacement))
    table = labelled(signatures, whole, white, nearness(near))
    save(table, options.file)


def save(table, file):
    packed = {
        name: {"dtype": "int16", "scale_factor": scale, "_FillValue": np.int16(-32768)}
        for name, scale in SCALES.items()
    }
    with whole_file(file) as temporary:
        table.to_netcdf(temporary, engine="scipy", encoding=packed)


if __name__ == "__main__":
    main()
