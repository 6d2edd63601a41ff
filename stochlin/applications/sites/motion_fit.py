"""Fit ground and envelope to one or both components of a station: energy and response spectrum."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.applications.records.cells import Records, checked_motions
from stochlin.applications.records.components import PLACE_KEYS, FileNames, is_below, is_vertical
from stochlin.applications.records.envelope_fit import FittedEnvelope, fit_envelope
from stochlin.applications.records.files import is_record
from stochlin.applications.records.records import checked_record, strong_samples
from stochlin.applications.records.response import response_spectrum
from stochlin.applications.sites.elastic_spectra import USUAL_DAMPING
from stochlin.applications.sites.ground_fit import (
    FITTED_PERIODS,
    LONGEST_FITTED,
    TargetMotions,
    deliver,
)
from stochlin.applications.sites.spectra import BAND_POINTS, SHORTEST_PERIOD, USUAL_BAND, check_band
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.messages import DoubtfulInput, plain
from stochlin.models.arguments import (
    Duration,
    Scatter,
    Seed,
    TwoNumbers,
    Whole,
    check_fields,
    checked,
)
from stochlin.models.envelopes import Envelope, strong_seconds
from stochlin.models.grounds import OTHER_COMPONENT, Ground, UsualScatter, rms_acceleration
from stochlin.models.plausible import PLAUSIBLE
from stochlin.models.values import ByValue

FILTERS = 2
PATHS_OF_MOTION = 512
FEWEST_CYCLES = 4.0  # smallest number of cycles of a fitted period in a record
SHORTEST_RECORD = 2.0  # s
# largest factors between motions and record without a doubt
LIKE_DURATION = 1.5
LIKE_SPECTRUM = 1.3


class Components(NamedTuple):
    """One or two components of a station; of two, the medians are geometric means."""

    records: Sequence[xr.DataArray]
    values: Array  # (components, times) [m/s^2]
    dt: float  # [s]

    @property
    def source(self) -> str:
        """Where the components are from."""
        return " and ".join(str(record.attrs.get("source", "a record")) for record in self.records)

    def energy(self) -> float:
        """Median of ``Int a^2 dt`` [m^2/s^3]."""
        return float(_median(energy_of(self.values, self.dt)))

    def spectra(self, periods: Array) -> Array:
        """Pseudo-accelerations (components, periods) [m/s^2], damping ratio 0.05."""
        table = response_spectrum([*self.records], periods, USUAL_DAMPING)
        return table.pseudo_acceleration.to_numpy()

    def spectrum(self, periods: Array) -> Array:
        """Median of the pseudo-accelerations [m/s^2]."""
        return _median(self.spectra(periods))

    def common(self) -> xr.DataArray:
        """A motion whose energy builds up as that of the components in the mean [m/s^2]."""
        energies = energy_of(self.values, self.dt)[:, None]
        square = (self.values**2 / energies).mean(axis=0) * self.energy()
        return self.records[0].copy(data=np.sqrt(square))


def _median(values: Array) -> Array:
    """Geometric mean along the first axis."""
    median: Array = np.exp(np.log(values).mean(axis=0))
    return median


def energy_of(values: Array, dt: float) -> Array:
    """``Int a^2 dt`` [m^2/s^3] along the last axis."""
    return np.trapezoid(values**2, dx=dt, axis=-1)


def checked_components(record: Records) -> Components:
    """The component, or both; a ValueError if two cannot be of one station in one earthquake."""
    motions = checked_motions(record)
    names = motions.names or ["record"]
    records = motions.records
    if len(records) > 2:
        raise ValueError(
            f"record has {len(records)} components; allowed: one, or both of a station"
        )
    about = [component.attrs for component in records]
    if len(records) == 2:
        _check_horizontal(names, about)
    alike = {
        **{f"{key}s": [repr(of[key]) for of in about if of.get(key)] for key in PLACE_KEYS},
        "sample counts": [str(ground.acceleration.size) for ground in motions.grounds],
        "steps [s]": [f"{ground.dt:.9g}" for ground in motions.grounds],
    }
    both = " and ".join(plain(name, 40) for name in names)
    for what, values in alike.items():
        if len(set(values)) > 1:
            which = " and ".join(map(plain, values))
            raise ValueError(f"record: {both} have the {what} {which}; allowed: equal ones")
    accelerations = np.array([ground.acceleration for ground in motions.grounds])
    peaks = np.abs(accelerations).max(axis=1)
    if text := PLAUSIBLE["peak over that of the site"].doubt(ratio := float(peaks[-1] / peaks[0])):
        what = f"record: the peaks of {both} have the ratio {ratio:.3g}"
        warnings.warn(f"{what}; {text}", DoubtfulInput, stacklevel=4)
    return Components(records, accelerations, motions.grounds[0].dt)


def _check_horizontal(names: Sequence[str], about: Sequence[Mapping[str, Any]]) -> None:
    """Raise a ValueError if a record with such attributes is vertical or in a borehole."""
    sources = [str(of.get("file") or of.get("source", "")) for of in about]
    files = [source if is_record(source) else "" for source in sources]
    in_names = FileNames(files)
    for name, of, file in zip(names, about, files, strict=True):
        component = str(of.get("component", ""))
        if is_vertical(component, "", in_names.component(file)) or is_below(component):
            cure = "of another direction, stated by its attribute component"
            raise ValueError(
                f"record: {plain(name)} is vertical or below; allowed: horizontal, {cure}"
            )


@dataclass(frozen=True)
class FittedMotion(ByValue):
    """Random motion of finite length, as fitted by `fit_motion`: ground, envelope and duration.

    Parameters
    ----------
    ground : CloughPenzien or ParallelGround
        Stationary ground, before the envelope is applied.
    envelope : AminAng, ShinozukaSato or GammaEnvelope, or None
        Envelope of the motion. None is a stationary motion, which `fit_motion` does not return.
    duration : float
        Length of the motion [s].
    scatter : float
        Scatter of the ground acceleration between earthquakes [-], as in `simulate`; by default
        that between both components of a station. 0 is for motions like this record alone.
    scatter_source : str
        Where the scatter is from.

    Raises
    ------
    TypeError, ValueError
        If an argument is of another kind or out of range.
    """

    ground: Ground
    envelope: Envelope | None
    duration: Duration
    scatter: Scatter = OTHER_COMPONENT.scatter
    scatter_source: str = OTHER_COMPONENT.source

    def __post_init__(self) -> None:
        check_fields(self, "FittedMotion: ")


@checked
def fit_motion(
    record: Records,
    envelope: FittedEnvelope = "amin_ang",
    *,
    band: TwoNumbers = USUAL_BAND,
    filters: Annotated[int, Whole(1, 3)] = FILTERS,
    seed: Seed = 0,
    progress: Progress | None = None,
) -> FittedMotion:
    """Fit ground, envelope and duration to a record, so that motions have its energy and spectrum.

    The envelope is fitted by `fit_envelope`. The ground is fitted such that motions with this
    envelope, without scatter, have, in the mean, the response spectrum of the record from 0.05 to 4
    s. Its intensity is then set such that they have the energy of the record exactly, ``sigma^2 Int
    m^2 dt = Int a^2 dt``, with the standard deviation ``sigma`` of the ground acceleration, the
    envelope ``m`` and the record ``a``. A ground by `fit_ground` is instead fitted to the strong
    part of the record; with an envelope by `fit_envelope`, its motions have about half of the
    energy of the record.

    Of **both components** of a station one ground is fitted. Spectrum and energy are the geometric
    means of the components, and the envelope is fitted to the mean of their build-ups of energy.
    The scatter is then the standard deviation of ln Sa between both components, root mean square
    from 0.2 to 2 s or in the ``band``.

    Parameters
    ----------
    record : xarray.DataArray, or list or mapping of two
        Ground acceleration [m/s^2] over ``time`` [s], as from `read_record`, of 2 s or more; or
        both horizontal components of a station, of the same length and time step. Where their
        attributes ``event`` and ``station`` are known (see `read_record`), they have to agree.
    envelope : str
        Model of the envelope, as in `fit_envelope`.
    band : tuple of two floats
        Periods [s] of the buildings, between which the spectra of motions and record are compared.
    filters : int
        Number of Clough-Penzien filters in parallel, 1 to 3.
    seed : int
        Seed of the motions that are simulated during the fit.
    progress : callable, optional
        Called with the share of the work of each simulation that is done.

    Returns
    -------
    fitted motion
        The ``ground``, the ``envelope``, the ``duration`` [s] of the record and the ``scatter`` [-]
        of another component with its source, for `simulate`, `separation`, `simulated_motions` and
        other functions with these arguments. The scatter is also that of the ground, so that it is
        their default; ``scatter=0.0`` is for motions like the record alone.

    Raises
    ------
    ValueError, TypeError
        If the record is not valid or shorter than 2 s, an option is unknown, or two components
        differ in length, time step, station or earthquake.
    ArithmeticError
        If no envelope can be fitted.

    Warns
    -----
    UserWarning
        If motions have a significant duration off by a factor of more than 1.5, or a mean spectrum
        off by more than 30 % (root mean square) in the band.

    Notes
    -----
    A record represents one earthquake, and the motions are like this one. The difference to other
    earthquakes is the ``scatter``. To use the motions at another place, scale them by the mean ln
    Sa over a band of periods around those of the buildings rather than by the peak ground
    acceleration.

    References
    ----------
    Husid, R. (1969), Rev. IDIEM 8, for the envelope; Vanmarcke, E. H. (1975), J. Appl. Mech. 42,
    for the peak factors.

    Examples
    --------
    >>> import stochlin as sl
    >>> shape = sl.AminAng(3.0, 10.0, 0.3)
    >>> record = sl.simulated_motions(sl.named_ground("firm", 0.01), 25.0, shape, paths=2)[0]
    >>> motion = sl.fit_motion(record)
    >>> motion.duration, motion.scatter
    (25.01, 0.4)
    """
    components = checked_components(record)
    check_band(band)
    duration = components.dt * components.values.shape[1]
    if duration < SHORTEST_RECORD:
        raise ValueError(f"record lasts {duration:.3g} s; allowed: {SHORTEST_RECORD:g} s or more")
    common = components.common()
    shape = fit_envelope(common, envelope)
    time = components.dt * np.arange(common.size)
    std = float(np.sqrt(components.energy() / energy_of(shape.at(time), components.dt)))
    periods = periods_of_fit(duration)
    wanted = TargetMotions(
        periods, components.spectrum(periods), USUAL_DAMPING, duration, shape, std
    )
    fit = deliver(wanted, filters, seed, progress, PATHS_OF_MOTION)
    ground = fit.ground()
    factor = std / rms_acceleration(ground)
    both = len(components.records) == 2
    usual = between_components(components, band) if both else OTHER_COMPONENT
    changed: dict[str, Any] = {
        "intensity": float(ground.arrays()["intensity"]) * factor**2,
        "source": f"energy and response spectrum of {components.source}; {usual}",
        "scatter": usual.scatter,
    }
    lasting = _significant(shape.at(time), components.dt)
    of_record = _significant(common.to_numpy(), components.dt)
    for warning in _misfits(lasting, of_record, periods, factor * np.exp(fit.off), band):
        warnings.warn(f"{components.source}: {warning}", DoubtfulInput, stacklevel=3)
    return FittedMotion(replace(ground, **changed), shape, duration, *usual)


def periods_of_fit(duration: float) -> Array:
    """Periods [s] at which spectra of a record and of motions of this length [s] are compared."""
    longest = min(LONGEST_FITTED, duration / FEWEST_CYCLES)
    return np.geomspace(SHORTEST_PERIOD, longest, FITTED_PERIODS)


def between_components(
    components: Components, band: tuple[float, float] = USUAL_BAND
) -> UsualScatter:
    """The scatter of both components of a station about their median in a band of periods [s]."""
    logs = np.log(components.spectra(np.geomspace(*band, BAND_POINTS)))
    scatter = float(np.sqrt(logs.var(axis=0, ddof=1).mean()))  # root mean square over the periods
    between = "standard deviation of ln Sa between both components"
    return UsualScatter(scatter, f"{between}, {band[0]:g} to {band[1]:g} s")


def _significant(values: Array, dt: float) -> float:
    """Time from 5 to 95 % of the energy [s]."""
    first, last = strong_samples(values)
    return dt * float(last - first)


def _misfits(
    duration: float, wanted: float, periods: Array, ratio: Array, band: tuple[float, float]
) -> Iterator[str]:
    """Sentences on what motions miss: significant durations [s] and ratios of spectra."""
    if not 1 / LIKE_DURATION <= duration / wanted <= LIKE_DURATION:
        what = (
            f"the motions have a significant duration of {duration:.3g} s, the record "
            f"{wanted:.3g} s"
        )
        yield f"{what}; try another envelope"
    inside = (periods >= band[0]) & (periods <= band[1])
    off = np.log(ratio[inside])
    rms = float(np.sqrt(np.mean(off**2))) if off.size else 0.0
    if rms > np.log(LIKE_SPECTRUM):
        worst = int(np.abs(off).argmax())
        where = f"from {band[0]:.2g} to {band[1]:.2g} s, most at {periods[inside][worst]:.2g} s"
        yield f"the mean spectrum is off by {100 * np.expm1(rms):.0f} % {where}; try more filters"


def energy_ratio(
    record: xr.DataArray, ground: Ground, envelope: Envelope | None, duration: float
) -> float:
    """Mean energy of motions over that of a record [-], ``sigma^2 Int m^2 dt / Int a^2 dt``."""
    of_motions = rms_acceleration(ground) ** 2 * strong_seconds(duration, envelope)
    return of_motions / float(energy_of(*checked_record(record)))
