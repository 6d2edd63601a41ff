"""Functions accept structures, laws and grounds, or refuse them in words."""

import inspect
import warnings
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pytest
import sympy
import xarray as xr

import stochlin as sl

STRUCTURES = {"structure", "structures", "first", "second", "modes_1"}  # names of arguments
V, Z = sympy.symbols("v z")
OWN = V - (abs(V) * Z + V * abs(Z)) / 2
TIME = 0.02 * np.arange(20)
RECORD = xr.DataArray(np.sin(9 * TIME), dims="time", coords={"time": TIME}, attrs={"units": "m/s^2"})
GROUNDS = {
    "white noise": sl.WhiteNoise(0.01),
    "Kanai-Tajimi": sl.KanaiTajimi(0.2, 0.6, 0.01),
    "Clough-Penzien": sl.CloughPenzien(0.2, 0.6, 1.0, 0.6, 0.01),
}
CONTACT, LINK = sl.Kelvin(1e8, restitution=0.65), sl.Link(1e6, 1e5)
DEVICE = sl.Link(0.0, 1e5, damping_exponent=0.5, structures=(1, 1), floors=(1, 0))
SIZES = {"duration": 0.15, "paths": 16}
SPECTRUM = sl.eurocode_8(2.0, "B")
HAZARD = sl.HazardCurve([0.001, 0.01, 0.1], [0.1, 0.02, 0.001], measure="intensity")


class Pair(NamedTuple):
    """The structures of a call; ``second`` stands beside ``first``, to the right."""

    first: Any
    second: Any
    ground: Any = None

    @property
    def both(self) -> tuple[Any, Any]:
        return self.first, self.second

    @property
    def weak(self) -> Any:
        """The first without its strength."""
        if isinstance(self.first, sl.ModalBuilding):
            return _by_modes(2, {})
        if isinstance(self.first, sl.ShearBuilding):
            return _building(self.first.law, 2, {})
        law = {"law": OWN} if isinstance(self.first, sl.Hysteretic) else {}
        return type(self.first)(0.1, 0.05, 0.05, **law)


def _building(law: Any, storeys: int, strength: Mapping[str, float]) -> sl.ShearBuilding:
    return sl.ShearBuilding([1e5] * storeys, [1e9] * storeys, [3.0] * storeys, 0.05, law=law, **strength)


def _by_modes(storeys: int, strength: Mapping[str, float]) -> sl.ModalBuilding:
    """A uniform chain of these storeys by its modes, in closed form; the first one may yield."""
    phase = (2 * np.arange(1, storeys + 1) - 1) * np.pi / (4 * storeys + 2)
    shapes = np.sin(2 * phase[:, None] * np.arange(1, storeys + 1))
    periods = np.pi / (100 * np.sin(phase))
    return sl.ModalBuilding(periods, shapes, [1e5] * storeys, [3.0] * storeys, 0.05, **strength)


def _oscillators(kind: Any, **law: Any) -> Pair:
    given = {"yield_displacement": 0.0005, "mass": 1e5}
    return Pair(*(kind(period, 0.05, 0.05, **given, **law) for period in (0.1, 0.14)))


def _buildings(law: Any) -> Pair:
    strength = {"hardening": 0.5, "yield_drifts": 0.001}
    return Pair(*(_building(law, storeys, strength) for storeys in (2, 3)))


WORN = {"strength_decay": 0.02, "stiffness_decay": 0.05, "pinching": 0.9}
OF_MODE_1 = {"hardening": 0.5, "yield_displacements": 0.001}


@cache
def kinds() -> dict[str, Pair]:
    """Structures of every kind and law, by the heading of their column."""
    one, storeys = _oscillators(sl.Bilinear), _buildings("bilinear")
    return {
        "`Bilinear`": one,
        "`BoucWen`": _oscillators(sl.BoucWen),
        "`Hysteretic`": _oscillators(sl.Hysteretic, law=OWN),
        "`BoucWenBaberNoori`": _oscillators(sl.BoucWenBaberNoori, **WORN),
        "`ModifiedClough`": _oscillators(sl.ModifiedClough),
        "`Flag`": _oscillators(sl.Flag),
        "`ShearBuilding`, bilinear": storeys,
        "`ShearBuilding`, Bouc-Wen": _buildings("bouc_wen"),
        "`ShearBuilding`, a law in sympy": _buildings(OWN),
        "`ShearBuilding`, modified Clough": _buildings("modified_clough"),
        "`ModalBuilding`": Pair(*(_by_modes(n, OF_MODE_1) for n in (2, 3))),
        "an oscillator beside a `ShearBuilding`": Pair(one.first, storeys.second),
    }


# By function and what sets a call apart from the others of it; those with a ground are tried with each.
ON_GROUND: dict[str, Callable[[Pair], object]] = {
    "linearize": lambda s: sl.linearize(s.first, s.ground),
    'linearize, closure="clipped"': lambda s: sl.linearize(s.first, s.ground, "clipped"),
    'linearize, closure="drift"': lambda s: sl.linearize(s.first, s.ground, "drift"),
    "correlate": lambda s: sl.correlate(*s.both, s.ground),
    'correlate, closure="drift"': lambda s: sl.correlate(*s.both, s.ground, closure="drift"),
    'correlate, method="white_noise"': lambda s: sl.correlate(*s.both, s.ground, "white_noise"),
    'correlate, method="effective"': lambda s: sl.correlate(*s.both, s.ground, "effective"),
    'correlate, method="simulation"': lambda s: sl.correlate(
        *s.both, s.ground, "simulation", paths=16, relaxation_times=1.0
    ),
    "linearize_system": lambda s: sl.linearize_system(s.both, s.ground),
    "linearize_system, links": lambda s: sl.linearize_system(s.both, s.ground, [LINK]),
    "linearize_system, device": lambda s: sl.linearize_system(s.both, s.ground, [DEVICE]),
    "simulate": lambda s: sl.simulate(s.both, s.ground, paths=16, relaxation_times=1.0),
    "simulate, duration": lambda s: sl.simulate(s.both, s.ground, **SIZES),
    "simulate, link": lambda s: sl.simulate(s.both, s.ground, **SIZES, link=LINK),
    "simulate, device": lambda s: sl.simulate(s.both, s.ground, **SIZES, link=[DEVICE]),
    "statespace": lambda s: sl.statespace(s.both, s.ground),
    "amplification": lambda s: sl.amplification(s.first, s.ground),
    'amplification, method="simulation"': lambda s: sl.amplification(
        s.first, s.ground, method="simulation", paths=16
    ),
    'amplification, of="peak"': lambda s: sl.amplification(s.first, s.ground, of="peak", **SIZES),
    "reduction_factor": lambda s: sl.reduction_factor(s.first, s.ground),
    "strength_for_ductility": lambda s: sl.strength_for_ductility(s.weak, s.ground, 3.0),
    "peak_response": lambda s: sl.peak_response(s.first, s.ground, 2.0),
    "transient_response": lambda s: sl.transient_response(s.first, s.ground, 0.2, points=5),
    "separation": lambda s: sl.separation(*s.both, s.ground, **SIZES),
    "separation, second=None": lambda s: sl.separation(s.first, None, s.ground, **SIZES),
    "code_gaps, modes_1": lambda s: sl.code_gaps(
        modes_1=s.first, modes_2=s.second, spectrum=SPECTRUM, ground=s.ground
    ),
    "existing_gap": lambda s: sl.existing_gap(*s.both, s.ground, gap=0.005, **SIZES),
    "sensitivity": lambda s: sl.sensitivity(*s.both, s.ground, **SIZES),
    "sensitivity, second=None": lambda s: sl.sensitivity(s.first, None, s.ground, **SIZES),
    "pounding_probability": lambda s: sl.pounding_probability(
        *s.both, s.ground, 0.005, **SIZES, points=5
    ),
    'pounding_probability, method="hybrid"': lambda s: sl.pounding_probability(
        *s.both, s.ground, 0.005, method="hybrid", record=RECORD, points=5
    ),
    "pounding_fragility": lambda s: sl.pounding_fragility(*s.both, s.ground, 0.005, [0.01], **SIZES),
    "pounding_risk": lambda s: sl.pounding_risk(*s.both, s.ground, 0.005, HAZARD, **SIZES),
    "required_gap": lambda s: sl.required_gap(*s.both, s.ground, HAZARD, risk=0.01, **SIZES),
    "mitigate": lambda s: sl.mitigate(
        *s.both, s.ground, gap=0.005, measures={"dampers": sl.Measure(0.1, link=LINK)}, **SIZES
    ),
}
ON_RECORD: dict[str, Callable[[Pair], object]] = {
    "respond": lambda s: sl.respond(s.first, RECORD),
    "recorded_gap": lambda s: sl.recorded_gap(*s.both, RECORD),
    "recorded_gap, second=None": lambda s: sl.recorded_gap(s.first, None, RECORD),
    "energy_gap": lambda s: sl.energy_gap(*s.both, RECORD),
    "damping_for_gap": lambda s: sl.damping_for_gap(RECORD[:16], *s.both, 1.0),
    "separation, records": lambda s: sl.separation(
        *s.both, GROUNDS["Kanai-Tajimi"], **SIZES, records={"one": RECORD}
    ),
    "pound": lambda s: sl.pound(s.both, [0.05], CONTACT, RECORD),
    "pound, link": lambda s: sl.pound(s.both, [0.05], CONTACT, RECORD, link=LINK),
    "hysteresis_loop": lambda s: sl.hysteresis_loop(s.first, [0.01, -0.01]),
    "pounding_estimate": lambda s: sl.pounding_estimate(*s.both, 0.05, CONTACT, 0.1, 0.1, points=5),
}


CALLS = ON_GROUND | ON_RECORD
USUAL = "Kanai-Tajimi"  # the ground on which all kinds are tried


def functions() -> set[str]:
    """Names of the public functions that take a structure."""
    found = {name: getattr(sl, name) for name in sl.__all__}
    return {
        name
        for name, one in found.items()
        if inspect.isfunction(one) and STRUCTURES & set(inspect.signature(one).parameters)
    }


def refusal(call: Callable[[Pair], object], structures: Pair) -> str:
    """What a call says if it does not take these; nothing if it does."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            call(structures)
    except (TypeError, ValueError, ArithmeticError) as error:
        return str(error)
    return ""


@pytest.mark.slow
@pytest.mark.parametrize("label", CALLS)
def test_a_call_accepts_bilinear_oscillators_and_refuses_other_kinds_in_words(label: str) -> None:
    parameters = inspect.signature(getattr(sl, label.partition(",")[0])).parameters
    tried = [
        pair._replace(ground=GROUNDS[USUAL])
        for kind, pair in kinds().items()
        if "structure" not in parameters or "beside" not in kind
    ]
    if label in ON_GROUND:
        tried += [tried[0]._replace(ground=ground) for name, ground in GROUNDS.items() if name != USUAL]
    messages = [refusal(CALLS[label], pair) for pair in tried]
    assert messages[0] == ""
    for message in filter(None, messages):
        assert any(word in message for word in ("allowed", "give", "write", "follow")), message
        assert message.isprintable()


def test_every_function_of_structures_is_called() -> None:
    assert {label.partition(",")[0] for label in CALLS} == functions()
