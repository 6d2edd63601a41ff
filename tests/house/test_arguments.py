"""Arguments of public functions are checked before the call, by the types in their signatures."""

from __future__ import annotations

import inspect
import re
import typing
from collections.abc import Callable
from typing import Any, Literal

import pytest
import sympy
import xarray as xr
from matplotlib.figure import Figure

import stochlin as sl
from stochlin.models.arguments import (
    Duration,
    Paths,
    Probability,
    checked,
    checks_of,
)
from stochlin.models.grounds import Ground
from stochlin.solver.correlation.correlation import ANSWERS_BY_METHOD, Method

pytestmark = pytest.mark.invariant

PUBLIC = {
    f"{module.__name__}.{name}": each
    for module in (sl, sl.charts, sl.rules)
    for name in dir(module)
    if callable(each := getattr(module, name)) and name[0] != "_"
    if not (inspect.isclass(each) and issubclass(each, Warning))
}


def test_every_closure_is_by_default_that_of_the_paper_and_the_charts() -> None:
    parameters = [inspect.signature(each).parameters for each in PUBLIC.values()]
    # with the drift
    in_time = {f"stochlin.pounding_{name}" for name in ("probability", "fragility")}
    of_others = [each for name, each in zip(PUBLIC, parameters, strict=True) if name not in in_time]
    assert {each["closure"].default for each in of_others if "closure" in each} == {"gaussian"}
    building = sl.Bilinear(0.5, 0.05, 0.05, reduction_factor=4)
    fig_5b = float(sl.amplification(building, sl.KanaiTajimi(2.0, 0.05)).amplification)
    assert fig_5b == pytest.approx(2.18, abs=0.01)


@checked
def motion(
    ground: Ground, duration: Duration, share: Probability = 0.5, *, paths: Paths | None = None
) -> tuple[float, float]:
    """A function with some arguments."""
    return duration, share


SITE = sl.WhiteNoise(0.01)


def test_the_signature_stays() -> None:
    assert list(inspect.signature(motion).parameters) == ["ground", "duration", "share", "paths"]
    assert motion(SITE, 2.0) == motion(ground=SITE, duration=2.0, paths=None) == (2.0, 0.5)
    assert motion.__name__ == "motion"


WRONG = [
    ((1.0, 2.0), {}, TypeError, "ground = 1.0 is of the wrong kind; allowed: CloughPenzien, "),
    (
        (SITE,),
        {"duration": "2"},
        ValueError,
        "duration = '2' is no number; allowed: a positive, finite",
    ),
    (
        (SITE, 2.0, 90),
        {},
        ValueError,
        "share = 90 is out of range; allowed: .*; for 90 % write 0.9",
    ),
    ((SITE, 2.0), {"path": 2}, TypeError, "path is no argument; did you mean 'paths'"),
    (
        (SITE, 2.0),
        {"paths": 0},
        ValueError,
        "paths = 0 is out of range; allowed: a whole number from",
    ),
    (
        (SITE, 2.0),
        {"paths": 2.5},
        ValueError,
        "paths = 2.5 is no whole number; allowed: a whole number",
    ),
    ((SITE, 2.0), {"paths": True}, ValueError, "paths = True is no whole number; allowed: a whole"),
    ((SITE, 10**400), {}, ValueError, "duration = about 1e400 is no number; allowed: a positive"),
    ((SITE,), {}, TypeError, "missing 1 required positional argument: 'duration'"),
    ((SITE, 2.0, 0.5, 3), {}, TypeError, "takes from 2 to 3 positional arguments but 4 were"),
]


@pytest.mark.parametrize(("arguments", "options", "kind", "says"), WRONG)
def test_a_wrong_argument_is_named_with_what_is_allowed(
    arguments: tuple[object, ...], options: dict[str, object], kind: type[Exception], says: str
) -> None:
    with pytest.raises(kind, match=says):
        motion(*arguments, **options)  # type: ignore[arg-type]


def test_defaults_of_public_functions_pass_their_checks(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, public in PUBLIC.items():
        if not inspect.isfunction(public) or "draw" in name:
            continue
        plain = inspect.unwrap(public)
        for later in (sympy, Figure):  # which modules import when they need it
            monkeypatch.setitem(plain.__globals__, later.__name__, later)
        parameters = inspect.signature(plain).parameters
        for argument, check in checks_of(plain):
            if (default := parameters[argument].default) is not inspect.Parameter.empty:
                check(argument, default)


def literals(public: Callable[..., object]) -> dict[str, tuple[object, ...]]:
    """The words that the types of a public call list, by argument, without those of open lists."""
    later = {"sympy": sympy, "Figure": Figure, "xr": xr}  # imported where they are needed
    hints = typing.get_type_hints(public, localns=later, include_extras=True)
    parts = {
        name: (hint, *typing.get_args(hint)) for name, hint in hints.items() if name != "return"
    }
    listed = {
        name: sum((typing.get_args(each) for each in of if typing.get_origin(each) is Literal), ())
        for name, of in parts.items()
        if str not in of
    }
    return {name: words for name, words in listed.items() if words}


def test_the_words_of_a_type_are_those_that_are_checked() -> None:
    functions = {
        name: getattr(sl, name) for name in sl.__all__ if hasattr(getattr(sl, name), "__wrapped__")
    }
    listed = {name: literals(each) for name, each in functions.items()}
    listed = {name: words for name, words in listed.items() if words}
    assert len(listed) >= 9
    for name, arguments in listed.items():
        checks: dict[str, Any] = dict(checks_of(inspect.unwrap(functions[name])))
        for argument, words in arguments.items():
            for word in words:
                checks[argument](argument, word)
            with pytest.raises(
                ValueError, match=f"{argument} = 'neither' is not known; allowed: {words[0]}"
            ):
                checks[argument](argument, "neither")
    assert {*typing.get_args(Method)} == {*ANSWERS_BY_METHOD}


def test_an_unknown_argument_is_answered_with_the_nearest() -> None:
    for called in (*PUBLIC.values(), sl.ShearBuilding.regular, sl.ModalBuilding.from_table):
        every = inspect.signature(called).parameters.values()
        named = [each for each in every if each.kind not in (each.VAR_POSITIONAL, each.VAR_KEYWORD)]
        if not named or called is sl.equivalent_coefficients:  # which has those of any law
            continue
        argument = max((each.name for each in named), key=len)
        needed = {each.name: None for each in named if each.default is each.empty}
        needed.pop(argument, None)
        with pytest.raises(
            TypeError, match=f"{argument}_ is no argument; did you mean '{argument}'"
        ):
            called(**needed, **{f"{argument}_": None})


def test_messages_name_the_functions_that_take_uncertain_models() -> None:
    uncertain = sl.KanaiTajimi(sl.Uncertain(0.5, 0.1), 0.3, 0.01)
    takers, said = set(), ""
    for name in sl.__all__:
        function = getattr(sl, name)
        if inspect.isfunction(function) and "ground" in inspect.signature(function).parameters:
            with pytest.raises(TypeError) as caught:
                function(ground=uncertain)
            refused = "without uncertain parameters" in str(caught.value)
            said = str(caught.value) if refused else said
            takers |= set() if refused else {name}
    named = said.partition("so give its median(); ")[2].partition(" with a duration")[0]
    assert {*re.split(r",? and |, (?!and)", named)} == takers


@checked(uncertain=True, in_metres=True)
def shaken(ground: Ground) -> tuple[Any, sl.KanaiTajimi]:
    """The ground, and one that nobody has."""
    return ground, sl.KanaiTajimi(500.0, 0.3)


def test_a_function_declares_what_it_takes_and_gives_and_asks_for_what_it_is_given_alone() -> None:
    uncertain: Any = sl.WhiteNoise(sl.Uncertain(0.01, 0.1))
    assert shaken(uncertain)[0] is uncertain
    with pytest.raises(TypeError, match="without uncertain parameters"):
        motion(uncertain, 2.0)
    with pytest.warns(sl.ImplausibleInput) as caught:
        shaken(sl.WhiteNoise(1.0))
    assert [str(each.message).partition(":")[0] for each in caught] == ["shaken"]
    with pytest.warns(sl.ImplausibleInput, match="KanaiTajimi: period = 500"):
        sl.KanaiTajimi(500.0, 0.3)


def test_messages_list_a_class_from_which_an_extension_derives_one() -> None:
    class Softer(sl.KanaiTajimi):
        """Inside stochlin or outside."""

    Softer.__module__ = sl.KanaiTajimi.__module__
    with pytest.raises(TypeError, match=r"allowed: .*KanaiTajimi, "):
        motion(1.0, 2.0)  # type: ignore[arg-type]
