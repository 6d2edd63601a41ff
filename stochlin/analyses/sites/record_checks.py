"""Checks of records: velocity pulse, offset, cut file, spectrum of another shape than the site."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr

from stochlin.analyses.records.cells import RECORD, Records, as_list, checked_motions
from stochlin.analyses.records.records import strong_samples
from stochlin.analyses.records.response import response_spectrum
from stochlin.analyses.sites.motion_fit import DOUBTS
from stochlin.analyses.sites.spectra import (
    BAND,
    BAND_POINTS,
    check_band,
    checked_spectrum,
    interpolated,
)
from stochlin.analyses.sites.variables import VARIABLES
from stochlin.analyses.tables import labels
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.records.runs import SampledMotion
from stochlin.kernels.records.velocity_pulses import REFERENCE, velocity_pulse
from stochlin.models.arguments import TwoNumbers, checked

MOST_OFFSET, MOST_AT_ENDS, MOST_MISFIT = 0.01, 0.25, 0.5
ENDS = 1.0  # s


@checked
def check_records(
    records: Records, *, spectrum: xr.DataArray | None = None, band: TwoNumbers = BAND
) -> xr.Dataset:
    """Check records for what makes gaps by them, or by motions fitted to them, doubtful.

    Parameters
    ----------
    records : xarray.DataArray, or list or mapping of them
        Ground acceleration [m/s^2] over ``time`` [s], as from `read_record` and `read_records`.
    spectrum : xarray.DataArray, optional
        Spectrum of the site, as from `eurocode_8`.
    band : tuple of two floats
        Periods [s] of the buildings, between which spectra are compared.

    Returns
    -------
    xarray.Dataset
        Over ``record``: ``pulse_indicator`` [-] and ``pulse_period`` [s] of the velocity, NaN without an
        early candidate; ``offset`` [-], the mean acceleration over the peak; ``start_level`` and
        ``end_level`` [-], the root mean square of the first and last second over that of the strong
        part; with a spectrum ``spectral_misfit`` [-], the standard deviation of ln (Sa of the record
        over the spectrum) in the band; and ``doubts``, what of this is beyond its limit, in sentences.

    Raises
    ------
    TypeError, ValueError
        If a record or the spectrum is not valid, or the band is not one of periods.

    Notes
    -----
    The limits are an indicator of 0, an offset of 0.01, a level of 0.25 and a misfit of 0.5. Filtered
    noise under an envelope has no pulses, so that motions which are fitted to a record with a pulse ask
    for too small gaps. A pulse need not come from a fault nearby; of simulated motions on a Kanai-Tajimi
    ground, whose velocities drift, the indicator has no meaning. An offset moves a structure of the
    circular frequency ``w`` by ``offset/w^2``. The response to a cut file starts or ends within the
    strong motion. A misfit does not depend on the scale of the record.

    References
    ----------
    Shahi, S. K. and Baker, J. W. (2014), Bull. Seismol. Soc. Am. 104(5), 2456-2466, for the indicator,
    here of one component as it was recorded and not in the direction of the pulse.

    Examples
    --------
    >>> import stochlin as sl
    >>> shape = sl.AminAng(3.0, 10.0, 0.5)
    >>> ground = sl.CloughPenzien(0.5, 0.4, 4.0, 0.6, intensity=0.01)
    >>> motions = sl.simulated_motions(ground, 25.0, shape, paths=2)
    >>> table = sl.check_records({"whole": motions[0], "cut": motions[0][600:]})
    >>> [bool(text) for text in table.doubts.values]
    [False, True]
    """
    motions = checked_motions(records)
    check_band(band)
    rows = [_measured(ground) for ground in motions.grounds]
    columns = {name: (RECORD, [row[name] for row in rows]) for name in rows[0]}
    names = motions.names or ["record"]
    table = xr.Dataset(columns, coords={RECORD: names})
    if spectrum is not None:
        own_periods, values, damping = checked_spectrum(spectrum)
        periods = np.geomspace(*band, BAND_POINTS)
        wanted = interpolated(own_periods, values, periods)
        misfits = [_misfit(record, periods, wanted, damping) for record in as_list(records)]
        table["spectral_misfit"] = RECORD, misfits
    texts = [" ".join(_doubts(table.isel({RECORD: n}))) for n in range(len(names))]
    table[DOUBTS] = RECORD, np.array(texts)
    return labels.with_run_information(
        labels.label(table, VARIABLES),
        "Checks of records",
        f"check_records(band={tuple(band)})",
        {},
        f"{labels.PAPER} {REFERENCE}.",
    )


def _measured(ground: SampledMotion) -> dict[str, float]:
    """What is measured of one record."""
    values, dt = ground.acceleration, ground.dt
    first, last = strong_samples(values)
    strong = _rms(values[int(first) : int(last) + 1])
    second = max(1, round(ENDS / dt))
    pulse = velocity_pulse(np.cumsum(values) * dt, dt)
    return {
        "pulse_indicator": pulse.indicator,
        "pulse_period": pulse.period,
        "offset": float(values.mean() / np.abs(values).max()),
        "start_level": _rms(values[:second]) / strong,
        "end_level": _rms(values[-second:]) / strong,
    }


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _misfit(record: xr.DataArray, periods: Array, wanted: Array, damping: float) -> float:
    own = response_spectrum(record, periods, damping).pseudo_acceleration.to_numpy().ravel()
    return float(np.log(own / wanted).std())


def _doubts(row: xr.Dataset) -> Iterator[str]:
    """Sentences about one record."""
    values = {name: float(row[name]) for name in row.data_vars}
    if values["pulse_indicator"] > 0:
        yield (
            f"It has a velocity pulse of {values['pulse_period']:.2g} s (Shahi and Baker 2014), which "
            "fitted motions do not have."
        )
    if abs(values["offset"]) > MOST_OFFSET:
        yield (
            f"Its mean is {100 * values['offset']:.2g} % of its peak, an offset that moves structures; "
            "subtract it."
        )
    for end, word in (("start", "starts"), ("end", "ends")):
        if values[f"{end}_level"] > MOST_AT_ENDS:
            yield (
                f"It {word} with {values[f'{end}_level']:.2f} times the strength of its strong part, as "
                "a file that is cut; take the whole record."
            )
    if values.get("spectral_misfit", 0.0) > MOST_MISFIT:
        yield (
            f"Its spectrum has another shape than that of the site: ln of their ratio has a standard "
            f"deviation of {values['spectral_misfit']:.2f}; take a record of a similar site."
        )
