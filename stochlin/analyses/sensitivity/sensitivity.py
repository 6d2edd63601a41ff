"""What matters for the gap of two buildings: shares of its variance, and its slopes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.analyses.sensitivity.estimates import (
    Estimate,
    changed_quantiles,
    variance_shares,
)
from stochlin.analyses.sensitivity.inputs import STEP, Inputs
from stochlin.analyses.sensitivity.variables import VARIABLES
from stochlin.analyses.simulation.draws import INPUT
from stochlin.analyses.simulation.finite_motions import check_motion, quantile_intervals
from stochlin.analyses.simulation.simulation import check_repeated, drawn_separations
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.checks import check_confidence, check_duration, standing
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.simulation.stepping import LANES
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground
from stochlin.models.parameters import expect
from stochlin.models.systems import AnyStructure
from stochlin.models.uncertain import median_of

SAMPLES = 2  # of the inputs for each motion, of which shares of variance come
END, ENDS = "end", ("low", "high")
REFERENCES = (
    "Sobol, I. M. (1993), Math. Model. Comput. Exp. 1; Plischke, E., Borgonovo, E. and Smith, C. L. "
    "(2013), Eur. J. Oper. Res. 226; Cleveland, W. S. (1979), J. Am. Stat. Assoc. 74."
)


def sensitivity(
    first: AnyStructure,
    second: AnyStructure | None,
    ground: Ground,
    duration: float,
    *,
    envelope: Envelope | None = None,
    confidence: float = 0.9,
    scatter: float = 0.0,
    paths: int = 512,
    seed: int = 0,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Influence of each input on the gap of two buildings, and its share of the uncertainty.

    For every number by which structures and ground are described: the share of the variance of the
    separation that comes from not knowing it, and how the gap of `separation` changes with it. All of
    it is from the same motions.

    Parameters
    ----------
    first, second, ground
        As in `separation`, numbers or `Uncertain` ones; of one structure, with None second, all is about
        its set-back.
    duration, envelope, confidence, scatter
        As in `separation`.
    paths : int
        Motions, each of which is simulated three times, twice for every input, and twice more for one
        that is uncertain.
    seed, progress
        As in `separation`.

    Returns
    -------
    xarray.Dataset
        Over ``input``, ``"structure_1.period"`` and so on, with the coordinates ``input_median`` and
        ``input_unit``, and ``uncertain``, 1 where it is not known exactly; an array, as stiffnesses of
        storeys, is one input, a common factor of median 1. ``variance_share`` [-]: the first-order index
        ``Var(E[Y | x])/Var(Y)`` of the separation ``Y`` of each motion, 0 of what is known. ``slope``
        [m]: change of the gap per unit of the input, or of its median; ``elasticity`` [-]: per cent of
        the gap per per cent of the input. Over ``end`` too: ``input_factor_at`` [-], a low and a high
        value over the median, those of 16 and 84 % where the input is uncertain, and as an example 10 %
        to either side where it is known; ``gap_change`` [m]: how the gap changes if the input is known
        to have that value, all others being as they are. Without dimensions: ``gap`` [m] with its 95 %
        interval, ``gap_of_medians`` [m], ``motion_share`` and ``interaction_share`` [-], the parts of
        the variance from the motion alone and from several together. All but ``gap`` have standard
        errors.

    Raises
    ------
    ValueError, TypeError
        As `separation`; parameters are numbers, not tables.

    Notes
    -----
    Shares are of the variance of the separation itself, in [m^2], not of its logarithm. They are nearly
    unbiased, and may come out a little below 0. Strength by reduction factor means that of the ground at
    its medians: a stronger ground meets the same strength in metres. Slopes
    are taken over 10 % to either side; a value that the model does not take, as a hardening above 1, is
    left out. What defines a strength or bears no load here
    (``peak_factor``, the ``mass`` of an oscillator) is no input, nor is a number within a law or a list.

    References
    ----------
    Sobol (1993); Plischke, Borgonovo and Smith (2013).

    Examples
    --------
    >>> import stochlin as sl
    >>> old = sl.Bilinear(sl.Uncertain(0.6, 0.25), 0.05)
    >>> new, ground = sl.Bilinear(1.0, 0.05), sl.named_ground("firm", intensity=0.01)
    >>> table = sl.sensitivity(old, new, ground, 15.0, paths=64)
    >>> float(table.elasticity.sel(input="ground.intensity").round(2))  # of linear structures 1/2
    0.5
    >>> bool(table.variance_share.sel(input="structure_1.period") < table.motion_share)
    True
    """
    check_confidence(confidence)
    usual = median_of(ground)
    given = standing(first, second)
    both = {role: median_of(structure) for role, structure in given.items()}
    expect(usual, Ground, "ground")
    check_duration(duration, both)
    check_motion(duration, envelope, scatter, [confidence], both)
    check_repeated([*both.values()], usual, duration, paths, seed, 1)
    inputs = Inputs.of([*given.values()], ground)
    times = 1 + SAMPLES + 2 * (len(inputs.inputs) + len(inputs.uncertain))
    check_repeated([*both.values()], usual, duration, paths, seed, times)
    asked = _Asked(inputs, duration, envelope, scatter, paths, seed, progress, times)
    found = asked.responses()
    table = _table(found, inputs, confidence)
    table = labels.label(table, VARIABLES)
    return labels.with_run_information(
        table.assign_attrs(
            confidence=confidence,
            paths=found.base.size,
            seed=seed,
            duration_s=float(duration),
            envelope="none" if envelope is None else envelope.describe(),
            **labels.of_scatter(scatter),
        ),
        f"What matters for {_asked_of(second)}, {usual.name} ground",
        f"sensitivity(duration={duration:g}, confidence={confidence:g}, paths={paths}, seed={seed})",
        {**given, "ground": ground},
        REFERENCES,
    )


def _asked_of(second: AnyStructure | None) -> str:
    return "the set-back of a building" if second is None else "the gap of two buildings"


class _Responses(NamedTuple):
    """Separations [m] of the same motions."""

    samples: Array  # (SAMPLES, motions): of independent samples of the inputs
    usual: Array  # (motions,): with all inputs at their medians
    shares: Array  # (SAMPLES, motions, uncertain inputs): of the values of an input, those below
    near: Array  # (inputs, 2, motions): with an input a little smaller and larger
    near_factors: Array  # (inputs, 2)
    ends: Array  # (inputs, 2, motions): with an input at the ends of its range
    end_factors: Array  # (inputs, 2)

    @property
    def base(self) -> Array:
        """Those of `separation` (motions,)."""
        return self.samples[0]


class _Asked(NamedTuple):
    """What is simulated again and again."""

    inputs: Inputs
    duration: float
    envelope: Envelope | None
    scatter: float
    paths: int
    seed: int
    progress: Progress | None
    times: int

    def responses(self) -> _Responses:
        """All simulations, in steps that fit the first."""
        inputs, done = self.inputs.inputs, 0
        motions = -(-self.paths // LANES) * LANES
        step: float | None = None
        sets = [self.inputs.sampled(self.paths, self.seed, number) for number in range(SAMPLES)]
        base = sets[0]
        of_base = self.inputs.at(base, {}, motions)
        made = {role: of_base.samples_of(role) for role in of_base.factors}

        def run(samples: Mapping[str, Array], changes: Mapping[str, float]) -> Array:
            nonlocal done, step
            drawn = self.inputs.at(samples, changes, motions)
            if samples is base or changes:
                changed = {name.partition(".")[0] for name in changes}
                kept = {role: each for role, each in made.items() if role not in changed}
                drawn = drawn._replace(made=kept)
            found, step = drawn_separations(
                drawn,
                paths=self.paths,
                seed=self.seed,
                duration=self.duration,
                envelope=self.envelope,
                scatter=float(self.scatter),
                step=step,
            )
            done += 1
            if self.progress is not None:
                self.progress(done / self.times)
            return found

        samples = np.array([run(one, {}) for one in sets])
        near_factors, end_factors = np.ones((2, len(inputs), 2))
        near, ends = np.empty((2, len(inputs), 2, motions))
        for n, one in enumerate(inputs):
            others = {name: column for name, column in base.items() if name != one.name}
            for side, (small, end) in enumerate(zip((1 - STEP, 1 + STEP), one.ends(), strict=True)):
                if self.inputs.possible(one, base, small):
                    near_factors[n, side] = small
                near[n, side] = run(base, {one.name: near_factors[n, side]})
                end_factors[n, side] = end if one.uncertain else near_factors[n, side]
                ends[n, side] = run(others, {one.name: end}) if one.uncertain else near[n, side]
        columns = [[each[one.name] for one in self.inputs.uncertain] for each in sets]
        ranks = np.argsort(np.argsort(np.reshape(columns, (SAMPLES, -1, motions)), axis=2), axis=2)
        return _Responses(
            samples,
            usual=run({}, {}),
            shares=(np.moveaxis(ranks, 1, 2) + 0.5) / motions,
            near=near,
            near_factors=near_factors,
            ends=ends,
            end_factors=end_factors,
        )


def _table(found: _Responses, inputs: Inputs, confidence: float) -> xr.Dataset:
    base, listed, level = found.base, inputs.inputs, np.array([confidence])
    gap, lower, upper = (float(end[0]) for end in quantile_intervals(base, level))
    medians = np.array([one.value for one in listed])
    width = np.diff(found.near_factors)[:, 0]
    below, above = np.moveaxis(found.near, 1, 0)
    slopes = changed_quantiles(base, above, below, confidence)
    of_ends = np.vstack([found.ends.reshape(-1, base.size), found.usual])
    at_ends = changed_quantiles(base, of_ends, base[None], confidence)
    shape = found.end_factors.shape
    shares = _shares(found, inputs)
    units = [one.units for one in listed]
    coords: dict[str, Any] = {
        INPUT: (INPUT, [one.name for one in listed], {"long_name": "number of a model"}),
        "input_median": (INPUT, medians, {"long_name": "the input, or its median, in its unit"}),
        "input_unit": (INPUT, units, {"long_name": "unit of the input"}),
        "uncertain": (INPUT, np.array([one.uncertain for one in listed], np.int8),
                      {"long_name": "1 where the input is not known exactly"}),
        END: (END, list(ENDS), {"long_name": "end of the range of the input"}),
    }  # fmt: skip
    table = xr.Dataset(coords=coords)
    table = table.assign(gap=gap, gap_lower=lower, gap_upper=upper)
    table["gap_of_medians"] = gap + at_ends.value[-1]
    table["gap_of_medians_standard_error"] = at_ends.error[-1]
    table["input_factor_at"] = (INPUT, END), found.end_factors
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = Estimate(*(part / width for part in slopes))
    sizes = {"slope": medians, "elasticity": np.full(medians.size, gap or np.nan)}
    estimates = {
        "variance_share": (INPUT, shares[0]),
        "motion_share": ((), shares[1]),
        "interaction_share": ((), shares[2]),
        **{name: (INPUT, Estimate(*(part / by for part in relative))) for name, by in sizes.items()},
        "gap_change": ((INPUT, END), Estimate(*(part[:-1].reshape(shape) for part in at_ends))),
    }
    for name, (dims, estimate) in estimates.items():
        table[name] = dims, estimate.value
        table[f"{name}_standard_error"] = dims, estimate.error
    return table


def _shares(found: _Responses, inputs: Inputs) -> tuple[Estimate, Estimate, Estimate]:
    """Of every input, of the motion, and of what they do together."""
    whole = Estimate(np.zeros(len(inputs.inputs)), np.zeros(len(inputs.inputs)))
    if not inputs.uncertain:
        return whole, Estimate(np.ones(()), np.zeros(())), Estimate(np.zeros(()), np.zeros(()))
    shares = variance_shares(found.samples, found.usual, found.shares)
    of_inputs = np.flatnonzero([one.uncertain for one in inputs.inputs])
    whole.value[of_inputs], whole.error[of_inputs] = (part[:-2] for part in shares)
    of_motion, together = (Estimate(*(part[n] for part in shares)) for n in (-2, -1))
    return whole, of_motion, together
