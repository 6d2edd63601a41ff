"""Arguments of public functions are checked before the call, by the types in their signatures."""

from __future__ import annotations

import inspect
from collections.abc import Callable

import numpy as np
import pytest
import sympy
import xarray as xr
from matplotlib.figure import Figure

import stochlin as sl
from stochlin.models.arguments import (
    Check,
    Duration,
    Number,
    Paths,
    Probability,
    Scatter,
    Whole,
    checked,
    checks_of,
    fitting,
)
from stochlin.models.grounds import Ground
from stochlin.models.parameters import POSITIVE

pytestmark = pytest.mark.invariant

PUBLIC = {
    f"{module.__name__}.{name}": each
    for module in (sl, sl.charts, sl.rules)
    for name in dir(module)
    if callable(each := getattr(module, name)) and name[0] != "_" and name != "missing"
}
CONSTRUCTORS = {
    "ShearBuilding.regular": sl.ShearBuilding.regular,
    "ModalBuilding.from_table": sl.ModalBuilding.from_table,
}
CHECKED = [name for name, each in PUBLIC.items() if inspect.isfunction(each) and "draw" not in name]


@pytest.mark.parametrize("name", CHECKED)
def test_a_default_passes_the_checks(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    plain = inspect.unwrap(PUBLIC[name])
    for later in (sympy, Figure):  # which modules import when they need it
        monkeypatch.setitem(plain.__globals__, later.__name__, later)
    parameters = inspect.signature(plain).parameters
    for argument, check in checks_of(plain):
        if (default := parameters[argument].default) is not inspect.Parameter.empty:
            check(argument, default)


@pytest.mark.parametrize("name", [*PUBLIC, *CONSTRUCTORS])
def test_an_unknown_argument_is_answered_with_the_nearest(name: str) -> None:
    called = {**PUBLIC, **CONSTRUCTORS}[name]
    parameters = inspect.signature(called).parameters.values()
    own = [each for each in parameters if each.kind not in (each.VAR_POSITIONAL, each.VAR_KEYWORD)]
    if not own or called is sl.equivalent_coefficients:  # which has those of any law, and checks them
        return
    needed = {each.name: None for each in own if each.default is each.empty}
    argument = max((each.name for each in own), key=len)
    needed.pop(argument, None)
    with pytest.raises(TypeError, match=f"{argument}_ is no argument; did you mean '{argument}'"):
        called(**needed, **{f"{argument}_": None})


def test_every_closure_is_by_default_that_of_the_paper_and_the_charts() -> None:
    parameters = [inspect.signature(each).parameters for each in PUBLIC.values()]
    assert {each["closure"].default for each in parameters if "closure" in each} == {"gaussian"}
    building = sl.Bilinear(0.5, 0.05, 0.05, reduction_factor=4)
    fig_5b = float(sl.amplification(building, sl.KanaiTajimi(2.0, 0.05)).amplification)
    assert fig_5b == pytest.approx(2.18, abs=0.01)


@checked
def motion(
    ground: Ground, duration: Duration, share: Probability = 0.5, *, paths: Paths | None = None
) -> tuple[float, float]:
    """A function with some arguments."""
    return duration, share


FIRM = sl.WhiteNoise(0.01)


def test_the_signature_stays() -> None:
    assert list(inspect.signature(motion).parameters) == ["ground", "duration", "share", "paths"]
    assert motion(FIRM, 2.0) == motion(ground=FIRM, duration=2.0, paths=None) == (2.0, 0.5)
    assert motion.__name__ == "motion"


@pytest.mark.parametrize(
    ("arguments", "options", "kind", "says"),
    [
        ((1.0, 2.0), {}, TypeError, "ground = 1.0 is of the wrong kind; allowed: CloughPenzien, "),
        (
            (FIRM,),
            {"duration": "2"},
            ValueError,
            "duration = '2' is no number; allowed: a positive, finite number of",
        ),
        ((FIRM, 2.0, 90), {}, ValueError, "share = 90 is out of range; allowed: .*; for 90 % write 0.9"),
        ((FIRM, 2.0), {"path": 2}, TypeError, "path is no argument; did you mean 'paths'"),
        ((FIRM,), {}, TypeError, "missing 1 required positional argument: 'duration'"),
        ((FIRM, 2.0, 0.5, 3), {}, TypeError, "takes from 2 to 3 positional arguments but 4 were"),
    ],
)
def test_a_wrong_argument_is_told_by_name(
    arguments: tuple[object, ...], options: dict[str, object], kind: type[Exception], says: str
) -> None:
    with pytest.raises(kind, match=says):
        motion(*arguments, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("check", "value", "says"),
    [
        (Whole(2), 1, "is out of range; allowed: a whole number from 2 on"),
        (Whole(2), 2.5, "is no whole number; allowed: a whole number from 2 on"),
        (Whole(2), True, "is no whole number; allowed: a whole number from 2 on"),
        (Whole(1, 2), 3, "is out of range; allowed: 1 or 2"),
        (Whole(0), 2**63, f"is out of range; allowed: a whole number from 0 to {2**63 - 1}"),
        (Number(POSITIVE), 10**400, "is no number; allowed: 0 < value, finite"),
    ],
)
def test_the_range_is_told_once_with_what_is_wrong(check: Check, value: object, says: str) -> None:
    with pytest.raises(ValueError, match=f"^n = .* {says}") as caught:
        check("n", value)
    assert str(caught.value).count("whole number from") <= 1


def test_whole_numbers_beyond_64_bits_are_numbers() -> None:
    Number(POSITIVE)("n", 10**300)
    Number(POSITIVE)("n", 10**30)


def test_an_uncertain_number_is_told_as_it_was_given() -> None:
    one, two = sl.Bilinear(1.0, 0.05), sl.Bilinear(0.6, 0.05)
    uncertain = sl.Uncertain(1.0, 0.2)
    with pytest.raises(TypeError, match=r"envelope = 1 ± 20 % is of the wrong kind"):
        sl.existing_gap(one, two, FIRM, 10.0, 0.1, envelope=uncertain)  # type: ignore[arg-type]


TIME = xr.DataArray(np.zeros(400), dims="time", coords={"time": 0.01 * np.arange(400)})
PAIR = sl.Bilinear(1.0, 0.05), sl.Bilinear(0.6, 0.05)


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (
            lambda any_: sl.fit_ground(TIME, envelope=any_),
            "envelope = .* does not apply: target is a record",
        ),
        (
            lambda any_: sl.fit_ground(TIME, filters=any_),
            "filters = .* does not apply: target is a record",
        ),
        (
            lambda any_: sl.fit_ground(sl.eurocode_8(2.0, "B"), part=any_),
            "part = .* does not apply: target is a spectrum",
        ),
        (
            lambda any_: sl.amplification(PAIR[0], FIRM, envelope=any_),
            "leave them out, or ask for of='peak'",
        ),
        (
            lambda any_: sl.pounding_probability(*PAIR, FIRM, 0.1, method="hybrid", envelope=any_),
            "envelope and duration do not go with method='hybrid'",
        ),
    ],
    ids=["envelope of a record", "filters of a record", "part of a spectrum", "std", "hybrid"],
)
def test_what_has_to_be_left_out_is_told_before_what_is_wrong_with_it(
    call: Callable[[object], object], says: str
) -> None:
    """Whether its value could be allowed elsewhere or not."""
    for value in ("amin_ang", sl.GammaEnvelope(1.0, 0.5)):
        with pytest.raises(ValueError, match=says):
            call(value)


def test_what_is_fitting_is_checked_as_given() -> None:
    def check(method: object, options: object, paths: object) -> None:
        seen.append((method, options, paths))

    @fitting(check)
    @checked
    def function(method: str, options: str = "usual", *, paths: Paths = 2) -> str:
        """A function with arguments of all kinds."""
        return method

    seen: list[tuple[object, ...]] = []
    assert function("one") == function(method="one", options="two", paths=3) == "one"
    assert seen == [("one", "usual", 2), ("one", "two", 3)]
    with pytest.raises(TypeError, match="missing 1 required positional argument: 'method'"):
        function()  # type: ignore[call-arg]


def test_what_cannot_be_resolved_or_told_is_loud() -> None:
    def nowhere(scatter: Unheard) -> None:  # type: ignore[name-defined]  # noqa: F821
        """A function with a type that is not there."""

    with pytest.raises(NameError, match="Unheard"):
        checked(nowhere)(0.1)  # type: ignore[no-untyped-call]

    def either(scatter: str | Scatter) -> None:
        """A function with a check of one of two kinds."""

    with pytest.raises(TypeError, match="allowed: one kind, or None"):
        checked(either)(0.1)
