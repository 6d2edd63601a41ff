"""Structures that yield so rarely that a simulation would not become stationary in reasonable time.

The plastic drift is the slow wandering of the position about which a yielding structure vibrates. If a
structure yields once in ten thousand periods, its drift needs a hundred thousand periods to become
stationary. Such a structure is simulated as elastic, which it is for nearly all of the time. The
variance of its drift, and the covariance of the drifts of two structures, are then added from the drift
closure, eqs. (1) to (8) of ``docs/drift.md``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt
import xarray as xr

from stochlin.analyses.linearization.drift_map import usual_closure
from stochlin.analyses.linearization.equivalent_systems import (
    INTERNAL,
    SHARES,
    solve_structure,
    system_and_forcing,
)
from stochlin.analyses.linearization.tolerance import USUAL
from stochlin.analyses.simulation.ensembles import SimulationRun
from stochlin.analyses.simulation.run_lengths import BURN_IN
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.drift import drift_correlation, innovation_coherence
from stochlin.models.grounds import Ground
from stochlin.models.structures import DRIFT, Structure
from stochlin.models.systems import AnyStructure

# A drift is simulated if each motion needs at most this number of time steps. With 256 motions of one
# structure this takes some ten seconds.
MOST_STEPS = 1e7
# Errors of the drift closure, which are added to the standard errors of the simulation. The first is the
# relative error of a standard deviation, which was 1.4 % on average over 500 pairs. The second is the
# error of the correlation coefficient of two drifts.
DISPLACEMENT_ERROR, SHARED_ERROR = 0.02, 0.25
MEANINGS = ("simulated", "elastic_and_drift_by_closure")

Mask = npt.NDArray[np.bool_]


def rarely_yielding(
    structures: Sequence[AnyStructure], ground: Ground, run: SimulationRun, relaxation_times: float
) -> Mask:
    """For each structure, whether it yields too rarely to be simulated; all are oscillators.

    A structure for which the drift closure does not apply is never marked.
    """
    longest = MOST_STEPS * run.plan.dt / (BURN_IN + relaxation_times)
    slow = np.zeros(run.valid.size, bool)
    slow[run.valid] = run.drift_time > longest
    return slow & np.array([_drifts(s, ground) for s in structures])


def elastic(structures: Sequence[AnyStructure], rare: Mask) -> list[AnyStructure]:
    """The same structures, but those that yield rarely (``rare``) have no strength and stay elastic."""
    return [
        replace(structure, yield_displacement=None, reduction_factor=None)
        if out and isinstance(structure, Structure)
        else structure
        for structure, out in zip(structures, rare, strict=True)
    ]


def with_drift(
    table: xr.Dataset, structures: Sequence[AnyStructure], ground: Ground, rare: Mask
) -> xr.Dataset:
    """The ``table`` of a simulation of the `elastic` structures, with the missing drifts added.

    The standard deviation of a structure that yields rarely is the one by the drift closure. Its
    covariance with another structure is the simulated one plus that of both drifts. The drift of one
    structure and the vibration of the other are taken as uncorrelated, because the vibration is much
    faster.
    """
    solved = {n: _solved(s, ground) for n, s in enumerate(structures) if _drifts(s, ground)}
    chosen = [n for n, out in enumerate(rare) if out]
    whole = table.displacement_std.values.copy()
    error, strength = table.displacement_std_standard_error.values.copy(), np.full(whole.size, np.inf)
    for n in chosen:
        whole[n] = float(solved[n].displacement_std)
        strength[n] = float(solved[n].yield_displacement)
        error[n] = np.hypot(error[n], DISPLACEMENT_ERROR * whole[n])
    rho, rho_error = table.rho.values.copy(), table.rho_standard_error.values.copy()
    simulated = table.displacement_std.values
    for i in chosen:
        for j in range(rare.size):
            if i == j or (rare[j] and j < i):
                continue
            shared = rho[i, j] * simulated[i] * simulated[j]
            if j in solved:
                shared += _shared(solved[i], solved[j])
            rho[i, j] = rho[j, i] = np.clip(shared / (whole[i] * whole[j]), -1, 1)
            drifts = (solved[n].drift_std / whole[n] if n in solved else 0.0 for n in (i, j))
            closure = SHARED_ERROR * float(np.prod([float(share) for share in drifts]))
            rho_error[i, j] = rho_error[j, i] = np.hypot(rho_error[i, j], closure)
    ductility = np.where(rare, whole / strength, table.ductility_std.values)
    columns = {
        "displacement_std": whole,
        "displacement_std_standard_error": error,
        "ductility_std": ductility,
        "rho": rho,
        "rho_standard_error": rho_error,
    }
    named = ", ".join(f"{n + 1}" for n in chosen)
    slowest = max(1 / float(solved[n].drift_rate) for n in chosen)
    table = table.assign({name: table[name].copy(data=values) for name, values in columns.items()})
    table["estimate"] = table.displacement_std.copy(data=rare.astype(np.int8))
    table.estimate.attrs = {
        "long_name": "method for the response",
        "flag_values": np.arange(len(MEANINGS), dtype=np.int8),
        "flag_meanings": " ".join(MEANINGS),
    }
    comment = (
        f"Structure {named} yields so rarely that its plastic drift needs {slowest:.2g} s to become "
        "stationary. It was simulated as elastic, and its drift is that of the drift closure, whose "
        "displacements are off by 1.4 % on average."
    )
    return table.assign_attrs(comment=comment)


def _drifts(structure: AnyStructure, ground: Ground) -> bool:
    """Whether the drift closure applies to this kind of structure on this kind of ground."""
    return isinstance(structure, Structure) and usual_closure(structure, ground) == DRIFT


def _solved(structure: AnyStructure, ground: Ground) -> xr.Dataset:
    """The structure as solved by the drift closure."""
    assert isinstance(structure, Structure)
    return solve_structure(structure, ground, DRIFT, USUAL)


def _shared(first: xr.Dataset, second: xr.Dataset) -> float:
    """Covariance of the plastic drifts of two structures [m^2]."""
    systems = [system_and_forcing([side[n].values for n in INTERNAL])[0] for side in (first, second)]
    shares = [np.array([side[n].values for n in SHARES]) for side in (first, second)]
    rates: list[Array] = [side.drift_rate.values for side in (first, second)]
    coherence = innovation_coherence(systems[0], systems[1])
    correlation = drift_correlation(coherence, shares[0], shares[1], rates[0], rates[1])
    return float(correlation * first.drift_std.values * second.drift_std.values)
