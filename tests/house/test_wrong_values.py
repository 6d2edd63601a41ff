"""Every public call refuses wrong values, and answers or refuses any structure, in a short line."""

import inspect
import re
import warnings
from collections.abc import Callable, Mapping
from functools import cache
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sympy
import xarray as xr
from cases import with_slow
from examples import example_arguments

import stochlin as sl

pytestmark = pytest.mark.invariant

LONGEST = 500  # characters, with the list of what is allowed
TIME = 0.02 * np.arange(200)
RECORD = xr.DataArray(
    np.sin(9 * TIME) * np.exp(-TIME), dims="time", coords={"time": TIME}, attrs={"units": "m/s^2"}
)
V, Z = sympy.symbols("v z")

WRONG: dict[str, Any] = {
    "nothing": None,
    "text": "one",
    "bytes": b"1",
    "truth": True,
    "complex": 1 + 1j,
    "NaN": float("nan"),
    "infinite": float("inf"),
    "minus infinity": -float("inf"),
    "negative": -1.0,
    "zero": 0,
    "beyond floats": 10**400,
    "list": [1.0, "a"],
    "truths": [True],
    "ragged": [[1.0], [1.0, 2.0]],
    "empty list": [],
    "mapping": {"a": 1.0},
    "empty array": np.array([]),
    "plane": np.ones((2, 2)),
    "objects": np.array([None, "a"], dtype=object),
    "long array": np.full(2_000, -1.0),
    "long text": "x" * 200_000,
    "escape": "\x1b[2J\n",
    "dataset": xr.Dataset({"a": ("x", np.ones(3))}),
    "dates": xr.DataArray(np.array(["2000-01-01"], dtype="datetime64[ns]"), dims="x"),
    "ground": sl.KanaiTajimi(1.0, 0.3),
    "class": sl.Kelvin,
    "function": len,
}
ROWS = {"long array"}  # each cell of which has a status of its own
# What these take of it, a parameter of any or of one; all others refuse it.
TAKEN: dict[str, set[str]] = {
    "nothing": {"links", "second"},
    "text": {"component"},
    "truth": {
        "elastic",
        "floors_align",
        "p_delta",
        "same_property",
        "same_system",
        "skip_unreadable",
    },
    "infinite": {"exceedance.gap"},
    "minus infinity": {"exceedance.gap"},
    "negative": {
        *("critical_gap.rho", "exceedance.gap"),
        *("Start.displacement", "Start.velocity", "Start.ground_velocity"),
    },
    "zero": {
        *("component", "hardening", "peak_1", "peak_2", "BoucWen.gamma", "Flag.beta"),
        *(
            "BoucWenBaberNoori.pinching_start",
            "BoucWenBaberNoori.pinching_spread",
            "critical_gap.rho",
        ),
        *("equivalent_coefficients.velocity_z_corr", "eurocode_8.damping", "pound.gaps"),
        *("exceedance.gap", "scatter"),
        *("pounding_fragility.paths", "pounding_probability.paths"),  # the formula alone
        *("ModifiedClough.unloading_exponent", "pounding_estimate.gap", "ShearBuilding.dampers"),
        *("Stereomechanical.restitution", "Uncertain.spread"),
    },
    "beyond floats": {"component"},
    "empty list": {"growing_states", "link", "links", "points"},
    "ground": {"ground"},
    "dataset": {"as_dictionary.dataset"},
}
ANYTHING = {
    *("source", "Uncertain.median"),  # words for readers; a parameter of a model, which checks it
}
# These decide how long a call lasts: what is allowed of them is tested elsewhere.
LASTING = {"relaxation_times", "progress", "scheduler"}
INNER = re.compile(
    r"YieldingPair|LinearPair|CorrelatedPeaks|DuctilityTarget|StationaryMotion|0x[0-9a-f]{6}"
)


SMOOTH = {"hardening": 0.1, "law": "bouc_wen", "law_parameters": {"beta": 0.6}}
# Beside the arguments of their examples, for what these leave out, and for a call that does not
# last.
OWN: dict[str, dict[str, Any]] = {
    "Link": {"damping_exponent": 0.5, "hardening": 0.1, "yield_displacement": 0.01},
    "ShearBuilding": SMOOTH | {"yield_drifts": 0.01, "dampers": 1e5, "damping_modes": (1, 2)},
    "ModalBuilding": SMOOTH | {"yield_displacements": 0.01},
    "amplification": {"of": "peak", "duration": 3.0},
    "fit_motion": {"filters": 1},
}


CALLED = {name: thing for name in sl.__all__ if callable(thing := getattr(sl, name))}
NAMES = [
    n for n, thing in CALLED.items() if not (inspect.isclass(thing) and issubclass(thing, Warning))
]
NAMES += ["ShearBuilding.regular"]
LONG = {
    *(
        "code_gaps",
        "correlate",
        "damping_for_gap",
        "simulate",
        "existing_gap",
        "fit_ground",
        "fit_motion",
        "mitigate",
    ),
    *("pound", "pounding_estimate"),
    *("pounding_fragility", "pounding_probability", "pounding_risk", "required_gap", "sensitivity"),
    "separation",
}
# said in its place
ALSO = {"name": "name_rule_model", "yield_displacement": "yield_strength_hardening"}
ALSO |= {"reduction_factor": "reduction_strength_hardening", "structure": "structure_strength"}
ALSO |= {"wrapped": "wrapped_dt", "path": "path_case"}


def complaint(call: Callable[..., Any], passed: Mapping[str, Any]) -> BaseException | None:
    """What the call raises; None if it takes all that."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            call(**passed)
    except (Exception, SystemExit) as error:
        return error
    return None


def arguments(name: str, folder: Path) -> dict[str, Any]:
    """As in the example of the reference, with some that it leaves out."""
    return example_arguments(name, folder) | OWN.get(name, {})


def is_usual(value: Any, about: inspect.Parameter) -> bool:
    """Whether the call is as without the value: nothing then is wrong."""
    number = isinstance(value, int) and not isinstance(value, bool)
    return value is about.default or (number and value == about.default)


def is_taken(kind: str, name: str, parameter: str) -> bool:
    """Whether the value is allowed of this parameter."""
    of_kind = ANYTHING | TAKEN.get(kind, set())
    return kind in ROWS or not of_kind.isdisjoint({parameter, f"{name}.{parameter}"})


def unfit(error: BaseException | None, parameter: str) -> str:
    """What is wrong with how an error says it."""
    said = "" if error is None else str(error)
    words = [word.rstrip("s")[:6] for word in (ALSO.get(parameter, parameter)).split("_")]
    faults = {
        "is of a kind that nobody expects": not isinstance(
            error, (ValueError, TypeError, ArithmeticError, OSError, type(None))
        ),
        "is long": len(said) > LONGEST,
        "is not one line": bool(said) and not said.isprintable(),
        "has a name from within": bool(INNER.search(said)),
        "does not name the parameter": bool(said)
        and not isinstance(error, OSError)
        and "parameters" not in said  # of a table
        and not any(word in said for word in words),
    }
    return ", ".join(fault for fault, found in faults.items() if found)


@pytest.mark.parametrize("name", with_slow(NAMES, LONG))
def test_what_is_wrong_is_said_in_a_line_that_names_the_parameter(
    name: str, tmp_path: Path
) -> None:
    call = attrgetter(name)(sl)
    parameters = inspect.signature(call).parameters
    passed = arguments(name, tmp_path)
    if "paths" in parameters:
        passed["paths"] = 16
    assert complaint(call, passed) is None
    said = []
    for parameter, about in parameters.items():
        if parameter in LASTING or about.kind in (about.VAR_KEYWORD, about.VAR_POSITIONAL):
            continue
        for kind, value in WRONG.items():
            if is_usual(value, about):
                continue
            error = complaint(call, passed | {parameter: value})
            fault = unfit(error, parameter)
            if error is None and not is_taken(kind, name, parameter):
                fault = "is not refused"
            if fault:
                said.append(
                    f"{parameter}, {kind}: {fault}: {type(error).__name__} {str(error)[:200]!r}"
                )
    assert not said, "\n".join(said)


# --- Structures of every kind
# -------------------------------------------------------------------------


def oscillators(kind: Any, **law: Any) -> tuple[Any, Any]:
    first, second = (
        kind(T, 0.05, 0.05, yield_displacement=5e-4, mass=1e5, **law) for T in (0.1, 0.14)
    )
    return first, second


def shear(law: Any) -> tuple[Any, Any]:
    strength = {"hardening": 0.3, "yield_drifts": 0.001, "law": law}
    first, second = (
        sl.ShearBuilding([1e5] * n, [1e9] * n, [3.0] * n, 0.05, **strength)  # type: ignore[arg-type]
        for n in (2, 3)
    )
    return first, second


def by_modes(storeys: int) -> sl.ModalBuilding:
    """A uniform chain of these storeys by its modes, in closed form; the first one yields."""
    phase = (2 * np.arange(1, storeys + 1) - 1) * np.pi / (4 * storeys + 2)
    shapes = np.sin(2 * phase[:, None] * np.arange(1, storeys + 1))
    chain = np.pi / (100 * np.sin(phase)), shapes, [1e5] * storeys, [3.0] * storeys
    return sl.ModalBuilding(*chain, 0.05, hardening=0.3, yield_displacements=0.001)


@cache
def kinds() -> list[tuple[Any, Any]]:
    """Pairs of every kind and law, the bilinear one first."""
    own, worn = V - (abs(V) * Z + V * abs(Z)) / 2, {"strength_decay": 0.02, "pinching": 0.9}
    pairs = [oscillators(each) for each in (sl.Bilinear, sl.BoucWen, sl.ModifiedClough, sl.Flag)]
    pairs += [oscillators(sl.Hysteretic, law=own), oscillators(sl.BoucWenBaberNoori, **worn)]
    pairs += [shear(law) for law in ("bilinear", "bouc_wen", "modified_clough", own)]
    return [*pairs, (by_modes(2), by_modes(3)), (pairs[0][0], shear("bilinear")[1])]


GROUNDS = (
    sl.KanaiTajimi(0.2, 0.6, 0.01),
    sl.WhiteNoise(0.01),
    sl.CloughPenzien(0.2, 0.6, 1.0, 0.6, 0.01),
)
SIZES = {"duration": 0.15, "paths": 16, "relaxation_times": 1.0, "points": 5}
WAYS: dict[str, list[dict[str, Any]]] = {
    "linearize": [{"closure": "clipped"}, {"closure": "drift"}],
    "correlate": [
        {"closure": "drift"},
        *({"method": name} for name in ("white_noise", "effective", "simulation")),
    ],
    "linearize_system": [{"links": [sl.Link(1e6, 1e5)]}],
    "simulate": [{"link": sl.Link(1e6, 1e5)}],
    "pounding_probability": [
        {"method": "hybrid", "record": RECORD[:20], "duration": None, "envelope": None}
    ],
    "separation": [{"second": None}, {"records": {"a": RECORD[:20]}}],
    "sensitivity": [{"second": None}],
    "pound": [{"link": sl.Link(1e6, 1e5)}],
    "code_gaps": [{"peak_1": None, "peak_2": None, "spectrum": sl.eurocode_8(2.0, "B")}],
}
OF_PAIR: dict[str, Callable[[Any, Any], Any]] = {
    **dict.fromkeys(("structure", "first", "modes_1"), lambda first, second: first),
    **dict.fromkeys(("second", "modes_2"), lambda first, second: second),
    "structures": lambda first, second: [first, second],
}
OF_STRUCTURES = [
    name
    for name in NAMES
    if inspect.isfunction(call := attrgetter(name)(sl))
    and OF_PAIR.keys() & inspect.signature(call).parameters
]


@pytest.mark.slow
@pytest.mark.parametrize("name", OF_STRUCTURES)
def test_structures_of_any_kind_are_answered_or_refused_in_words(name: str, tmp_path: Path) -> None:
    call, passed = attrgetter(name)(sl), arguments(name, tmp_path)
    parameters = inspect.signature(call).parameters
    short = {key: value for key, value in SIZES.items() if key in parameters}
    short |= {"record": RECORD[:20]} if "record" in passed else {}
    pairs = [(pair, GROUNDS[0]) for pair in kinds()] + [
        (kinds()[0], ground) for ground in GROUNDS[1:]
    ]
    said = []
    for way in [{}, *WAYS.get(name, [])]:
        for pair, ground in pairs:
            here = {
                key: of(*pair)
                for key, of in OF_PAIR.items()
                if key in passed or key[:-1] == "modes_"
            }
            here |= {"ground": ground} if "ground" in passed else {}
            tried = passed | short | here | way
            error = complaint(
                call, {key: value for key, value in tried.items() if key in parameters}
            )
            words = "" if error is None else str(error)
            fine = any(word in words for word in ("allowed", "give", "write", "follow"))
            if error is not None and not (fine and words.isprintable() and len(words) <= LONGEST):
                said.append(f"{way}, {[type(each).__name__ for each in pair]}: {error!r}")
    assert not said, "\n".join(said)
