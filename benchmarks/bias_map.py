"""Remake the map of how far linearization is off: `python benchmarks/bias_map.py FILE --work FOLDER`.

Simulates 21 structures at a time on grounds from narrow to broad band and on white noise, and compares
with the Gaussian closure. Takes an hour or so on two cores; a run that was stopped goes on with the
parts in FOLDER. Times are in ground periods: nothing else depends on the scale of time.
"""

import itertools
import zipfile

import numpy as np
import xarray as xr
from arguments import file_and_work

import stochlin as sl
from stochlin.analyses.simulation import simulation
from stochlin.analyses.tables.storage import whole_file
from stochlin.kernels.simulation.stepping import LANES

HARDENING = (0.02, 0.05, 0.1, 0.2, 0.5)
DAMPING = (0.02, 0.05, 0.1)
ELASTIC_DUCTILITY = (3.2, 2.0, 1.25, 0.8, 0.5, 1 / 3)
GROUND_DAMPING = (0.03, 0.07, 0.17, 0.4, 1.0)
STEP = 10**0.05  # between neighbouring periods
WINDOWS = ((-20, 0), (-10, 10), (0, 20))  # powers of STEP that ride on one ground
NOISE_WINDOW = (-10, 0)
RATIOS = (-10, -7, -4, -2, -1, 0)  # shorter over longer period, in powers of STEP
STRUCTURE_STEPS = 3e9  # of a part, as paths allow between the two limits
FEWEST, MOST = 64, 256
STEPS_PER_PERIOD = 16


def part(hardening, damping, ductility, ground, window):
    """Relative bias of sigma over the window and bias of rho over (longer, ratio), with errors."""
    powers = np.arange(window[0], window[1] + 1)
    periods = STEP**powers
    structures = [
        sl.Bilinear(period, damping, hardening, reduction_factor=3 * ductility) for period in periods
    ]
    options = {"seed": 1, "steps_per_period": STEPS_PER_PERIOD}
    trial = sl.simulate(structures, ground, paths=LANES, relaxation_times=1, **options).attrs
    seconds = 25 * trial["memory_s"]
    paths = STRUCTURE_STEPS / (len(structures) * seconds / trial["step_s"])
    paths = LANES * round(float(np.clip(paths, FEWEST, MOST)) / LANES)
    truth = sl.simulate(structures, ground, paths=paths, **options)
    sigma = truth.displacement_std.values
    both = {
        name: sl.Bilinear(
            xr.DataArray(periods, dims=name), damping, hardening, reduction_factor=3 * ductility
        )
        for name in ("period_1", "period_2")
    }
    formula = sl.correlate(both["period_1"], both["period_2"], ground)
    bias = formula.displacement_std_1.values / sigma - 1
    error = (1 + bias) * truth.displacement_std_standard_error.values / sigma
    off = formula.rho.transpose("period_1", "period_2").values - truth.rho.values
    longer = np.arange(-RATIOS[0], powers.size)
    pairs = (longer[:, None] + np.array(RATIOS), longer[:, None])
    if (truth.status > 1).any():
        raise ArithmeticError(f"{structures[0].describe()}, {ground.describe()}: not stationary")
    return {
        "sigma_bias": bias,
        "sigma_error": error,
        "rho_bias": off[pairs],
        "rho_error": truth.rho_standard_error.values[pairs],
        "paths": paths,
    }


def kept(folder, name, arguments):
    path = folder / f"{name}.npz"
    try:
        return dict(np.load(path))
    except (FileNotFoundError, zipfile.BadZipFile):
        result = part(*arguments)
        np.savez(path, **result)
        print(name, result["paths"], np.round(result["sigma_bias"], 2), flush=True)
        return result


def assembled(parts):
    """The parts as one dataset; hardening 1 is exact, so that its bias is 0."""
    ductilities, hardenings = sorted(ELASTIC_DUCTILITY), (*HARDENING, 1.0)
    common = {"elastic_ductility_std": ductilities, "hardening": hardenings, "damping": DAMPING}
    first, last = WINDOWS[0][0], WINDOWS[-1][1]
    coords = {
        **common,
        "ground_damping": GROUND_DAMPING,
        "period": STEP ** np.arange(first, last + 1),
        "longer_period": STEP ** np.arange(first - RATIOS[0], last + 1),
        "period_ratio": STEP ** np.array(RATIOS),
    }
    dims = {
        "displacement_std_bias": (*common, "ground_damping", "period"),
        "displacement_std_bias_white_noise": tuple(common),
        "rho_bias": (*common, "ground_damping", "longer_period", "period_ratio"),
        "rho_bias_white_noise": (*common, "period_ratio"),
    }
    shape = {name: [len(coords[dim]) for dim in over] for name, over in dims.items()}
    table = {name: np.zeros(size) for name, size in shape.items()}
    error = {name: np.zeros(size) for name, size in shape.items()}
    for (hardening, damping, ductility, ground_damping, *window), result in reversed(parts.items()):
        place = (
            ductilities.index(ductility),
            hardenings.index(hardening),
            DAMPING.index(damping),
        )
        for target, kind in ((table, "bias"), (error, "error")):
            if ground_damping is None:
                # Period does not matter on white noise: a mean over structures and pairs.
                target["displacement_std_bias_white_noise"][place] = result[f"sigma_{kind}"].mean()
                target["rho_bias_white_noise"][place] = result[f"rho_{kind}"][-1]
                continue
            place_2 = (*place, GROUND_DAMPING.index(ground_damping))
            begin = window[0][0] - first
            sigma, rho = result[f"sigma_{kind}"], result[f"rho_{kind}"]
            target["displacement_std_bias"][*place_2, begin : begin + len(sigma)] = sigma
            target["rho_bias"][*place_2, begin : begin + len(rho)] = rho
    lists = {name: list(values) for name, values in coords.items()}
    dataset = xr.Dataset({name: (dims[name], table[name]) for name in dims}, lists)
    for name, values in error.items():
        dataset[name].attrs["largest_standard_error"] = float(values.max())
        dataset[name].attrs["mean_standard_error"] = float(values.mean())
    return dataset


def labelled(dataset):
    long_names = {
        "elastic_ductility_std": "R/p: elastic standard deviation over the yield displacement",
        "hardening": "hardening ratio of the structure",
        "damping": "damping ratio of the structure",
        "ground_damping": "damping ratio of the Kanai-Tajimi ground",
        "period": "period of the structure over the period of the ground",
        "longer_period": "longer period of a pair of structures over the period of the ground",
        "period_ratio": "shorter over longer period of a pair of structures",
        "displacement_std_bias": "relative bias of the standard deviation, Kanai-Tajimi ground",
        "displacement_std_bias_white_noise": "relative bias of the standard deviation, white noise",
        "rho_bias": "bias of the correlation coefficient, Kanai-Tajimi ground",
        "rho_bias_white_noise": "bias of the correlation coefficient, white noise",
    }
    for name, long_name in long_names.items():
        dataset[name].attrs.update(units="1", long_name=long_name)
    return dataset.assign_attrs(
        title="Bias of linearization by the Gaussian closure, for bilinear structures, from simulations",
        stochlin_version=sl.__version__,
        history="benchmarks/bias_map.py",
        comment=(
            "The bias of a standard deviation of the displacement is the linearized value over the "
            "simulated one, minus 1. The bias of a correlation coefficient is the linearized value "
            "minus the simulated one; both structures of the pair have equal hardening, damping and "
            f"R/p. Each point was simulated on {FEWEST} to {MOST} motions, which are 20 times as long "
            f"as the memory of the structures, with {STEPS_PER_PERIOD} time steps in the shortest "
            "period. A structure with the hardening ratio 1 is linear, so that its bias is 0."
        ),
    )


def save(dataset, path):
    packed = {"dtype": "int16", "scale_factor": 1e-4, "_FillValue": np.int16(-32768)}
    with whole_file(path) as temporary:
        dataset.to_netcdf(temporary, engine="scipy", encoding=dict.fromkeys(dataset, packed))


def main():
    simulation.MOST_STEPS = np.inf  # all is simulated that closures are held against
    options = file_and_work(__doc__)
    parts = {}
    for ductility, hardening, damping in itertools.product(ELASTIC_DUCTILITY, HARDENING, DAMPING):
        common = (hardening, damping, ductility)
        name = f"{ductility:.3g}_{hardening:g}_{damping:g}"
        parts[*common, None] = kept(
            options.work, f"{name}_white", (*common, sl.WhiteNoise(), NOISE_WINDOW)
        )
        for ground_damping, window in itertools.product(GROUND_DAMPING, WINDOWS):
            ground = sl.KanaiTajimi(1.0, ground_damping)
            arguments = (*common, ground, window)
            parts[*common, ground_damping, window] = kept(
                options.work, f"{name}_{ground_damping:g}_{window[0]}", arguments
            )
    save(labelled(assembled(parts)), options.file)


if __name__ == "__main__":
    main()
