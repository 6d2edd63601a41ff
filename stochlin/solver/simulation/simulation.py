"""Nonlinear simulation of any number of structures on one ground."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import xarray as xr

from stochlin.kernels.basics.parallel import Progress
from stochlin.models.arguments import (
    Duration,
    Paths,
    Quantiles,
    RelaxationTimes,
    Scatter,
    Seed,
    StepsPerPeriod,
    checked,
)
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground, scatter_of
from stochlin.models.links import Link
from stochlin.models.start import Start
from stochlin.models.structures import AnyStructure
from stochlin.models.uncertain import median_of
from stochlin.solver.simulation.checks import check_simulation
from stochlin.solver.simulation.finite_motions import simulate_finite
from stochlin.solver.simulation.results import descriptions
from stochlin.solver.simulation.start_values import start_in_words
from stochlin.solver.simulation.stationary_motions import stationary_moments
from stochlin.solver.simulation.structures_in_motion import (
    StructuresInMotion,
    structures_in_motion,
)
from stochlin.solver.tables import labels

STEPS_PER_PERIOD = 32


@checked(uncertain=True)
def simulate(
    structures: Sequence[AnyStructure],
    ground: Ground,
    *,
    paths: Paths = 256,
    seed: Seed = 0,
    steps_per_period: StepsPerPeriod = STEPS_PER_PERIOD,
    relaxation_times: RelaxationTimes = 20.0,
    duration: Duration | None = None,
    envelope: Envelope | None = None,
    scatter: Scatter | None = None,
    quantiles: Quantiles = (0.5, 0.84, 0.95),
    link: Link | Sequence[Link | None] | None = None,
    start: Start | None = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Response of structures on one ground by nonlinear simulation.

    Without a duration the result has the stationary second moments of the displacements; with a
    duration, the peaks in finite motions. All structures are subjected to the same motions, so
    that the result has each pair of them.

    Parameters
    ----------
    structures : sequence of Bilinear, BoucWen, Hysteretic or ShearBuilding
        The structures, with scalar parameters. A ``reduction_factor`` refers to the elastic
        response of the structure without links. With a duration, parameters may be `Uncertain`;
        each motion then has its own sample.
    ground : WhiteNoise, KanaiTajimi or CloughPenzien
        The ground, with scalar parameters, or `Uncertain` ones with a duration.
    paths : int
        Number of independent motions, which is rounded up to a multiple of 32.
    seed : int
        Seed of the random numbers; the result does not depend on the number of cores.
    steps_per_period : int
        Time steps in the shortest period of structures and ground, at least 8.
    relaxation_times : float
        Duration of each stationary motion after the burn-in, at least 1, in multiples of the
        longest memory of structures and ground. The memory is ``1/(xi w)`` or the correlation time
        of the plastic drift, which is measured in a short simulation. The burn-in takes five times
        the memory.
    duration : float, optional
        Duration of each motion [s], at least one period; without it the response is stationary.
    envelope : AminAng, ShinozukaSato or GammaEnvelope, optional
        Envelope of finite motions; without it they are stationary from their start.
    scatter : float
        Standard deviation [-] of the natural logarithm of a random factor on the ground
        acceleration of each finite motion, from 0 to 2. The factors have the median 1 and are
        independent. They represent the scatter between earthquakes, which the PSD of a ground does
        not contain. The motions are otherwise the same as without scatter. By default it is
        ``ground.scatter``: 0.3 of a ground by `fit_ground` for a spectrum, 0.4 for a record, 0 of
        others.
    quantiles : sequence of float
        Probabilities of the quantiles of the separation in finite motions, between 0 and 1.
    link : Link or list of Link and None, optional
        Links from each structure to the next, or between the structures that the ``structures`` of
        a link name, which may be one structure; linked oscillators need a mass.
    start : Start, optional
        Displacements and velocities at the start of all finite motions, from rest by default.
    progress : callable, optional
        Called with the share of the work that is done.

    Returns
    -------
    xarray.Dataset
        Without a duration, over ``structure``: ``displacement_std`` [m] with
        ``displacement_std_standard_error``; ``ductility_std`` [-]; ``drift`` [-], the change of the
        variance from the first half of the run to the second in standard errors; ``drift_memory``
        [s], the relaxation time of the plastic drift, 0 if elastic; and ``status``, which is
        ``not_converged`` if the drift exceeds 5, and ``not_resolved`` if the structure yields too
        rarely for the run (see the notes). Over (``structure``, ``structure_2``): ``rho`` [-] with
        ``rho_standard_error``.

        With a duration, over (``path``, ``structure``): ``peak_positive``, ``peak_negative`` and
        ``peak``, the larger of both [m]. Over (``path``, ``structure``, ``structure_2``):
        ``separation`` [m], the peak of ``u_1 - u_2``, which is the gap without pounding for
        ``structure`` on the left of ``structure_2``. Also their means with standard errors, and
        ``separation_quantile`` with its 95 % interval, ``_lower`` and ``_upper``. `exceedance`
        gives the probability of exceeding a gap from the samples. With uncertain parameters also
        ``input_factor`` [-] over (``path``, ``input``), the samples over the medians. With links
        also, over (``path``, ``link``) and as means with standard errors: ``peak_link_force`` [N],
        means over steps, ``peak_link_stroke`` [m] and ``link_energy`` [J], which the link
        dissipates in the motion.

        A structure whose stiffness after yielding is negative, by its ``hardening`` or by P-delta,
        falls where its force at the largest ``z`` is zero again, or where a storey drifts by its
        height. Such a motion exceeds any gap: its peaks, separations and links are infinite.
        ``collapse_probability`` [-] over ``structure``, with its 95 % interval, is their share.

        With a building with storeys, displacements are over ``floor`` in place of ``structure``,
        and ductilities over ``element``, the storeys; standard deviations and peaks of the drifts
        are added.

    Raises
    ------
    ValueError, TypeError
        If there is no structure, a parameter is an array, an argument is of the wrong kind or out
        of range, or the simulation would take too much memory or time.
    ArithmeticError
        If the elastic response of a structure cannot be computed.

    Notes
    -----
    The time steps are those of the trapezoidal rule. The bilinear law has an exact return map in
    them, the states of other laws a rule of fourth order. For linear structures the second moments
    are exact for any step. A law in sympy is compiled in a second or two. Storeys with the Bouc-Wen
    law take as long as bilinear ones, with an exponent other than 1 three times, dashpots with an
    exponent ten times as long. Standard errors come from the scatter between independent paths.

    The plastic drift of a structure that yields rarely takes very long to settle. The run is only
    as long as all drifts require that settle within ten million steps of each motion. A structure
    whose drift takes longer has the status ``not_resolved``, and so have structures that are linked
    to it. Its numbers are those of the simulated motions, with the standard errors of these. They
    lack most of the drift, so that the stationary standard deviation is larger, and ``rho`` is
    another one. A response is stationary only after several ``drift_memory``, which no earthquake
    lasts if it is a minute or more. It is measured where a drift determines the length of the run;
    else, and if it is not resolved, it is that by linearization, which is 1.2 to 10 times as long.
    With fewer ``relaxation_times`` more structures are resolved. A simulation that would take a
    quarter of an hour or more is refused.

    References
    ----------
    Hairer, Lubich and Wanner (2006), Geometric numerical integration; Simo and Hughes (1998),
    Computational inelasticity, for the return map.

    Examples
    --------
    >>> import numpy as np, stochlin as sl
    >>> pair = [sl.Bilinear(period=T, damping=0.05) for T in (0.5, 1.0)]
    >>> table = sl.simulate(pair, sl.WhiteNoise(0.01), paths=64, relaxation_times=20)
    >>> exact = float(sl.rho_white_noise(0.5, 1.0, 0.05, 0.05).rho)
    >>> bool(abs(table.rho[0, 1] - exact) < 4 * table.rho_standard_error[0, 1])
    True
    """
    if scatter is None:
        scatter = 0.0 if duration is None else scatter_of(ground, None)
    check_simulation(structures, ground, paths, duration, envelope, scatter, start)
    moving = structures_in_motion(
        structures,
        ground,
        link,
        duration is None,
        paths=paths,
        seed=seed,
        steps_per_period=steps_per_period,
        scatter=scatter,
    )
    if duration is not None:
        table = labelled_motions(moving.starting(start), duration, envelope, quantiles, progress)
        state = "finite motions"
        more = f", duration={duration}"
    else:
        table = stationary_moments(moving, relaxation_times, progress)
        table = labels.label(table, descriptions(), last=labels.NOT_RESOLVED)
        state = "stationary response"
        more = ""
    lone = isinstance(link, Link)
    models = labels.named_models(structures, ground, () if lone else moving.links)
    return labels.with_run_information(
        table.assign_attrs(start_in_words(start)),
        f"Simulation of {len(structures)} structures in {state}, {median_of(ground).name} ground",
        f"simulate(paths={paths}, seed={seed}{more})",
        models | ({"link": link} if lone else {}),
    )


def labelled_motions(
    moving: StructuresInMotion,
    duration: float,
    envelope: Envelope | None,
    quantiles: Sequence[float],
    progress: Progress | None = None,
) -> xr.Dataset:
    """`simulate` in finite motions, with labels, without what says how the dataset was made."""
    table = simulate_finite(moving, duration, envelope, quantiles, progress)
    return labels.label(table, descriptions(), last=labels.NOT_RESOLVED)


def in_finite_motions(
    structures: Sequence[Any],
    ground: Any,
    link: Link | Sequence[Link | None] | None = None,
    *,
    paths: int,
    seed: int = 0,
    scatter: float = 0.0,
) -> StructuresInMotion:
    """Structures in finite motions, with the usual time step."""
    return structures_in_motion(
        structures,
        ground,
        link,
        False,
        paths=paths,
        seed=seed,
        steps_per_period=STEPS_PER_PERIOD,
        scatter=scatter,
    )


def time_step(structures: Sequence[AnyStructure], ground: Ground) -> float:
    """Time step of `simulate` in finite motions of these structures [s]."""
    return in_finite_motions(structures, ground, paths=1).run.plan.dt
