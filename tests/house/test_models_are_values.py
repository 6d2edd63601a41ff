"""Models are values: equal, hashed, written, pickled and copied by what they describe."""

import copy
import dataclasses
import inspect
import pickle
import typing
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest
import sympy
import xarray as xr
from examples import example_arguments

import stochlin as sl
from stochlin.kernels.linearization.filters import Filter
from stochlin.kernels.simulation.contacts import ForceLaw
from stochlin.models.arguments import Number
from stochlin.models.contacts.elements import WithRatio
from stochlin.models.contacts.restitution import KELVIN, Relation
from stochlin.models.grounds import Ground
from stochlin.models.parameters import Model, Parameter, Range, parameter
from stochlin.models.structures import Structure
from stochlin.models.uncertain import Uncertain, UncertainModel
from stochlin.models.values import MOST_WRITTEN, ByValue

pytestmark = pytest.mark.invariant

PUBLIC = {getattr(sl, name): name for name in sl.__all__ if inspect.isclass(getattr(sl, name))}
V, Z, E = sympy.symbols("v z e")
SITES = {"site": ("site", ["a", "b", "c"]), "depth": 30.0}


@dataclass(frozen=True)
class Own(Structure):
    """A law of a user."""

    limit: Parameter = parameter("1", "limit", Range(), 1.0)

    def symbolic(self):
        v, z, limit = sympy.symbols("v z limit")
        return v - abs(v) * z / limit


@dataclass(frozen=True)
class Valley(Ground):
    """A ground of a user."""

    name: ClassVar[str] = "valley"
    width: Parameter = parameter("m", "width", Range())
    intensity: Parameter = parameter("m^2/s^3", "PSD", Range(), 1.0)

    @staticmethod
    def filter(values):
        return Filter(values["intensity"])


@dataclass(frozen=True, init=False)
class Rubber(WithRatio):
    """A contact of a user."""

    law: ClassVar[ForceLaw] = ForceLaw(exponent=1.5, damping_exponent=0.25)
    relation: ClassVar[Relation] = KELVIN


def leaves(base: type) -> Iterator[type]:
    """The classes of stochlin below this one that none of its own classes extends.

    Other tests leave classes of functions behind, until they are collected.
    """
    below = [
        kind
        for kind in base.__subclasses__()
        if kind.__module__.startswith("stochlin.") and "<locals>" not in kind.__qualname__
    ]
    for kind in below:
        yield from leaves(kind)
    if not below:
        yield base


KINDS = sorted({*leaves(ByValue)} - {UncertainModel}, key=lambda kind: kind.__name__)
OWN = [Own(1.0, 0.05, 0.1, yield_displacement=0.02), Valley(300.0), Rubber(1e8, restitution=0.6)]
SHEAR = sl.ShearBuilding([2e5] * 2, [4e8] * 2, [3.5] * 2, 0.05)
LAWS = [
    V - abs(V) * Z / 3.0,
    {"z": (V - abs(V) * Z) / (1 + 0.05 * E), "e": Z * V},
    sympy.Piecewise((V - abs(V) * Z / 7, abs(Z) < 0.3), (V - abs(V) * Z, True)),
]
MORE = [
    *(sl.Hysteretic(1.0, 0.05, 0.1, reduction_factor=2, law=law) for law in LAWS),
    *(dataclasses.replace(SHEAR, hardening=0.1, yield_drifts=0.01, law=law) for law in LAWS),
    dataclasses.replace(SHEAR, law="bouc_wen", law_parameters={"beta": 0.4, "gamma": 0.6}),
    sl.Bilinear(
        sl.Uncertain(1.0, 0.2), 0.05, sl.Uncertain.between(0.1, 0.2), reduction_factor=[2, 4]
    ),
    sl.ShearBuilding.regular(
        period=sl.Uncertain(0.8, 0.1), storeys=2, storey_height=3.2, mass=4e5, damping=0.05
    ),
    sl.named_ground("firm"),
]


def number_in(allowed: Range) -> float:
    low = max(allowed.lower, -10.0)
    return low + 0.3 * (min(allowed.upper, low + 1.0) - low)


def value_of(declared: Any) -> Any:
    """A value of a type in a signature: a number in its range, or a model."""
    for kind in (declared, *typing.get_args(declared)):
        if inspect.isclass(kind) and issubclass(kind, Model):
            return sample(min(leaves(kind), key=lambda kind: kind.__name__))
        for check in getattr(kind, "__metadata__", ()):
            if isinstance(check, Number):
                return number_in(check.allowed)
    raise AssertionError(f"no value of {declared} is known here")


@cache
def sample(kind: type) -> Any:
    """A model of this class: that of its example, or one with values in the declared ranges."""
    if kind in PUBLIC:
        return kind(**example_arguments(PUBLIC[kind], Path()))
    hints = typing.get_type_hints(kind, include_extras=True)
    needed = (field for field in dataclasses.fields(kind) if field.default is dataclasses.MISSING)  # type: ignore[arg-type]
    return kind(
        **{
            field.name: number_in(field.metadata["allowed"])
            if "allowed" in field.metadata
            else value_of(hints[field.name])
            for field in needed
        }
    )


def variants(model: Any) -> Iterator[Any]:
    """The model with an array, or an uncertain value, in place of each number that may be one."""
    arguments = model.constructor_arguments()
    for name in model.parameter_names() if isinstance(model, Model) else ():
        argument = getattr(model, "damping_name", name) if name == "damping" else name
        number = arguments.get(argument)
        if isinstance(number, float):
            table = xr.DataArray([number, np.nan, number], SITES, "site", attrs={"about": "sites"})
            for value in ([number] * 2, table, sl.Uncertain(number, 0.01)):
                try:
                    yield type(model)(**arguments | {argument: value})
                except (ValueError, TypeError):  # of what takes neither
                    assert not isinstance(model, (Structure, Ground)) or name == "mass"


def names(*kinds: type) -> dict[str, Any]:
    known = {kind.__name__: kind for kind in (*leaves(ByValue), *kinds, Uncertain)}
    return {**vars(sympy), **known, "np": np, "xr": xr}


def faults(model: Any) -> Iterator[str]:
    """What is wrong with the model as a value."""
    first = repr(model)
    others = {
        "written": eval(first, names(Own, Valley, Rubber)),
        "pickled": pickle.loads(pickle.dumps(model)),
        "copied": copy.deepcopy(model),
    }
    model.describe() if hasattr(model, "describe") else None
    if isinstance(model, Model):  # what is cached takes no part
        model.arrays()
    others["pickled later"] = pickle.loads(pickle.dumps(model))
    for how, other in others.items():
        if not (model == other and other == model and model == other):
            yield f"{how} is another: {first}"
        if hash(other) != hash(model):
            yield f"{how} has another hash: {first}"
        if repr(other) != first:
            yield f"{how} is written otherwise: {other!r}"


@pytest.mark.extreme
@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_a_model_of_every_class_is_a_value(kind: type) -> None:
    model = sample(kind)
    others = list(variants(model))
    assert [fault for each in (model, *others) for fault in faults(each)] == []
    assert all(model != other and other != model for other in others)


@pytest.mark.parametrize("model", [*OWN, *MORE], ids=lambda model: type(model).__name__)
def test_so_are_those_of_users_and_those_with_expressions_and_uncertain_numbers(model: Any) -> None:
    assert [fault for each in (model, *variants(model)) for fault in faults(each)] == []


def test_every_number_of_structures_grounds_and_contacts_is_tried_as_an_array() -> None:
    for model in OWN:
        count = sum(isinstance(value, float) for value in model.constructor_arguments().values())
        assert len([*variants(model)]) >= 2 * count


def test_what_differs_is_not_equal() -> None:
    axis = xr.DataArray([1.0, np.nan], {"period": [1.0, 2.0]}, "period")
    table = sl.Bilinear(axis, 0.05)
    for other in (
        sl.Bilinear(axis.assign_coords(period=[1.0, 3.0]), 0.05),
        sl.Bilinear(axis.rename(period="case"), 0.05),
        sl.Bilinear(axis.fillna(2.0), 0.05),
        sl.Bilinear([1.0, np.nan], 0.05),
        sl.BoucWen(axis, 0.05, beta=0.5, gamma=0.5),
        sl.Bilinear(axis, 0.06),
        1.0,
    ):
        assert table != other
    assert table == sl.Bilinear(axis.copy(), 0.05)
    assert len({table, sl.Bilinear(axis.copy(), 0.05), sl.Bilinear(1.0, 0.05)}) == 2
    assert sl.Bilinear([1, 2], 0.05) == sl.Bilinear(np.array([1.0, 2.0]), 0.05)
    firm = sl.named_ground("firm")
    assert (
        dataclasses.replace(firm, source="") == firm
    )  # where numbers are from describes no motion


def test_a_large_table_is_not_written_out_and_python_does_not_take_what_is() -> None:
    several = sl.Bilinear(np.linspace(0.5, 1.0, MOST_WRITTEN), 0.05)
    assert eval(repr(several), names()) == several
    large = sl.Bilinear(np.linspace(0.5, 1.0, MOST_WRITTEN + 1), 0.05)
    assert repr(large) == "Bilinear(period=<array over case: 1001>, damping=0.05)"
    with pytest.raises(SyntaxError):
        eval(repr(large), names())


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (
            sl.Kelvin,
            "Kelvin: missing a required argument: 'stiffness'; allowed: stiffness, damp",
        ),
        (
            lambda: sl.Kelvin(1e8, 0.1),
            "Kelvin: too many positional arguments; allowed: stiffness, damping",
        ),
        (
            lambda: sl.Kelvin(1e8, damping=0.1),
            "Kelvin: damping is no argument; did you mean 'damping_rat",
        ),
        (
            lambda: sl.Bilinear(sl.Uncertain(1.0, 0.1)),
            "Bilinear: missing a required argument: 'damping'",
        ),
        (
            lambda: sl.Bilinear(1.0, 0.05, period=1.0),
            "Bilinear: multiple values for argument 'period'",
        ),
        (
            lambda: sl.KanaiTajimi(1.0, sl.Uncertain(0.3, 0.1), depth=""),
            "KanaiTajimi: depth is no argument",
        ),
        (Rubber, "Rubber: missing a required argument: 'stiffness'"),
    ],
)
def test_a_wrong_call_is_refused_in_the_name_of_the_class(wrong: Any, message: str) -> None:
    with pytest.raises(TypeError) as refused:
        wrong()
    assert str(refused.value).startswith(message)
    assert str(refused.value).isprintable()
