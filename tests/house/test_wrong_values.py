"""Every public call with wrong values, and every kind of structure: an answer, or one short line."""

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
from cases import example_case, with_slow

import stochlin as sl

pytestmark = pytest.mark.invariant

SPECTRUM = "0 .4\n.1 .8\n.2 1\n.4 1\n.8 .5\n1.6 .25"
LONGEST = 500  # characters, with the list of what is allowed
TIME = 0.02 * np.arange(200)
RECORD = xr.DataArray(
    np.sin(9 * TIME) * np.exp(-TIME), dims="time", coords={"time": TIME}, attrs={"units": "m/s^2"}
)
ROOF = xr.DataArray([0.0, 0.01, 0.03, 0.06], dims="displacement", attrs={"units": "m"})
PUSHOVER = xr.DataArray(
    [0.0, 5e5, 7e5, 7.5e5], coords={"displacement": ROOF}, dims="displacement", attrs={"units": "N"}
)
V, Z = sympy.symbols("v z")

WRONG: dict[str, Any] = {
    "nothing": None,
    "text": "one",
    "truth": True,
    "complex": 1 + 1j,
    "NaN": float("nan"),
    "infinite": float("inf"),
    "negative": -1.0,
    "zero": 0,
    "beyond floats": 10**400,
    "list": [1.0, "a"],
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
# These decide how long a call lasts: what is allowed of them is tested elsewhere.
LASTING = {"paths", "max_iterations", "relaxation_times", "progress", "scheduler"}
INNER = re.compile(
    r"YieldingPair|LinearPair|CorrelatedPeaks|DuctilityTarget|StationaryMotion|0x[0-9a-f]{6}"
)


@cache
def usual() -> Mapping[str, Any]:
    """A value of every parameter that has no default, by its name."""
    ground = sl.KanaiTajimi(1.0, 0.3, 0.01)
    first, second = (sl.Bilinear(T, 0.05, 0.05, yield_displacement=0.02, mass=1e6) for T in (0.6, 1.0))
    pairs = {f"{name}_{n}": value for n in (1, 2) for name, value in SINGLE.items()}
    models = {
        "structure": first,
        "first": first,
        "second": second,
        "structures": [first, second],
        "ground": ground,
    }
    contact = sl.Kelvin(1e8, restitution=0.6)
    return {
        **SINGLE,
        **pairs,
        **models,
        "record": RECORD,
        "motion": RECORD,
        "contact": contact,
        "gaps": [0.05],
        "link": sl.Link(damping_constant=1e5),
        "measures": {"dampers": sl.Measure(added_damping_1=0.1)},
        "time": [0.0, 1.0, 2.0],
        "samples": xr.DataArray(np.linspace(0, 1, 20), dims="path"),
        "intensities": [0.01, 0.02],
        "intensity": [0.01, 0.02],
        "law": V - abs(V) * Z,
        "envelope": sl.AminAng(1.0, 2.0, 0.5),
        "model": "amin_ang",
        "c_eq": [-1.0, -1.0],
        "k_eq": [0.0, 0.0],
        "space": sl.statespace([sl.Bilinear(1.0, 0.05)], ground, [-1.0], [0.0]),
        "frequency": [1.0, 2.0],
        "records": {"a": RECORD, "b": RECORD},
        "grounds": [ground, sl.KanaiTajimi(0.4, 0.6, 0.01)],
    }


SINGLE = {
    "period": 0.8,
    "damping": 0.05,
    "hardening": 0.05,
    "ductility": 3.0,
    "peak": 0.1,
    "rho": 0.5,
    "gap": 0.05,
    "duration": 3.0,
    "rise_end": 1.0,
    "strong_end": 2.0,
    "decay": 0.5,
    "slow": 0.1,
    "fast": 1.0,
    "power": 2.0,
    "stiffness": 1e8,
    "restitution": 0.6,
    "high_pass_period": 5.0,
    "high_pass_damping": 0.6,
    "masses": [1e5],
    "stiffnesses": [1e8],
    "heights": [3.0],
    "approach_velocity": 0.5,
    "velocity_std": 1.0,
    "z_std": 0.5,
    "velocity_z_corr": 0.3,
    "mass": 1e5,
    "name": "firm",
    "displacement": [0.03, -0.03],
}
DASHPOTS = ("HertzDamp", "ImpactKelvin", "Jankowski", "Kelvin", "NoTensionKelvin")
HAZARD = sl.HazardCurve([0.1, 8.0], [0.01, 1e-3])
OWN: dict[str, dict[str, Any]] = {
    "Hysteretic": {"hardening": 0.1, "reduction_factor": 4, "law": V - abs(V) * Z},
    "read_record": {"dt": 0.02, "units": "g"},
    "read_records": {"dt": 0.02, "units": "g"},
    "read_hazard": {"units": "g"},
    "read_spectrum": {"units": "g"},
    "eurocode_8": {"ag": 2.0, "soil": "B"},
    "asce_7": {"sds": 9.8, "sd1": 5.0, "tl": 8.0},
    "fit_motion": {"filters": 1},
    "fit_ground": {"target": sl.eurocode_8(2.0, "B"), "duration": 4.0, "filters": 1},
    "scale_records": {"pga": 1.0},
    "scale_ground": {"pga": 1.0},
    "HazardCurve": {"intensities": [1.0, 2.0], "frequencies": [0.01, 0.002]},
    "PowerLawHazard": {"k0": 0.02, "k": 3.0},
    "amplification": {"of": "peak", "duration": 3.0},
    "pounding_probability": {"duration": 3.0},
    "Uncertain": {"median": 1.0, "spread": 0.2},
    "pounding_risk": {"hazard": HAZARD, "duration": 3.0},
    "required_gap": {"hazard": HAZARD, "duration": 3.0, "risk": 0.002},
    "ModalBuilding": {
        "periods": [0.5],
        "shapes": [[1.0]],
        "participation": [1.0],
        "modal_masses": [1e5],
        "hardening": 0.1,
        "yield_displacements": 0.01,
        "law": "bouc_wen",
        "law_parameters": {"beta": 0.6},
    },
    "ShearBuilding": {
        "masses": [1e5, 1e5],
        "stiffnesses": [1e8, 1e8],
        "heights": [3.0, 3.0],
        "hardening": 0.1,
        "yield_drifts": 0.01,
        "dampers": 1e5,
        "law": "bouc_wen",
        "law_parameters": {"beta": 0.6},
        "p_delta": True,
        "damping_modes": (1, 2),
    },
    "ShearBuilding.regular": {
        "storeys": 3,
        "storey_height": 3.0,
        "hardening": 0.1,
        "base_shear_coefficient": 0.1,
    },
    "read_pushover": {"length_units": "mm", "force_units": "kN"},
    "bilinear_of": {"pushover": PUSHOVER},
    "Measure": {"added_damping_1": 0.1, "link": [sl.Link(1e6)]},
    "Link": {
        "damping_exponent": 0.5,
        "hardening": 0.1,
        "yield_displacement": 0.01,
        "floors": (1, 1),
        "structures": (1, 2),
    },
    "pounding_estimate": {"duration": 3.0, "radius_1": 0.1, "radius_2": 0.2},
    "code_gaps": {"peak_1": 0.1, "peak_2": 0.1},
    "pound": {"gaps": [0.05], "contact": sl.Kelvin(1e8, restitution=0.6), "motion": RECORD},
    **{name: {"restitution": 0.6} for name in DASHPOTS},
}


NAMES = [name for name in sl.__all__ if callable(getattr(sl, name))]
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
ALSO = {"name": "name_rule_model", "yield_displacement": "yield_strength_hardening"}  # said in its place
ALSO |= {"reduction_factor": "reduction_strength_hardening", "structure": "structure_strength"}


def complaint(call: Callable[..., Any], passed: Mapping[str, Any]) -> BaseException | None:
    """What the call raises; None if it takes all that."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            call(**passed)
    except (Exception, SystemExit) as error:
        return error
    return None


def arguments(name: str, tmp: Path) -> dict[str, Any]:
    passed = dict(usual()) | OWN.get(name, {})
    parameters = inspect.signature(attrgetter(name)(sl)).parameters
    chosen = {
        key: passed.get(key)
        for key, about in parameters.items()
        if about.default is about.empty and about.kind not in (about.VAR_KEYWORD, about.VAR_POSITIONAL)
    }
    if "path" in parameters:
        texts = {"read_case": example_case(), "read_spectrum": SPECTRUM}
        texts["read_pushover"] = "0 0\n10 500\n30 700\n60 750\n"
        texts["read_modes"] = "mode,,1\nperiod [s],,0.5\nlevel [m],mass [kg],shape\n3,1e5,1\n"
        texts["read_hazard"] = "0.1,0.01\n0.3,0.001\n"
        text = texts.get(name, "\n".join(map(str, np.sin(TIME))))
        (tmp / "file.txt").write_text(text, encoding="utf-8")
        chosen["path"] = tmp if name == "read_records" else tmp / "file.txt"
    return chosen | {key: value for key, value in OWN.get(name, {}).items() if key in parameters}


def is_usual(value: Any, about: inspect.Parameter) -> bool:
    """Whether the call is as without the value: nothing then is wrong."""
    number = isinstance(value, int) and not isinstance(value, bool)
    return value is about.default or (number and value == about.default)


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
        and "no cell has valid parameters" not in said  # of a table
        and not any(word in said for word in words),
    }
    return ", ".join(fault for fault, found in faults.items() if found)


@pytest.mark.parametrize("name", with_slow(NAMES, LONG))
def test_what_is_wrong_is_said_in_a_line_that_names_the_parameter(name: str, tmp_path: Path) -> None:
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
            if fault := unfit(error, parameter):
                said.append(f"{parameter}, {kind}: {fault}: {type(error).__name__} {str(error)[:200]!r}")
    assert not said, "\n".join(said)


# --- Structures of every kind -------------------------------------------------------------------------


def oscillators(kind: Any, **law: Any) -> tuple[Any, Any]:
    first, second = (kind(T, 0.05, 0.05, yield_displacement=5e-4, mass=1e5, **law) for T in (0.1, 0.14))
    return first, second


def shear(law: Any) -> tuple[Any, Any]:
    strength = {"hardening": 0.5, "yield_drifts": 0.001, "law": law}
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
    return sl.ModalBuilding(*chain, 0.05, hardening=0.5, yield_displacements=0.001)


@cache
def kinds() -> list[tuple[Any, Any]]:
    """Pairs of every kind and law, the bilinear one first."""
    own, worn = V - (abs(V) * Z + V * abs(Z)) / 2, {"strength_decay": 0.02, "pinching": 0.9}
    pairs = [oscillators(each) for each in (sl.Bilinear, sl.BoucWen, sl.ModifiedClough, sl.Flag)]
    pairs += [oscillators(sl.Hysteretic, law=own), oscillators(sl.BoucWenBaberNoori, **worn)]
    pairs += [shear(law) for law in ("bilinear", "bouc_wen", "modified_clough", own)]
    return [*pairs, (by_modes(2), by_modes(3)), (pairs[0][0], shear("bilinear")[1])]


GROUNDS = sl.KanaiTajimi(0.2, 0.6, 0.01), sl.WhiteNoise(0.01), sl.CloughPenzien(0.2, 0.6, 1.0, 0.6, 0.01)
SIZES = {"duration": 0.15, "paths": 16, "relaxation_times": 1.0, "points": 5}
WAYS: dict[str, list[dict[str, Any]]] = {
    "linearize": [{"closure": "clipped"}, {"closure": "drift"}],
    "correlate": [
        {"closure": "drift"},
        *({"method": name} for name in ("white_noise", "effective", "simulation")),
    ],
    "linearize_system": [{"links": [sl.Link(1e6, 1e5)]}],
    "simulate": [{"link": sl.Link(1e6, 1e5)}],
    "amplification": [{"of": "peak"}, {"method": "simulation"}],
    "pounding_probability": [{"method": "hybrid", "record": RECORD[:20], "duration": None}],
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
    pairs = [(pair, GROUNDS[0]) for pair in kinds()] + [(kinds()[0], ground) for ground in GROUNDS[1:]]
    said = []
    for way in [{}, *WAYS.get(name, [])]:
        for pair, ground in pairs:
            here = {
                key: of(*pair) for key, of in OF_PAIR.items() if key in passed or key[:-1] == "modes_"
            }
            here |= {"ground": ground} if "ground" in passed else {}
            tried = passed | short | here | way
            error = complaint(call, {key: value for key, value in tried.items() if key in parameters})
            words = "" if error is None else str(error)
            fine = any(word in words for word in ("allowed", "give", "write", "follow"))
            if error is not None and not (fine and words.isprintable() and len(words) <= LONGEST):
                said.append(f"{way}, {[type(each).__name__ for each in pair]}: {error!r}")
    assert not said, "\n".join(said)
