"""Sensitivity of the gap of two buildings: its changes with every input."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.models.arguments import Duration, Paths, Probability, Scatter, Seed, checked
from stochlin.models.buildings.shear import RegularBuilding
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground, scatter_of
from stochlin.models.structures import AnyStructure
from stochlin.models.uncertain import Uncertain, UncertainModel, median_of
from stochlin.solver.linearization.strength import strength_in_metres
from stochlin.solver.simulation.checks import checked_structures
from stochlin.solver.simulation.finite_motions import simulate_finite
from stochlin.solver.simulation.prepared import FiniteMotion, PreparedStructures
from stochlin.solver.simulation.simulation import STEPS_PER_PERIOD
from stochlin.solver.simulation.statistics import pair_separation, quantile_interval
from stochlin.solver.simulation.structures_in_motion import (
    GROUND,
    INPUT,
    structures_in_motion,
)
from stochlin.solver.tables import labels
from stochlin.solver.tables.checks import standing

# parameters of an oscillator that are part of a definition, and without influence
WITHOUT_INFLUENCE = "peak_factor", "mass"
CHANGE_OF_INPUT = 0.1  # relative change of a known input, to either side
ENDS_OF_RANGE = 0.16, 0.84  # probabilities at the ends of the range of an uncertain input
END = "end"
LOW_AND_HIGH = ("low", "high")
INPUT_TEXTS = {
    INPUT: "number of a model",
    "input_median": "the input, or its median, in its unit",
    "input_unit": "unit of the input",
    "uncertain": "1 where the input is not known exactly",
}
JACKKNIFE_GROUPS = 32  # groups of motions for the jackknife, each of which is left out once
# share of the motions, with responses nearest to the quantile, in the local regression
NEAREST_SHARE = 0.25
REGRESSION_REFERENCE = "Cleveland, W. S. (1979), J. Am. Stat. Assoc. 74."


@checked(uncertain=True, in_metres=True)
def sensitivity(
    first: AnyStructure,
    second: AnyStructure | None,
    ground: Ground,
    duration: Duration,
    *,
    envelope: Envelope | None = None,
    confidence: Probability = 0.9,
    scatter: Scatter | None = None,
    paths: Paths = 512,
    seed: Seed = 0,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Influence of each input on the gap of two buildings.

    The inputs are all numbers that describe the structures and the ground. For each input the
    result has the change of the gap of `separation` with it. All estimates are from the same
    motions.

    Parameters
    ----------
    first, second, ground
        As in `separation`, with numbers or `Uncertain` parameters. If ``second`` is None, the
        result is for the set-back of ``first``.
    duration, envelope, confidence, scatter
        As in `separation`.
    paths : int
        Number of motions. Each is simulated twice, and twice for every input.
    seed, progress
        As in `separation`.

    Returns
    -------
    xarray.Dataset
        Over ``input``, named ``"structure_1.period"`` and so on, with the coordinates
        ``input_median``, ``input_unit`` and ``uncertain``, which is 1 if the input has a spread. An
        array, such as the stiffnesses of storeys, is one input, a common factor with median 1. Also
        over ``end``: ``input_factor_at`` [-], a low and a high value of the input over its median,
        which are its 16 % and 84 % quantiles if it is uncertain, else 10 % below and above;
        ``gap_change`` [m], the change of the gap if the input is known to have this value. Without
        dimensions: ``gap`` [m] with its 95 % interval; ``gap_of_medians`` [m], with all inputs at
        their medians. Changes have standard errors.

    Raises
    ------
    ValueError, TypeError
        As in `separation`; also if a parameter is an array over the cells of a table.

    Notes
    -----
    A strength by reduction factor is converted to metres on the ground at its medians and does not
    change with the ground. A value 10 % above or below that is not allowed, such as a hardening
    above 1, is left out: its factor is 1. The ``peak_factor``, which belongs to the definition of a
    reduction factor, and the ``mass`` of an oscillator, on which the separation does not depend,
    are no inputs; nor are numbers within a sympy law or a list.

    References
    ----------
    Cleveland (1979), J. Am. Stat. Assoc. 74, for the changes of the gap.

    Examples
    --------
    >>> import stochlin as sl
    >>> old = sl.Bilinear(sl.Uncertain(0.6, 0.25), 0.05)
    >>> new, ground = sl.Bilinear(1.0, 0.05), sl.named_ground("firm", intensity=0.01)
    >>> table = sl.sensitivity(old, new, ground, 6.0, paths=32)
    >>> change = table.gap_change.sel(input="ground.intensity") / table.gap  # of a linear structure
    >>> change.values.round(3)  # the square root of 0.9 and of 1.1, less 1
    array([-0.051,  0.049])
    """
    usual = median_of(ground)
    motion = FiniteMotion(duration, envelope, scatter_of(ground, scatter), seed)
    structures = standing(first, second)
    checked_structures([*structures.values()], usual)
    roles = {
        f"structure_{n}": structure for n, structure in enumerate(structures.values(), start=1)
    }
    models = {role: described(model) for role, model in {**roles, GROUND: ground}.items()}
    inputs = [entry for role, model in models.items() for entry in inputs_of(role, model)]
    for role in roles:  # reduction factors refer to the ground at its medians
        models[role] = models[role].changed(lambda s: strength_in_metres(s, usual))
    PreparedStructures.of(structures, ground, motion, paths, 2 * (1 + len(inputs)))  # raises
    factors, responses = _responses(models, inputs, motion, paths, progress)
    table = labels.label(_table(inputs, factors, responses, confidence))
    subject = "the set-back of a building" if second is None else "the gap of two buildings"
    return labels.with_run_information(
        table.assign_attrs(
            confidence=confidence,
            paths=responses.shape[1],
            seed=seed,
            duration_s=float(duration),
            envelope="none" if envelope is None else envelope.describe(),
            **labels.of_scatter(motion.scatter),
        ),
        f"What matters for {subject}, {usual.name} ground",
        f"sensitivity(duration={duration:g}, confidence={confidence:g}, paths={paths}, "
        f"seed={seed})",
        {**structures, "ground": ground},
        REGRESSION_REFERENCE,
    )


def _responses(
    models: Mapping[str, UncertainModel],
    inputs: Sequence[Input],
    motion: FiniteMotion,
    paths: int,
    progress: Progress | None,
) -> tuple[Array, Array]:
    """Factors (inputs, 2) on the inputs, and separations (2 + 2 inputs, motions) [m] with them.

    The first separations are those of `separation`, the next those with all inputs at their
    medians. All simulations have the time step and the samples of the first.
    """
    steps: list[float] = []  # of the simulations so far
    made: dict[str, Sequence[Any]] = {}  # samples of the models in the first simulation

    def run(changes: Mapping[str, UncertainModel]) -> Array:
        present = {**models, **changes}.values()
        sampled = any(value.spread for model in present for value in model.uncertain.values())
        *structures, ground = [
            model if sampled and model.uncertain else model.median() for model in present
        ]
        others = {role: samples for role, samples in made.items() if role not in changes}
        moving = structures_in_motion(
            structures,
            ground,
            None,
            False,
            paths=paths,
            seed=motion.seed,
            made=others,
            scatter=motion.scatter,
            steps_per_period=STEPS_PER_PERIOD,
            step=steps[0] if steps else None,
        )
        if not steps:
            made.update(moving.samples)
        table = simulate_finite(moving, motion.duration, motion.envelope, (), None)
        steps.append(moving.run.plan.dt)
        if progress is not None:
            progress(len(steps) / (2 * len(inputs) + 2))
        return pair_separation(table).to_numpy()

    responses = [run({}), run({role: described(model.median()) for role, model in models.items()})]
    factors = np.ones((len(inputs), 2))
    for n, entry in enumerate(inputs):
        for side, factor in enumerate(entry.ends()):
            model = changed(models[entry.role], entry.key, 1.0)
            with suppress(ValueError):  # not allowed
                model = changed(models[entry.role], entry.key, factor)
                factors[n, side] = factor
            responses.append(run({entry.role: model}))
    return factors, np.array(responses)


def _table(
    listed: Sequence[Input], factors: Array, responses: Array, confidence: float
) -> xr.Dataset:
    base = responses[0]
    falls = float(np.isposinf(responses[:2]).mean())
    if falls or np.isposinf(responses).any():
        what = f"a structure falls in {100 * falls:.3g} % of the motions, or with a changed input"
        cure = "give it more hardening or strength, or weaker motions: separation takes it as it is"
        raise ArithmeticError(f"{what}; {cure}")
    changes, errors = changed_quantiles(base, responses[1:], confidence)
    columns = [
        [f"{entry.role}.{entry.key}" for entry in listed],
        [entry.value for entry in listed],
        [entry.units for entry in listed],
        [np.int8(entry.quantity.spread > 0) for entry in listed],
    ]
    coords: dict[str, Any] = {
        name: (INPUT, column, {"long_name": text})
        for (name, text), column in zip(INPUT_TEXTS.items(), columns, strict=True)
    }
    coords[END] = END, [*LOW_AND_HIGH], {"long_name": "end of the range of the input"}
    gaps = zip(("gap", "gap_lower", "gap_upper"), quantile_interval(base, confidence), strict=True)
    table = xr.Dataset(dict(gaps), coords)
    table["gap_of_medians"] = table.gap + changes[0]
    table["gap_of_medians_standard_error"] = errors[0]
    table["input_factor_at"] = (INPUT, END), factors
    table["gap_change"] = (INPUT, END), changes[1:].reshape(factors.shape)
    table["gap_change_standard_error"] = (INPUT, END), errors[1:].reshape(factors.shape)
    return table


def changed_quantiles(response: Array, changed: Array, level: float) -> tuple[Array, Array]:
    """Quantiles of ``changed`` responses (k, motions) minus that of ``response``, and errors (k,).

    The differences of the sorted responses are interpolated at the quantile by a local linear
    regression over ``response`` (Cleveland 1979). This has less noise than the difference of two
    quantiles, and is exact if the responses are multiples of each other. Standard errors are by the
    jackknife.
    """
    number = np.arange(response.size)
    groups = min(JACKKNIFE_GROUPS, response.size)

    def estimate(left: int) -> Array:
        """The changes without a group of the motions; -1 leaves out none."""
        rest = number % groups != left
        y = np.sort(response[rest])
        beyond = y - np.quantile(y, level)
        far = np.abs(beyond)
        width = np.sort(far)[int(np.ceil(NEAREST_SHARE * y.size)) - 1] or 1.0
        weight = np.clip(1 - (far / width) ** 3, 0, None) ** 3
        weight /= weight.sum()
        mean = (weight * beyond).sum()
        spread = (weight * (beyond - mean) ** 2).sum() or 1.0
        weight *= 1 - (beyond - mean) * mean / spread
        estimates: Array = ((np.sort(changed[:, rest], axis=1) - y) * weight).sum(axis=1)
        return estimates

    parts = np.array([estimate(left) for left in range(groups)])
    return estimate(-1), np.sqrt((groups - 1) * parts.var(axis=0))


class Input(NamedTuple):
    """An input: one number of a model, or the common factor of several numbers."""

    role: str
    key: str
    value: float  # median; 1 for a common factor
    units: str
    quantity: Uncertain  # with spread 0 if the input is known exactly

    def ends(self) -> tuple[float, float]:
        """Ends of the range over the median: quantiles of 16 and 84 %, or 10 % to either side."""
        if not self.quantity.spread:
            return 1 - CHANGE_OF_INPUT, 1 + CHANGE_OF_INPUT
        low, high = ENDS_OF_RANGE
        return float(self.quantity.factor(low)), float(self.quantity.factor(high))


def changed(model: UncertainModel, key: str, factor: float) -> UncertainModel:
    """The model with an input known to be ``factor`` times its median; other samples stay.

    Raises a ValueError if that is no value of the input.
    """
    value = model.arguments[key]
    number: Any = factor * np.asarray(median_of(value))
    if isinstance(value, Uncertain):
        number = Uncertain(number, 0.0)
    new = dataclasses.replace(model, arguments={**model.arguments, key: number})
    new.median()
    return new


def described(model: Any) -> UncertainModel:
    """The model as one with uncertain parameters, of which there may be none."""
    if isinstance(model, UncertainModel):
        return model
    fields = [field.name for field in dataclasses.fields(model) if field.init]
    return UncertainModel(type(model), {name: getattr(model, name) for name in fields})


def inputs_of(role: str, model: UncertainModel) -> list[Input]:
    """The inputs of a model: its declared parameters that are not 0, arrays as a common factor."""
    median = model.median()
    kinds = (type(median), RegularBuilding)
    inputs = []
    for key, value in model.arguments.items():
        kind = next((kind for kind in kinds if key in kind.parameter_names()), None)
        idle = key in WITHOUT_INFLUENCE and not hasattr(median, "masses")
        if kind is None or value is None or idle:
            continue
        quantity = value
        if not isinstance(value, Uncertain):
            quantity = Uncertain(np.asarray(value, float), 0.0)
        usual = getattr(median, key) if kind is type(median) else quantity.median
        one_number = np.ndim(usual) == 0
        size = float(np.asarray(usual)) if one_number else float(np.any(usual))
        if size:
            inputs.append(Input(role, key, size, kind.units(key) if one_number else "1", quantity))
    return inputs
