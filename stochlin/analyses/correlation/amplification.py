"""Amplification D: what yielding does to the displacement (Fig. 5b)."""

from __future__ import annotations

import xarray as xr

from stochlin.analyses.correlation.correlation import correlate
from stochlin.analyses.correlation.variables import VARIABLES
from stochlin.analyses.linearization.equivalent_systems import solve_elastic
from stochlin.analyses.linearization.linearization import linearize
from stochlin.analyses.tables import labels
from stochlin.messages import brief
from stochlin.models.grounds import Ground
from stochlin.models.parameters import expect
from stochlin.models.structures import Structure


def amplification(
    structure: Structure,
    ground: Ground,
    *,
    method: str = "linearization",
    closure: str = "gaussian",
    paths: int = 256,
    seed: int = 0,
) -> xr.Dataset:
    """Amplification factor ``D``: inelastic over elastic displacement.

    The paper's Fig. 5b takes it between maxima. With one peak factor for both, as here, it is
    the ratio of the standard deviations.

    Parameters
    ----------
    structure : Bilinear, BoucWen or Hysteretic
    ground : WhiteNoise, KanaiTajimi or CloughPenzien
    method : str
        ``"linearization"`` or ``"simulation"``.
    closure : str
        As in `linearize`.
    paths, seed : int
        As in `simulate`.

    Returns
    -------
    xarray.Dataset
        Over the dimensions of the parameters: ``amplification`` [-], ``displacement_std`` [m],
        ``ductility_std`` [-], ``status``; simulation adds ``amplification_standard_error``.

    Raises
    ------
    ValueError, ArithmeticError
        As in `linearize` and `simulate`.

    Notes
    -----
    Linearized, it is too small where structures yield: see `linearize`.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), Fig. 5b.

    Examples
    --------
    >>> import stochlin as sl
    >>> building = sl.Bilinear(period=0.5, damping=0.05, hardening=0.05, reduction_factor=4)
    >>> 1 < float(sl.amplification(building, sl.KanaiTajimi(2.0, 0.05)).amplification)
    True
    """
    expect(structure, Structure, "structure")
    expect(ground, Ground, "ground")
    if not isinstance(method, str):
        raise ValueError(f"method = {brief(method)} is not known; allowed: linearization, simulation")
    elastic = solve_elastic(structure, ground).displacement_std
    if method == "linearization":
        inelastic = linearize(structure, ground, closure)
    elif method == "simulation":
        pairs = correlate(structure, structure, ground, method, paths=paths, seed=seed)
        names = ("displacement_std", "ductility_std", "displacement_std_standard_error")
        inelastic = pairs[["status", *(f"{name}_1" for name in names)]]
        inelastic = inelastic.rename({f"{name}_1": name for name in names})
    else:
        raise ValueError(f"method = {brief(method)} is not known; allowed: linearization, simulation")
    table = inelastic[["displacement_std", "ductility_std", "status"]].assign(
        amplification=inelastic.displacement_std / elastic
    )
    if "displacement_std_standard_error" in inelastic:
        error = inelastic.displacement_std_standard_error / elastic
        table["amplification_standard_error"] = error
        table.attrs = {**inelastic.attrs}
    return labels.with_run_information(
        labels.label(table, VARIABLES),
        f"Amplification of the displacement by yielding, {method}, {ground.name} ground",
        f"amplification(method={method!r}, closure={closure!r})",
        {"structure": structure, "ground": ground},
    )
