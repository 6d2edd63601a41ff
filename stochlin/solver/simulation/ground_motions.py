"""Simulated ground motions as records."""

from __future__ import annotations

from typing import Annotated

import numpy as np
import xarray as xr

from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.simulation.ensemble import Ensemble, Plan, ground_motions
from stochlin.kernels.simulation.stepping import LANES
from stochlin.messages import brief
from stochlin.models.arguments import Duration, Number, Paths, Scatter, Seed, checked
from stochlin.models.envelopes import Envelope, envelope_at
from stochlin.models.grounds import Ground, scatter_of
from stochlin.models.parameters import POSITIVE
from stochlin.solver.simulation.ensembles import ground_steps
from stochlin.solver.simulation.finite_motions import STEPS_AT_ONCE
from stochlin.solver.tables import labels
from stochlin.solver.tables.checks import check_scalars, check_work

USUAL_STEP = 0.01  # default time step [s]
STEP_IN_SECONDS = Number(POSITIVE, "0 < step <= duration, in seconds")


@checked(in_metres=True)
def simulated_motions(
    ground: Ground,
    duration: Duration,
    envelope: Envelope | None = None,
    *,
    paths: Paths = 32,
    seed: Seed = 0,
    step: Annotated[float, STEP_IN_SECONDS] = USUAL_STEP,
    scatter: Scatter | None = None,
    progress: Progress | None = None,
) -> xr.DataArray:
    """Simulate ground motions, as records for `pound`, `respond`, `recorded_gap` or other programs.

    Each motion is a stationary process with the spectrum of the ground, multiplied by the envelope.
    The structures of `simulate` are subjected to the same motions if ``seed`` is the same and
    ``step`` is the attribute ``step_s`` of its dataset.

    Parameters
    ----------
    ground : WhiteNoise, KanaiTajimi, CloughPenzien or ParallelGround
        The ground, with scalar parameters.
    duration : float
        Duration of each motion [s], positive.
    envelope : AminAng, ShinozukaSato or GammaEnvelope, optional
        Envelope of the motions; without it they are stationary.
    paths : int
        Number of motions, at least 2.
    seed : int
        Seed of the random numbers; the motions do not depend on the number of cores.
    step : float
        Time step [s], positive. A value of white noise is its mean over a step.
    scatter : float
        Standard deviation [-] of the logarithm of a random factor on each motion, as in `simulate`,
        with the same factors for the same seed. By default it is that of the ground; a ground is
        fitted to a spectrum or a record by motions without it.
    progress : callable, optional
        Called with the share of the work that is done.

    Returns
    -------
    xarray.DataArray
        Ground acceleration [m/s^2] over ``path`` and ``time`` [s], named ``acceleration``.

    Raises
    ------
    ValueError, TypeError
        If an argument is out of range or of the wrong kind, a parameter of the ground is an array,
        or the motions would not fit into memory.

    Examples
    --------
    >>> import stochlin as sl
    >>> ground = sl.named_ground("firm", intensity=0.01)
    >>> motions = sl.simulated_motions(ground, 20.0, sl.AminAng(2.0, 12.0, 0.4), paths=4)
    >>> table = sl.recorded_gap(sl.Bilinear(0.5, 0.05), sl.Bilinear(1.0, 0.05), motions[0])
    >>> motions.dims, motions.shape, bool(table.separation > 0)
    (('path', 'time'), (4, 2001), True)
    """
    check_scalars(ground, "ground", "numbers")
    scatter = scatter_of(ground, scatter)
    if step > duration:
        raise ValueError(f"step = {brief(step)} is out of range; allowed: {STEP_IN_SECONDS.words}")
    steps = int(np.ceil(duration / step * (1 - 1e-12))) + 1
    check_work(
        f"{paths} motions of {duration:g} s in steps of {step:g} s would take",
        "shorten them, lower paths, or give a longer step",
        numbers=2.0 * steps * paths,
    )
    soil = ground.lone_filter()
    time = step * np.arange(steps)
    groups = -(-paths // LANES)
    plan = Plan(step, 1, 0, 0, groups, seed, STEPS_AT_ONCE, scatter=scatter)
    soil_steps, root = ground_steps(soil, step)
    if soil.states:  # the value at the beginning of each step, in place of its mean
        soil_steps = soil_steps._replace(row=soil.arrays.output, direct=0.0)
    values = ground_motions(Ensemble((), soil_steps, root, plan), steps, progress)[:paths]
    # The forcing f of a structure is minus the ground acceleration.
    values *= -envelope_at(envelope, time)
    motions = xr.DataArray(
        values,
        dims=("path", "time"),
        coords={"time": ("time", time, {"units": "s", "long_name": "time"})},
        name="acceleration",
        attrs={"units": "m/s^2", "long_name": "ground acceleration", "dt": step}
        | labels.of_scatter(scatter),
    )
    models = {"ground": ground} if envelope is None else {"ground": ground, "envelope": envelope}
    call = f"simulated_motions(duration={duration}, paths={paths}, seed={seed}, step={step})"
    table = labels.with_run_information(motions.to_dataset(), "Simulated motions", call, models)
    return motions.assign_attrs(table.attrs | {"source": f"simulated, {ground.describe()}"})
