"""Amplification D: what yielding does to the displacement (Fig. 5b)."""

from __future__ import annotations

import xarray as xr

from stochlin.analyses import labels
from stochlin.analyses.equivalent_systems import solve_elastic
from stochlin.analyses.linearization import linearize
from stochlin.models.grounds import Ground
from stochlin.models.structures import Structure


def amplification(structure: Structure, ground: Ground, closure: str = "gaussian") -> xr.Dataset:
    """Amplification factor ``D``: inelastic over elastic displacement.

    The paper's Fig. 5b takes it between maxima. With one peak factor for both, as here, it is
    the ratio of the standard deviations.

    Parameters
    ----------
    structure : Bilinear, BoucWen or Hysteretic
    ground : WhiteNoise, KanaiTajimi or CloughPenzien
    closure : str
        As in `linearize`.

    Returns
    -------
    xarray.Dataset
        ``amplification`` [-], ``displacement_std`` [m], ``ductility_std`` [-], ``status``.

    Raises
    ------
    ValueError, ArithmeticError
        As in `linearize`.

    Notes
    -----
    Linearized, so too small where structures yield: see `linearize`.

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
    inelastic = linearize(structure, ground, closure)
    elastic = solve_elastic(structure, ground)
    table = inelastic[["displacement_std", "ductility_std", "status"]].assign(
        amplification=inelastic.displacement_std / elastic.displacement_std
    )
    return labels.with_run_information(
        labels.label(table),
        f"Amplification of the displacement by yielding, {ground.name} ground",
        f"amplification(closure={closure!r})",
        {"structure": structure, "ground": ground},
    )
