"""Arguments of public functions are checked before the call, by the types in their signatures."""

from __future__ import annotations

import inspect

import pytest
import sympy

import stochlin as sl
from stochlin.models.arguments import Duration, Paths, Probability, Scatter, checked, checks_of
from stochlin.models.grounds import Ground

pytestmark = pytest.mark.invariant

FUNCTIONS = {name for name in sl.__all__ if inspect.isfunction(getattr(sl, name))}
OF_A_MODEL = "its arguments are the parameters of a model, which checks them"
READS = "it reads a file, and says what is wrong with that"
BY_NAME = "it looks up a name, in many spellings"
# Public functions whose signatures declare nothing to check, and why.
UNCHECKED = {
    "rho_white_noise": OF_A_MODEL,
    "rho_effective": OF_A_MODEL,
    "critical_gap": OF_A_MODEL,
    "response_spectrum": OF_A_MODEL,
    "pseudo_energy_radius": OF_A_MODEL,
    "equivalent_coefficients": OF_A_MODEL,
    "read_hazard": OF_A_MODEL,
    "read_case": READS,
    "open_atlas": READS,
    "write_atlas": READS,
    "lookup": "it compares its points with the axes of the atlas",
    "to_at2": "it takes a record, whose samples it checks",
    "strong_part": "it takes a record, and two shares that are checked together",
    "exceedance": "it takes arrays, whose dimensions it checks",
    "stationary_covariance": "it takes the dataset of another function",
    "named_ground": BY_NAME,
    "effective_rule": BY_NAME,
    "code_rule": BY_NAME,
    "peak_factor_model": BY_NAME,
    **dict.fromkeys(
        ("ground_names", "code_rule_names", "peak_factor_names", "example_case", "example_record"),
        "it has no arguments",
    ),
}


@pytest.mark.parametrize("name", sorted(FUNCTIONS))
def test_what_a_signature_declares_is_checked(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    function = getattr(sl, name)
    plain = inspect.unwrap(function)
    monkeypatch.setitem(plain.__globals__, "sympy", sympy)  # which modules import when they need it
    assert bool(checks_of(plain)) == (name not in UNCHECKED)
    assert hasattr(function, "__wrapped__") == (name not in UNCHECKED)


def test_the_list_of_unchecked_functions_has_no_others() -> None:
    assert set(UNCHECKED) <= FUNCTIONS


@pytest.mark.parametrize("name", sorted(FUNCTIONS - set(UNCHECKED)))
def test_a_default_passes_the_checks(name: str) -> None:
    plain = inspect.unwrap(getattr(sl, name))
    parameters = inspect.signature(plain).parameters
    for _, argument, check in checks_of(plain):
        if (default := parameters[argument].default) is not inspect.Parameter.empty:
            check(argument, default)


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
        ((FIRM, -2.0), {}, ValueError, "duration = -2.0; allowed: a positive number of seconds"),
        ((FIRM, None), {}, ValueError, "duration is missing; give the length of the motion"),
        ((FIRM,), {"duration": "2"}, ValueError, "duration = '2'; allowed: a positive number of"),
        ((FIRM, 2.0, 90), {}, ValueError, "share = 90; allowed: .*; for 90 % write 0.9"),
        ((FIRM, 2.0), {"paths": 1}, ValueError, "paths = 1; allowed: a whole number from 2"),
        ((FIRM, 2.0), {"path": 2}, TypeError, "unexpected keyword argument 'path'"),
        ((FIRM,), {}, TypeError, "missing 1 required positional argument: 'duration'"),
        ((FIRM, 2.0, 0.5, 3), {}, TypeError, "takes from 2 to 3 positional arguments but 4 were"),
    ],
)
def test_a_wrong_argument_is_told_by_name(
    arguments: tuple[object, ...], options: dict[str, object], kind: type[Exception], says: str
) -> None:
    with pytest.raises(kind, match=says):
        motion(*arguments, **options)  # type: ignore[arg-type]


def test_a_name_that_is_nearly_known_is_suggested() -> None:
    with pytest.raises(ValueError, match="method = 'linearisation' is not known; did you mean 'lin"):
        sl.correlate(sl.Bilinear(1.0, 0.05), sl.Bilinear(2.0, 0.05), FIRM, "linearisation")


def test_what_cannot_be_resolved_or_told_is_loud() -> None:
    def nowhere(scatter: Unheard) -> None:  # type: ignore[name-defined]  # noqa: F821
        """A function with a type that is not there."""

    with pytest.raises(NameError, match="Unheard"):
        checked(nowhere)(0.1)  # type: ignore[no-untyped-call]

    def either(scatter: str | Scatter) -> None:
        """A function with a check of one of two kinds."""

    with pytest.raises(TypeError, match="allowed: one kind, or None"):
        checked(either)(0.1)
