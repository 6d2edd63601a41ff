"""Probability of pounding in a finite earthquake: formula, correction and simulation side by side."""

from __future__ import annotations

from typing import Any

import xarray as xr

from stochlin.analyses.linearization.strength import strength_in_metres
from stochlin.analyses.linearization.transient_systems import (
    POINTS,
    check_course,
    over_time,
)
from stochlin.analyses.probability.cells import SAMPLES, PairTable, by_formula, by_simulation
from stochlin.analyses.probability.confidence_errors import cautions
from stochlin.analyses.probability.hybrid import hybrid_pounding
from stochlin.analyses.probability.simulated import Draws
from stochlin.analyses.probability.storeys import storeys_in_motion
from stochlin.analyses.probability.strengths import at_strengths, strengths
from stochlin.analyses.probability.variables import VARIABLES
from stochlin.analyses.simulation.draws import draw
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.checks import check_confidence, check_scatter, check_whole
from stochlin.kernels.basics.parallel import Progress
from stochlin.messages import brief
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground
from stochlin.models.parameters import Parameter, expect
from stochlin.models.structures import Gap, Structure
from stochlin.models.systems import STRUCTURES, AnyStructure
from stochlin.models.uncertain import median_of

METHODS = ("evolutionary", "hybrid")
REFERENCES = (
    f"{labels.PAPER} Vanmarcke, E. H. (1975), J. Appl. Mech. 42; Rice, S. O. (1945), Bell Syst. Tech. "
    "J. 24; Roberts, J. B. and Spanos, P. D. (1990). Random vibration and statistical linearization."
)


def pounding_probability(
    first: AnyStructure,
    second: AnyStructure,
    ground: Ground | None,
    gap: Parameter,
    *,
    envelope: Envelope | None = None,
    duration: float | None = None,
    method: str = "evolutionary",
    record: xr.DataArray | None = None,
    confidence: float = 0.9,
    scatter: float = 0.0,
    points: int = POINTS,
    paths: int = 2048,
    seed: int = 0,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Probability that two structures pound in a motion of finite length, over time.

    ``first`` stands on the left; they pound when ``u_1 - u_2`` exceeds the gap.

    Parameters
    ----------
    first, second : Bilinear, BoucWen, Hysteretic or ShearBuilding
        All parameters of oscillators broadcast by dimension name. With a building the gap is kept at
        all heights at once; see the notes.
    ground : WhiteNoise, KanaiTajimi or CloughPenzien
        Stationary, before it is modulated. For ``"hybrid"`` it may be None: it is then fitted to the
        record.
    gap : float or array
        Gap [m], positive.
    envelope : AminAng, ShinozukaSato, GammaEnvelope or HsuBernard, optional
        ``m(t)``, which multiplies the ground; without it the ground starts at once.
    duration : float
        Length of the motion [s], at least a period of the structures. Not for ``"hybrid"``.
    method : str
        ``"evolutionary"``: modulated ground, Gaussian response by transient linearization.
        ``"hybrid"``: radii of eq. (1) from ``record``, the phase between the structures random.
    record : xarray.DataArray
        For ``"hybrid"``: ground acceleration [m/s^2] over ``time``, as `read_record` gives it.
    confidence : float
        Probability of no pounding, for ``required_gap``; between 0 and 1.
    scatter : float
        As in `simulate`. Formulas are averaged over it, structures keeping the strength in metres that
        they have in ``ground``; ``_corrected`` is NaN unless the map of the bias reaches all strengths
        of the motion. Not for ``"hybrid"``.
    points : int
        Instants of the result.
    paths, seed : int
        Of the simulation beside the formulas, as in `simulate`; with ``paths=0`` there is none, and
        nothing but ``caution`` says how far the formulas are off. In a simulation only the intensity of
        the ground may be an array.
    progress : callable, optional
        Called with the share of the simulation that is done.

    Returns
    -------
    xarray.Dataset
        Over ``time`` [s], from rest at 0: ``instantaneous_probability`` [-], ``1 - Phi(gap/s)``, and
        ``confidence_of_no_pounding`` [-], ``exp(-Int)`` of the rate of first crossings, which come in
        clumps (Vanmarcke); ``_poisson``: of all crossings; ``_corrected``: with the drift of yielding
        structures that linearization loses, as far as the map of its bias reaches (NaN elsewhere);
        ``_simulated`` with a 95 % interval, ``_lower``, ``_upper``. ``displacement_std_1``, ``_2`` and
        ``difference_std`` [m] likewise, and ``rho``, NaN at rest. ``envelope`` [-]. ``permanent_set``: a
        flag once shaking is no longer strong. Without ``time``: ``required_gap`` [m], ``_corrected`` and
        ``_simulated``; ``status``; ``caution``: a flag of the confidence by formula at the end of the
        motion, 0 where it is too large by 0.1 at most, 1 where it may be by more, 2 outside of what was
        checked, and ``caution_corrected``. The variables of ``"hybrid"`` are in the notes.

    Raises
    ------
    ValueError, TypeError
        If a number is out of range, the envelope is negative or nothing within the duration, the
        duration is shorter than a period, or arguments do not go with the method.
    ArithmeticError
        If a single case fails.

    Notes
    -----
    For linear structures the moments are exact, and the confidence has the error of the crossings
    alone: compared with simulation, -0.15 to +0.06 (Poisson: -0.32 to 0), largest for small gaps, for
    structures of very different periods and for light damping. The 90 % gap has an error of -4 to +4 %.

    Two buildings meet at the floor levels of both, up to the lower roof; between two levels the
    displacement is not larger. The variables ``_at_height`` (confidence, instantaneous probability,
    ``difference_std``, ``required_gap`` and ``rho``) are the results at each height by itself. The
    confidence without this ending is that of the worst height, and the confidence at all heights
    together is not larger. ``confidence_of_no_pounding_at_least`` is a lower limit of it by Boole's
    inequality, which adds the probabilities of all heights and holds however the heights depend on one
    another. Likewise, ``required_gap`` is the gap at ``governing_height``, and the buildings need at
    least this gap. The simulated results hold for all heights at once. ``displacement_std``,
    ``difference_std`` and ``rho`` are those at the highest level. The map of the bias does not cover
    storeys: ``_corrected`` is NaN where they yield.

    Where structures yield, linearization loses the plastic drift, and the permanent set after strong
    shaking. It was compared with simulation for 762 random yielding pairs (R 1 to 9, hardening 0.02 to
    0.3, white noise, Kanai-Tajimi and named grounds, 8 to 40 s). The confidence by formula was too
    large by more than 0.1 in 24 % of the cases, and by up to 0.97. The corrected confidence, where it
    is known, was too large by more than 0.1 in 13 % of the cases, and by up to 0.78. The conditions for
    the flags were chosen on half of the pairs, and the following results come from the other half:

    - With ``caution`` 0 the confidence by formula was too large by more than 0.1 in 2.2 % of the cases,
      by 0.12 at most; elsewhere in 29 %. ``caution`` is 0 for one pair of six: where the pair stays
      elastic (too large by 0.09 at most), where both structures have R up to 1.5 and T from Tg/2 on,
      and where a reliable correction reduces the confidence by 0.05 at most.
    - With ``caution_corrected`` 0 the corrected confidence was too large by more than 0.1 in 0.7 % of
      the cases, by 0.20 at most; elsewhere in 32 %. It is 0 for half of the pairs: where T is at least
      Tg/2 and either the confidence is 0.85 or more, or R is up to 4 and one period is at least 1.5
      times the other.

    The simulated confidence has its interval everywhere, and takes a second or two with the usual
    ``paths``.

    The hybrid method returns, over the time of the record: ``radius_1`` and ``radius_2`` [m], the
    energy radii of both structures; ``recorded_difference`` [m], ``u_1 - u_2`` in the record;
    ``instantaneous_probability``; ``confidence_of_no_pounding``, with one phase for all of the record;
    and ``confidence_of_no_pounding_fresh_phase``, with a new phase in every cycle. Without time it
    returns ``rho``, ``separation`` [m], the gap that the record itself needs, and ``required_gap`` [m].
    The confidence is 0 from the instant at which the radii differ by more than the gap, since one
    structure then closes the gap whatever the phase.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eq. (1); Vanmarcke, E. H. (1975), J. Appl. Mech. 42; Rice (1945).

    Examples
    --------
    >>> import stochlin as sl
    >>> one, two = (sl.Bilinear(T, 0.05) for T in (0.6, 1.0))
    >>> quake = {"envelope": sl.AminAng(4.0, 15.0, 0.35), "duration": 25.0}
    >>> table = sl.pounding_probability(one, two, sl.named_ground("firm", 0.01), 0.3, paths=256, **quake)
    >>> last = table.isel(time=-1)
    >>> bool(last.confidence_of_no_pounding > last.confidence_of_no_pounding_poisson)
    True
    """
    table = with_samples(
        first,
        second,
        ground,
        gap,
        envelope=envelope,
        duration=duration,
        method=method,
        record=record,
        confidence=confidence,
        scatter=scatter,
        points=points,
        paths=paths,
        seed=seed,
        progress=progress,
    )
    return table.drop_vars(SAMPLES, errors="ignore")


def with_samples(
    first: AnyStructure,
    second: AnyStructure,
    ground: Ground | None,
    gap: Parameter,
    *,
    envelope: Envelope | None,
    duration: float | None,
    method: str = METHODS[0],
    record: xr.DataArray | None = None,
    confidence: float,
    scatter: float,
    points: int,
    paths: int,
    seed: int,
    progress: Progress | None,
) -> xr.Dataset:
    """What `pounding_probability` returns, and the largest separation of each simulated motion."""
    if not isinstance(method, str) or method not in METHODS:
        raise ValueError(f"method = {brief(method)}; allowed: {', '.join(METHODS)}")
    described: dict[str, Any] = {"first": first, "second": second, "ground": ground}
    if method != "hybrid":
        first, second, ground = (median_of(each) for each in described.values())
    for role, structure in (("first", first), ("second", second)):
        expect(structure, STRUCTURES, role)
    check_confidence(confidence)
    check_scatter(scatter)
    distance = Gap(gap)
    if method == "hybrid":
        if envelope is not None or duration is not None:
            raise ValueError("envelope and duration do not go with method='hybrid': the record has both")
        if scatter:
            raise ValueError(
                f"scatter = {scatter:g} does not go with method='hybrid': a record has one strength"
            )
        left, right = (_oscillator(*pair) for pair in (("first", first), ("second", second)))
        return hybrid_pounding(left, right, ground, distance, record, confidence)
    if record is not None:
        raise ValueError("record goes with method='hybrid'; allowed here: envelope and duration")
    expect(ground, Ground, "ground")
    assert ground is not None
    check_whole("points", points, 2)
    check_whole("seed", seed, 0)
    check_whole("paths", paths, 0)
    if paths == 1:
        raise ValueError("paths = 1; allowed: 0 for no simulation, or a whole number from 2")
    seconds = check_course(duration, envelope)
    pairs = PairTable.of(first, second, ground, distance, seconds, envelope, points)
    course, of_formula, below = pairs.moments.course, pairs, ground
    if scatter:
        factors, weights = strengths(scatter)
        below = at_strengths(ground, factors)
        one, two = (strength_in_metres(structure, ground) for structure in (first, second))
        of_formula = PairTable.of(one, two, below, distance, seconds, envelope, points, weights)
    table = by_formula(of_formula, below, confidence)
    if paths:
        options = confidence, Draws(paths, seed, float(scatter)), progress
        simulated = _simulated(pairs, described, distance, *options)
        table = table.assign(simulated.data_vars).assign_attrs(simulated.attrs)
    table = over_time(table, course).assign(status=of_formula.status)
    table = table.assign(cautions(first, second, ground, table, scatter))
    table = table.assign_attrs(confidence=confidence, **labels.of_scatter(scatter))
    table = labels.label(table, VARIABLES)
    labels.raise_if_lone_failure(table, "pounding_probability")
    if first.yields or second.yields:
        table = table.assign_attrs(comment=labels.CAUTION_SIGMA)
    return labels.with_run_information(
        table,
        f"Probability of pounding in a finite motion, {ground.name} ground",
        f"pounding_probability(duration={duration:g}, confidence={confidence:g}, paths={paths}, "
        f"seed={seed})",
        {**described, "gap": distance},
        REFERENCES,
    )


def _simulated(
    pairs: PairTable,
    described: dict[str, Any],
    distance: Gap,
    confidence: float,
    draws: Draws,
    progress: Progress | None,
) -> xr.Dataset:
    """Oscillators on the same motions; with storeys, or with samples, pair by pair."""
    first, second, ground = described.values()
    drawn = draw([first, second], ground, draws.paths, draws.seed)
    if not drawn.factors and not any(side.has_storeys for side in pairs.moments.sides):
        return by_simulation(pairs, ground, confidence, draws, progress)
    (one, two), soil = drawn.medians
    motion = distance, pairs.moments.course, confidence, draws, progress
    return storeys_in_motion(one, two, soil, *motion, drawn).assign(drawn.table())


def _oscillator(role: str, structure: AnyStructure) -> Structure:
    if isinstance(structure, Structure):
        return structure
    raise TypeError(
        f"{role} is a building with storeys; method='hybrid' is only available for oscillators: give "
        "its oscillator(), or method='evolutionary'"
    )
