"""Critical gap of two buildings from their peaks and their correlation: eq. (3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.correlation.closed_forms import double_difference
from stochlin.models.arguments import checked
from stochlin.models.parameters import NOT_NEGATIVE, Model, Parameter, Range, parameter
from stochlin.solver.tables import labels
from stochlin.solver.tables.lazy import cellwise, in_blocks, valid_cells

# gap over peak below which the gap is a rounding error of two equal structures
ROUNDING_OF_GAP = 1e-5


@dataclass(frozen=True)
class CorrelatedPeaks(Model):
    """Two peak displacements and the correlation of the displacements."""

    of_arguments = True

    peak_1: Parameter = parameter("m", "peak displacement, structure 1", NOT_NEGATIVE)
    peak_2: Parameter = parameter("m", "peak displacement, structure 2", NOT_NEGATIVE)
    rho: Parameter = parameter("1", "correlation coefficient", Range(-1.0, 1.0, True, True))


@checked
def critical_gap(peak_1: Parameter, peak_2: Parameter, rho: Parameter) -> xr.Dataset:
    """Critical gap ``sqrt(p1^2 + p2^2 - 2 rho p1 p2)``, eq. (3), the double difference combination.

    Parameters
    ----------
    peak_1, peak_2 : float or array
        Peak displacements [m], not negative, with the same peak factor for both. They broadcast by
        dimension name.
    rho : float or array
        Correlation coefficient of the displacements [-], from -1 to 1.

    Returns
    -------
    xarray.Dataset
        Over the dimensions of the parameters: ``gap`` [m] and ``status``. ``rho = 1`` gives the
        difference of the peaks, 0 the square root of the sum of squares, -1 the sum.

    Raises
    ------
    ValueError, TypeError
        If a scalar is out of range, a value is not a number, or dimensions do not match.

    Notes
    -----
    If the ground period lies between those of the structures, the correlation may be negative. The
    gap is then larger than the square root of the sum of the squared peaks. With ``rho`` and peaks
    by linearization, the gap is mostly too small for yielding structures, as in `correlate`.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eq. (3); Jeng, Kasai and Maison (1992), Earthquake Spectra 8.

    Examples
    --------
    >>> import stochlin as sl
    >>> [round(float(sl.critical_gap(0.4, 0.3, rho).gap), 6) for rho in (1, 0, -1)]
    [0.1, 0.5, 0.7]
    """
    pair = CorrelatedPeaks(peak_1, peak_2, rho)
    return labels.with_run_information(
        labels.label(in_blocks(_by_equation_3, {"pair": pair})),
        "Critical gap by the double difference combination, eq. (3)",
        "critical_gap()",
        {"pair": pair},
    )


def _by_equation_3(pair: CorrelatedPeaks) -> xr.Dataset:
    valid = valid_cells(pair)
    (gap,) = cellwise(_valid_gap, valid, *pair.cells().values())
    return xr.Dataset({"gap": gap, "status": labels.status_where(valid)})


def equation_3(peak_1: Array, peak_2: Array, rho: Array) -> Array:
    """Eq. (3) [m] with a correlation of rounding errors; 0 where it is one of equal structures."""
    gaps = double_difference(peak_1, peak_2, np.clip(rho, -1, 1))
    return np.where(gaps < ROUNDING_OF_GAP * np.maximum(peak_1, peak_2), 0.0, gaps)


def _valid_gap(valid: Array, *pair: Array) -> Array:
    return double_difference(*(np.where(valid, value, np.nan) for value in pair))
