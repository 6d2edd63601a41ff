"""Renew what every closure finds for simulated pairs: `python benchmarks/drift_pairs.py`.

docs/gallery/drift_pairs.nc has 500 random pairs of unequal bilinear structures on Kanai-Tajimi
ground with a period of 1 s and on white noise, with their simulated moments, which stay as they
are.
"""

from pathlib import Path
from unittest.mock import patch

import numpy as np
import xarray as xr

import stochlin as sl
from stochlin.files.storage import save_table
from stochlin.kernels.basics.arrays import on_arrays
from stochlin.kernels.linearization.drift import drifting_correlation
from stochlin.solver.correlation.signatures import drifting_side
from stochlin.solver.linearization.equivalent_systems import solved_together

FILE = Path(__file__).parents[1] / "docs" / "gallery" / "drift_pairs.nc"
SIMULATION, DERIVED = "simulation", "derived"  # the latter: the drift closure without its map
CLOSURES = ("gaussian", "clipped", DERIVED, "drift")
WITH_MAP, WITH_SIGNATURES = "with the map", "with signatures"  # parts of the drift closure
MOMENTS = ("displacement_std_1", "displacement_std_2", "rho")


def structures(pairs):
    """Both structures of every pair."""
    return [
        sl.Bilinear(
            pairs[f"period_{n}"],
            pairs[f"damping_{n}"],
            pairs[f"hardening_{n}"],
            reduction_factor=3 * pairs[f"strength_{n}"],
        )
        for n in (1, 2)
    ]


def moments(pair, ground, closure):
    """Standard deviations and rho (moment, case) of two structures on one kind of ground."""
    if closure != DERIVED:
        table = sl.correlate(*pair, ground, closure=closure)
        return [table[name].values for name in MOMENTS]
    solved = solved_together(tuple(pair), ground, "drift")
    side = drifting_side(solved.values)
    first, second = solved.parts
    sides = on_arrays(lambda x: x[..., first], side), on_arrays(lambda x: x[..., second], side)
    return [*(np.sqrt(part.variance) for part in sides), drifting_correlation(*sides)]


def parts(pair, ground):
    """Moments of the closures, and of the drift closure with some of its corrections."""
    of_parts = {closure: moments(pair, ground, closure) for closure in CLOSURES}
    drift = of_parts.pop("drift")
    of_parts[WITH_MAP] = [*drift[:2], of_parts[DERIVED][2]]
    with patch("stochlin.kernels.correlation.pairs.by_nearness", lambda rho, *_: (rho, 0 * rho)):
        of_parts[WITH_SIGNATURES] = moments(pair, ground, "drift")
    return {**of_parts, "drift": drift}


def difference(std_1, std_2, rho):
    """Standard deviation of u_1 - u_2."""
    return np.sqrt(std_1**2 + std_2**2 - 2 * rho * std_1 * std_2)


def renewed(pairs):
    """The table with the moments of every closure beside the simulated ones."""
    computed = np.empty((len(MOMENTS), len(CLOSURES), pairs.sizes["case"]))
    for on_white in (False, True):
        here = pairs.white.values.astype(bool) == on_white
        some = pairs.isel(case=here)
        ground = sl.WhiteNoise() if on_white else sl.KanaiTajimi(1.0, some.ground_damping)
        for number, closure in enumerate(CLOSURES):
            computed[:, number, here] = moments(structures(some), ground, closure)
    exact = pairs.sel(closure=SIMULATION)
    columns = {
        name: (("closure", "case"), np.vstack([exact[name], values]), pairs[name].attrs)
        for name, values in zip(MOMENTS, computed, strict=True)
    }
    return pairs.drop_dims("closure").assign(columns).assign_coords(closure=[SIMULATION, *CLOSURES])


if __name__ == "__main__":
    table = renewed(xr.load_dataset(FILE, engine="scipy"))
    save_table(table.assign_attrs(history="benchmarks/drift_pairs.py"), FILE)
