"""Table of pairs by statistical linearization, with the errors of its correlations.

Each structure is solved over its own dimensions. The covariance of a pair then follows from one linear
equation, and its bias by interpolation in a map; both are compiled.
"""

from __future__ import annotations

import numpy as np

from stochlin.analyses.linearization.bias_map import (
    place_in_map,
    rho_bias_map,
)
from stochlin.analyses.linearization.equivalent_systems import (
    INTERNAL,
    bias_of_solved,
    solved_together,
    system_and_forcing,
)
from stochlin.analyses.linearization.tolerance import Tolerance
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.cellwise import Cells, cellwise
from stochlin.kernels.basics.arrays import Array, in_one_shape
from stochlin.kernels.basics.interpolation import Grid
from stochlin.kernels.correlation.differences import steps_of
from stochlin.kernels.correlation.tables import Codes, PairSide, pair_parameters, pair_table
from stochlin.models.grounds import Ground
from stochlin.models.structures import Structure

CODES = Codes(labels.NOT_CONVERGED, labels.NOT_PHYSICAL)
SYSTEM = ("displacement_std", *INTERNAL)
SHOWN = ("displacement_std", "ductility_std", "yield_displacement")
KINDS = (float, np.int8, float, np.int8)  # of rho, status, bias, caution


def linearized_pairs(
    first: Structure, second: Structure, ground: Ground, closure: str, tolerance: Tolerance
) -> dict[str, Cells]:
    """Variables of `correlate` by linearization, except those of ``u_1 - u_2``.

    The map of the bias belongs to the Gaussian closure, so that both sides are solved with that, too.
    """
    pair, other_closure = (first, second), closure != "gaussian"
    sides = gaussians = solved_together(pair, ground, closure, tolerance)
    if other_closure:
        gaussians = solved_together(pair, ground, "gaussian", tolerance)
    inputs: list[Cells] = []
    biases: dict[str, Cells] = {}
    solved = zip(pair, sides, gaussians, strict=True)
    for number, (structure, side, gaussian) in enumerate(solved, start=1):
        bias, caution = bias_of_solved(structure, ground, side, gaussian, tolerance)
        inputs += [side[name] for name in SYSTEM]
        inputs += [gaussian[name] for name in SYSTEM] if other_closure else []
        inputs += place_in_map(structure, ground, gaussian)
        inputs += [side["status"], caution, np.isinf(gaussian["yield_displacement"])]
        biases[f"bias_{number}"] = bias
    rho, status, bias, caution = cellwise(
        _cells,
        *inputs,
        kinds=KINDS,
        grid=rho_bias_map(*pair, ground),
        other_closure=other_closure,
    )
    shown = {f"{name}_{n}": side[name] for name in SHOWN for n, side in enumerate(sides, start=1)}
    return {"rho": rho, **shown, "status": status, "bias": bias, **biases, "caution": caution}


@np.errstate(all="ignore")  # cells with extreme parameters get a status
def _cells(*inputs: Array, grid: Grid | None, other_closure: bool) -> tuple[Array, ...]:
    """Arrays of all pairs; ``inputs`` are those of the first structure, then of the second."""
    shape = np.broadcast_shapes(*(array.shape for array in inputs))
    half = len(inputs) // 2
    first, second = (_side(part, len(shape), other_closure) for part in (inputs[:half], inputs[half:]))
    table = pair_table(first, second, shape, grid, CODES)
    return tuple(array.reshape(shape) for array in table)


def _side(arrays: tuple[Array, ...], dimensions: int, other_closure: bool) -> PairSide:
    """One structure of the pairs in the form of the compiled loop; ``dimensions`` of the table."""
    *systems, status, caution, elastic = in_one_shape(*arrays)
    shape, count = status.shape, len(SYSTEM)

    def parameters(values: list[Array]) -> Array:
        sigma, *rest = values
        return pair_parameters(*system_and_forcing(rest), sigma)

    own = parameters(systems[:count])
    gaussian = parameters(systems[count : 2 * count]) if other_closure else own
    place = np.log(np.array(systems[2 * count if other_closure else count :]))
    flags = np.array((status, caution, elastic), np.int8)
    place, flags = (np.ascontiguousarray(rows.reshape(len(rows), -1).T) for rows in (place, flags))
    return PairSide(own, gaussian, place, flags, steps_of(shape, dimensions))
