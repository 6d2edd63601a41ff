"""Mean response spectrum of simulated motions, compared with a target spectrum."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import xarray as xr

from stochlin.applications.sites.elastic_spectra import (
    USUAL_DAMPING,
    DividedBy,
    as_elastic,
    taken_in_words,
)
from stochlin.applications.sites.spectra import (
    SHORTEST_PERIOD,
    checked_spectrum,
    interpolated,
    is_spectrum,
)
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.messages import brief, refuse
from stochlin.models.arguments import (
    DampingRatio,
    Duration,
    Paths,
    Seed,
    Truth,
    as_numbers,
    checked,
)
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.parameters import Model
from stochlin.models.systems import stick_model_of
from stochlin.solver.simulation.connected_structures import oscillator_groups
from stochlin.solver.simulation.ensembles import prepare
from stochlin.solver.simulation.finite_motions import extremes_of
from stochlin.solver.simulation.ground_motions import simulated_motions
from stochlin.solver.simulation.statistics import mean_with_error
from stochlin.solver.tables import labels
from stochlin.solver.tables.checks import check_scalars

COMPARED_PERIODS = 48  # number of periods at which a target spectrum is compared
SPECTRUM_QUANTILES = (0.16, 0.5, 0.84)
# In the shortest period. With n steps a period is longer by the factor 1 + (2 pi/n)^2/12.
SPECTRUM_STEPS_PER_PERIOD = 64
PGA_STEP = 0.01  # [s], of the motions whose peaks are counted; they grow with smaller steps
OSCILLATORS_TOGETHER = 24  # oscillators of neighbouring periods that have the same time step


@dataclass(frozen=True)
class SpectrumMotions:
    """Simulated motions of a ground, equal to others whatever their ``progress`` is."""

    ground: Ground
    duration: float  # [s]
    envelope: Envelope | None
    paths: int
    seed: int
    progress: Progress | None = field(default=None, compare=False)

    def accelerations(self) -> xr.DataArray:
        """Ground accelerations [m/s^2] over ``path`` and ``time``, in steps of `PGA_STEP`."""
        return simulated_motions(**vars(self), step=PGA_STEP, scatter=0.0)

    def models(self) -> dict[str, Model]:
        """Ground and envelope, for the run information."""
        return {name: model for name, model in vars(self).items() if isinstance(model, Model)}


@checked
def simulated_spectrum(
    ground: Ground,
    target: xr.DataArray | Sequence[float] | Array,
    duration: Duration,
    envelope: Envelope | None = None,
    *,
    damping: DampingRatio | None = None,
    paths: Paths = 1024,
    seed: Seed = 0,
    progress: Progress | None = None,
    elastic: Truth | None = None,
    divided_by: DividedBy | None = None,
) -> xr.Dataset:
    """Response spectrum of simulated motions, compared with a target spectrum.

    Parameters
    ----------
    ground : WhiteNoise, KanaiTajimi, CloughPenzien or ParallelGround
        Ground with scalar parameters.
    target : xarray.DataArray or sequence of float
        A spectrum, as from `stochlin.eurocode_8` and `stochlin.read_spectrum`, which is compared at
        48 periods from 0.05 s to its longest one; or the periods [s], positive and increasing.
    duration : float
        Length of each motion [s], positive.
    envelope : AminAng, ShinozukaSato or GammaEnvelope, optional
        Envelope of the motions; without it they are stationary. The oscillators start from rest.
    damping : float, optional
        Damping ratio of the oscillators [-]; by default that of the target, or 0.05.
    paths : int
        Number of independent motions, at least 2.
    seed : int
        Seed of the simulation; the same seed gives the same result on any number of cores.
    progress : callable, optional
        Called with the share of the work that is done.
    elastic, divided_by : optional
        What a spectrum is that does not say so itself, as in `stochlin.read_spectrum`.

    Returns
    -------
    xarray.Dataset
        Over ``period`` [s]: ``pseudo_acceleration`` [m/s^2], the mean over the motions, with
        ``pseudo_acceleration_standard_error``, and ``pseudo_acceleration_quantile`` [m/s^2] also
        over ``quantile``. Without dimensions: ``peak_ground_acceleration`` [m/s^2], the mean over
        the motions in steps of 0.01 s, as in `stochlin.scale_ground`, with its standard error. For
        a target spectrum also ``target`` [m/s^2] and ``ratio`` [-], the mean over the target, with
        its standard error.

    Raises
    ------
    ValueError, TypeError
        If a number is out of range, the target is not a spectrum, or the simulation would take
        too much time or memory.

    References
    ----------
    Nigam and Jennings (1969), Bull. Seismol. Soc. Am. 59, for the exact transition of the
    oscillators.

    Examples
    --------
    >>> import stochlin as sl
    >>> ground = sl.named_ground("firm", intensity=0.01)
    >>> table = sl.simulated_spectrum(ground, [0.2, 0.5, 1.0], 20.0, paths=256)
    >>> table.pseudo_acceleration.dims, bool((table.pseudo_acceleration > 0).all())
    (('period',), True)
    """
    motions = SpectrumMotions(ground, duration, envelope, paths, seed, progress)
    check_scalars(ground, "ground", "numbers")
    if is_spectrum(target):
        checked_spectrum(target)
        target = as_elastic(target, elastic, divided_by)
    else:
        refuse("target", "periods", {"elastic": elastic, "divided_by": divided_by})
    periods, wanted, of_target = _asked(target)
    ratio = of_target if damping is None else damping
    table = compared_spectrum(motions, periods, wanted, ratio)
    call = f"simulated_spectrum(duration={duration}, damping={ratio}, paths={paths}, seed={seed})"
    title = "Response spectrum of simulated motions"
    if wanted is not None and isinstance(target, xr.DataArray):
        source = str(target.attrs.get("source", "a spectrum"))
        table.target.attrs |= {"source": source, "taken": taken_in_words(target)}
    return labels.with_run_information(labels.label(table), title, call, motions.models())


def compared_spectrum(
    motions: SpectrumMotions, periods: Array, wanted: Array | None, damping: float = USUAL_DAMPING
) -> xr.Dataset:
    """The variables of `simulated_spectrum`, compared with any ``wanted`` spectrum."""
    peaks = peak_accelerations(periods, damping, motions)
    duration = float(motions.duration)
    said = {"duration_s": duration, "damping": float(damping), "pga_step_s": PGA_STEP}
    table = xr.Dataset(coords={"period": labels.axis("period", "period", periods, "s")}, attrs=said)
    table = table.assign_coords(
        quantile=labels.axis("quantile", "quantile", np.array(SPECTRUM_QUANTILES))
    )
    _assign_mean(table, "pseudo_acceleration", peaks, "period")
    quantiles = np.quantile(peaks, SPECTRUM_QUANTILES, axis=0)
    table["pseudo_acceleration_quantile"] = ("quantile", "period"), quantiles
    accelerations = replace(motions, progress=None).accelerations()
    _assign_mean(table, "peak_ground_acceleration", np.abs(accelerations.to_numpy()).max(axis=1))
    if wanted is not None:
        table["target"] = "period", wanted
        table["ratio"] = table.pseudo_acceleration / table.target
        table["ratio_standard_error"] = table.pseudo_acceleration_standard_error / table.target
    return table


def _assign_mean(table: xr.Dataset, name: str, samples: Array, *dims: str) -> None:
    """Put the mean of samples along their first axis, and its standard error, into a table."""
    mean, error = mean_with_error(samples)
    table[name] = dims, mean
    table[f"{name}_standard_error"] = dims, error


def _asked(
    target: xr.DataArray | Sequence[float] | Array,
) -> tuple[Array, Array | None, float]:
    """Periods [s], the target spectrum at these periods [m/s^2], if any, and its damping ratio."""
    if is_spectrum(target):
        period, values, damping = checked_spectrum(target)
        sought = np.geomspace(
            max(SHORTEST_PERIOD, period[period > 0][0]), period[-1], COMPARED_PERIODS
        )
        return sought, interpolated(period, values, sought), damping
    periods = as_numbers("target", target, "a spectrum, or periods in seconds").astype(float)
    if periods.ndim != 1 or not periods.size or not (np.diff(periods, prepend=0.0) > 0).all():
        raise ValueError(
            f"target = {brief(target)}; allowed: a spectrum, or increasing periods above 0"
        )
    return periods, None, USUAL_DAMPING


def peak_accelerations(
    periods: Array,
    damping: float,
    motions: SpectrumMotions,
    steps_per_period: int = SPECTRUM_STEPS_PER_PERIOD,
) -> Array:
    """Pseudo-accelerations of elastic oscillators in each motion [m/s^2], (paths, periods).

    Neighbouring periods have the same time step, ``steps_per_period`` in the shortest of them.
    """
    accelerations = np.empty((motions.paths, periods.size))
    order = np.argsort(periods)
    for mine in np.array_split(order, -(-periods.size // OSCILLATORS_TOGETHER)):
        sticks = [stick_model_of(Bilinear(float(t), damping)) for t in periods[mine]]
        run = prepare(
            oscillator_groups(sticks, np.arange(mine.size)),
            motions.ground,
            paths=motions.paths,
            seed=motions.seed,
            steps_per_period=steps_per_period,
        )
        motion = motions.duration, motions.envelope
        extremes = extremes_of(run, [np.eye(mine.size)], motion, motions.progress)
        peaks = np.maximum(extremes.highest, -extremes.lowest)[: motions.paths]
        accelerations[:, mine] = (2 * np.pi / periods[mine]) ** 2 * peaks
    return accelerations
