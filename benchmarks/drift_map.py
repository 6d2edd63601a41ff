"""Remake the map that corrects the drift closure: `python benchmarks/drift_map.py FILE --work FOLDER`.

Simulates 60 structures at a time together with the reference structures, on grounds from narrow to broad
band: their signatures, which are the correlations with the references, whitened. Takes a quarter of an
hour or so on two cores; a run that was stopped goes on with the parts in FOLDER. Then compares with the
derived closure, and the map of the bias with it, too. Times are in ground periods.
"""

import argparse
import itertools
from pathlib import Path

import numpy as np
import xarray as xr

import stochlin as sl
from stochlin.analyses.correlation.drifting_signatures import derived_signatures
from stochlin.analyses.linearization.bias_map import bias_map
from stochlin.analyses.linearization.equivalent_systems import solve_derived
from stochlin.analyses.linearization.tolerance import USUAL
from stochlin.analyses.simulation import rare_yielding
from stochlin.analyses.tables.storage import whole_file
from stochlin.kernels.correlation.signatures import signature

rare_yielding.MOST_STEPS = np.inf  # all is simulated that closures are held against

HARDENING = (0.02, 0.05, 0.1, 0.2, 0.5)
DAMPING = (0.01, 0.02, 0.05, 0.1)
ELASTIC_DUCTILITY = (3.2, 2.0, 1.25, 0.8, 0.5, 1 / 3)
GROUND_DAMPING = (0.03, 0.07, 0.17, 0.4, 1.0)
PERIOD = 10 ** (0.1 * np.arange(-7, 8))
# Motions and their length in memories, by elastic ductility: where the drift remembers long, fewer do.
PATHS = {3.2: 128, 2.0: 128, 1.25: 128, 0.8: 64, 0.5: 64, 1 / 3: 32}
MEMORIES = {1 / 3: 4}
LEFT_OUT = (1 / 3, 0.02)  # remembers 18 000 ground periods: corrected as at the next hardening
STEPS_PER_PERIOD = 16
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
    """Correlations of the structures with the references, those between the references, and sigma."""
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


def kept(folder, ductility, hardening, ground_damping):
    path = folder / f"{ductility:.3g}_{hardening:g}_{ground_damping:g}.npz"
    if not path.exists():
        result = part(ductility, hardening, ground_damping)
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
        signatures[*at, :, xig] = signature(joint, gram)
        ductility[*at, :, xig] = result["ductility_std"]
    return signatures, ductility


def reference_arrays():
    names = ("period", "elastic_ductility_std", "hardening", "damping")
    columns = zip(names, zip(*REFERENCES, strict=True), strict=True)
    return {f"reference_{name}": ("drift_reference", list(column)) for name, column in columns}


def derived(structure, ground):
    """Derived signatures."""
    columns = xr.Dataset(reference_arrays())
    solved, known = (
        solve_derived(s, ground, "drift", USUAL) for s in (structure, building(*columns.values()))
    )
    return derived_signatures([solved], known)[0]


def signature_correction(simulated):
    """Simulated less derived signatures."""
    found = derived(*grid(PERIOD, DAMPING)).transpose(*GRID, "drift_reference")
    return filled(found.copy(data=simulated - found.values))


def filled(correction):
    """Where nothing was simulated, the correction at the next hardening."""
    return correction.fillna(correction.shift(hardening=-1))


def displacement_corrections(ductility):
    """Logarithms of exact over derived: from the map of the bias, and for less damping by the ratio."""
    table = bias_map()
    white = exact_over_derived(table.displacement_std_bias_white_noise, sl.WhiteNoise())
    known = table.displacement_std_bias
    soil = exact_over_derived(known, sl.KanaiTajimi(1.0, known.ground_damping))
    structure, ground = grid(PERIOD, DAMPING[:2])
    logarithm = np.log(solve_derived(structure, ground, "drift", USUAL).ductility_std).transpose(*GRID)
    simulated = logarithm.copy(data=np.log(ductility[:, :, :2]))
    change = filled(simulated - logarithm).diff("damping").isel(damping=0, drop=True)  # .01 to .02
    inside = np.log(soil.period.clip(*PERIOD[[0, -1]]))
    change = change.assign_coords(period=np.log(PERIOD)).interp(period=inside.values)
    least = soil.sel(damping=[DAMPING[1]]) - change.assign_coords(period=soil.period.values)
    least = least.assign_coords(damping=[DAMPING[0]]).transpose(*soil.dims)
    return xr.concat([least, soil], "damping").transpose(*soil.dims), white


def exact_over_derived(bias, ground, hardening=HARDENING):
    """Its logarithm, from the bias of the Gaussian closure."""
    bias = bias.sel(hardening=list(hardening))
    structure = building(
        bias.period if "period" in bias.dims else 1.0,
        bias.elastic_ductility_std,
        bias.hardening,
        bias.damping,
    )
    gaussian, derived = (
        solve_derived(structure, ground, closure, USUAL).displacement_std
        for closure in ("gaussian", "drift")
    )
    return np.log(gaussian / (1 + bias) / derived).transpose(*bias.dims)


def labelled(signatures, displacement, white):
    table = xr.Dataset(reference_arrays()).assign(
        signature_correction=signatures.rename(period="signature_period"),
        displacement_correction=displacement.astype("float32"),
        displacement_correction_white_noise=white.astype("float32").rename(
            damping="damping_white_noise"
        ),
    )
    long_names = {
        "elastic_ductility_std": "elastic displacement_std over yield displacement: R/p",
        "hardening": "hardening ratio",
        "damping": "damping ratio",
        "damping_white_noise": "damping ratio, on white noise",
        "ground_damping": "damping ratio of the Kanai-Tajimi ground",
        "period": "period over ground period",
        "signature_period": "period over ground period, of the signatures",
        "reference_period": "period over ground period, of the references",
        "reference_elastic_ductility_std": "R/p of the references",
        "reference_hardening": "hardening ratio of the references",
        "reference_damping": "damping ratio of the references",
        "signature_correction": "simulated less derived signature",
        "displacement_correction": "logarithm of the exact over the derived displacement_std",
        "displacement_correction_white_noise": "the same on white noise",
    }
    for name, long_name in long_names.items():
        table[name].attrs = {"units": "1", "long_name": long_name}
    return table.assign_attrs(
        title="What simulation adds to the drift closure for bilinear structures",
        stochlin_version=sl.__version__,
        history="benchmarks/drift_map.py",
        comment=(
            "Displacements from the map of the bias; at the least damping by their simulated ratio to "
            "those at the next one. What remembers longest is corrected as at the next hardening. "
            "Nothing is added at hardening 1 and where nothing yields."
        ),
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", type=Path)
    parser.add_argument("--work", type=Path, required=True)
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    points = itertools.product(ELASTIC_DUCTILITY, HARDENING[::-1], GROUND_DAMPING)
    parts = {point: kept(options.work, *point) for point in points if point[:2] != LEFT_OUT}
    simulated, ductility = assembled(parts)
    table = labelled(signature_correction(simulated), *displacement_corrections(ductility))
    packed = {"dtype": "int16", "scale_factor": 1e-4, "_FillValue": np.int16(-32768)}
    with whole_file(options.file) as temporary:
        table.to_netcdf(temporary, engine="scipy", encoding={"signature_correction": packed})


if __name__ == "__main__":
    main()
