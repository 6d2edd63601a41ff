"""The explorer's controls: what each is called, its slider, and what may be entered."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from stochlin.analyses.explorer.buildings import DESCRIPTIONS, OF_FILE, OSCILLATOR, REGULAR
from stochlin.analyses.explorer.scene import (
    ALLOWED,
    SHAPES,
    SITES,
    STRENGTHS,
    WHOLE,
    Scene,
    names_of,
)
from stochlin.analyses.explorer.sites import (
    MEASURES,
    NAMES,
    PGA,
    S0,
    SA,
    SOILS,
    SPECTRA,
    TYPES,
    G,
)
from stochlin.messages import brief
from stochlin.models.envelopes import ENVELOPES
from stochlin.models.grounds import GROUNDS
from stochlin.models.parameters import Model

SCALES = {"cm": 100.0, "g": 1 / G}  # of a unit that is shown, for one in SI
LABELS = {  # of options that are keys of a case file
    "firm": "firm ground",
    "medium": "medium ground",
    "soft": "soft ground",
    **{f"ec8_{soil}": f"Eurocode 8, ground type {soil.upper()}" for soil in "abcde"},
    "taft_1952": "Taft 1952",
    "taft_1952_yeh_wen": "Taft 1952, Yeh and Wen",
    "mexico_city_1985_yeh_wen": "Mexico City 1985, Yeh and Wen",
    "sct_1985_ns": "SCT 1985, north-south",
    "sct_1985_ew": "SCT 1985, east-west",
    "white_noise": "white noise",
    "eurocode_8": "Eurocode 8 spectrum",
    "asce_7": "ASCE 7 spectrum",
    "parallel": "filters of the file, in parallel",
    "amin_ang": "Amin and Ang",
    "shinozuka_sato": "Shinozuka and Sato",
    "hsu_bernard": "Hsu and Bernard",
}
OF_FACTOR = (
    "R is relative to the elastic response, so that a stronger ground motion makes the building "
    "stronger as well; choose the yield displacement above to keep the strength as it is."
)
OF_SCALE = (
    "The spectrum of the file has this one slider: a factor on all of its accelerations, at every "
    "period alike."
)


class Control(NamedTuple):
    """A number: its name in the scene, its label, and the range of its slider; entries may go beyond.

    ``about`` is a sentence below it.
    """

    name: str
    label: str
    low: float
    high: float
    step: float
    unit: str = ""
    about: str = ""

    @property
    def shown(self) -> str:
        """Label with the unit."""
        return f"{self.label} [{self.unit}]" if self.unit else self.label

    def text(self, scene: Scene) -> str:
        """The scene's number as an entry shows it."""
        return f"{getattr(scene, self.name) * SCALES.get(self.unit, 1.0):.8g}"

    def read(self, text: str | None) -> float:
        """The number of an entry, in SI; raises a ValueError that names what is allowed."""
        shown = (text or "").strip()
        try:
            value = float(shown) / SCALES.get(self.unit, 1.0)
        except ValueError as error:
            raise ValueError(f"= {brief(shown)} is no number; allowed: {self.range}") from error
        if self.name in WHOLE:
            whole = int(value) if value.is_integer() else value
            WHOLE[self.name]("", whole)
            return whole
        if not ALLOWED[self.name].metadata["allowed"].contains(value):
            raise ValueError(f"= {shown} is out of range; allowed: {self.range}")
        return value

    @property
    def range(self) -> str:
        """The allowed entries, in words."""
        if self.name in WHOLE:
            limits = WHOLE[self.name]
            return f"a whole number from {limits.lowest} to {limits.highest}"
        allowed = ALLOWED[self.name].metadata["allowed"]
        scale = SCALES.get(self.unit, 1.0)
        return str(
            dataclasses.replace(allowed, lower=allowed.lower * scale, upper=allowed.upper * scale)
        )


class Choice(NamedTuple):
    """A text of a list, or yes and no if there is no list."""

    name: str
    label: str
    options: Sequence[str] = ()

    def offered(self, scene: Scene) -> Sequence[str]:
        """The texts to choose from, with the storeys and the filters of a file if it gives some."""
        if self.options is SITES:
            return scene.sites()
        if self.options is not DESCRIPTIONS:
            return self.options
        return scene.ways_to_describe(int(self.name.rpartition("_")[2]))


class ControlGroup(NamedTuple):
    """Controls that belong together."""

    title: str
    controls: Sequence[Control | Choice]


def _building(number: int, side: str) -> ControlGroup:
    return ControlGroup(
        f"Building {number}, {side}",
        (
            Choice(f"description_{number}", f"Building {number} described as", DESCRIPTIONS),
            Control(f"period_{number}", "Period", 0.1, 4.0, 0.01, "s"),
            Control(f"storey_count_{number}", "Storeys", 1, 30, 1),
            Control(f"storey_height_{number}", "Storey height", 2.5, 6.0, 0.05, "m"),
            Control(f"damping_{number}", "Damping ratio", 0.005, 0.3, 0.005),
            Choice(f"yields_{number}", "Yields (off: elastic)"),
            Choice(f"strength_by_{number}", f"Strength of building {number} given by", (*STRENGTHS,)),
            Control(f"reduction_factor_{number}", "Reduction factor R", 0.5, 10.0, 0.1, about=OF_FACTOR),
            Control(f"yield_displacement_{number}", "Yield displacement", 0.2, 30.0, 0.1, "cm"),
            Control(f"base_shear_coefficient_{number}", "Base shear coefficient", 0.02, 0.6, 0.01),
            Control(f"strength_factor_{number}", "Strength factor", 0.1, 4.0, 0.05),
            Control(f"hardening_{number}", "Hardening ratio", 0.01, 1.0, 0.01),
        ),
    )


SHOWN = (
    ControlGroup(
        "Ground",
        (
            Choice("site", "Kind of ground", SITES),
            Control("ag", "Acceleration ag", 0.02, 0.8, 0.01, "g"),
            Choice("soil", "Ground type", SOILS),
            Choice("spectrum_type", "Type of spectrum", TYPES),
            Control("sds", "SDS", 0.05, 2.5, 0.01, "g"),
            Control("sd1", "SD1", 0.02, 1.5, 0.01, "g"),
            Control("tl", "TL", 4.0, 16.0, 1.0, "s"),
            Choice("measure", "Strength given by", MEASURES),
            Control("pga", "Peak acceleration, mean", 0.01, 1.0, 0.01, "g"),
            Control("sa", "Spectral acceleration, mean", 0.01, 2.0, 0.01, "g"),
            Control("sa_period", "Its period", 0.1, 4.0, 0.01, "s"),
            Control("spectrum_scale", "Scale of the spectrum", 0.1, 4.0, 0.05, about=OF_SCALE),
            Control("intensity", "Intensity S0", 0.0005, 0.05, 0.0005, "m²/s³"),
            Control("ground_period", "Ground period", 0.1, 4.0, 0.01, "s"),
            Control("ground_damping", "Ground damping ratio", 0.02, 1.0, 0.01),
            Control("high_pass_period", "High-pass period", 1.0, 20.0, 0.1, "s"),
            Control("high_pass_damping", "High-pass damping ratio", 0.05, 1.5, 0.05),
        ),
    ),
    _building(1, "left"),
    _building(2, "right"),
    ControlGroup(
        "Gap",
        (
            Control("gap", "Existing gap", 0.5, 60.0, 0.5, "cm"),
            Control("confidence", "Confidence of no pounding", 0.5, 0.99, 0.01),
        ),
    ),
    ControlGroup(
        "Motion",
        (
            Control("duration", "Duration", 5.0, 120.0, 1.0, "s"),
            Choice("envelope", "Envelope", SHAPES),
            Control("rise_end", "End of the rise", 0.5, 30.0, 0.5, "s"),
            Control("strong_end", "End of strong shaking", 1.0, 90.0, 0.5, "s"),
            Control("power", "Power of the rise", 0.5, 8.0, 0.1),
            Control("slow", "Slow rate", 0.01, 1.0, 0.01, "1/s"),
            Control("fast", "Fast rate", 0.1, 5.0, 0.05, "1/s"),
            Control("decay", "Rate of decay", 0.05, 2.0, 0.05, "1/s"),
            Control("paths", "Simulated motions", 256, 8192, 256),
        ),
    ),
)


def _with_others(group: ControlGroup, kinds: Mapping[str, type[Model]]) -> ControlGroup:
    """The group with a control for what else its kinds of model have: a parameter of an extension."""
    known = {control.name for other in SHOWN for control in other.controls}
    names = {name for kind in kinds.values() for name in names_of(kind)} - known
    return group._replace(controls=(*group.controls, *map(_declared, sorted(names))))


def _declared(name: str) -> Control:
    """From what the model says of its parameter; the slider is about its default."""
    about, start = ALLOWED[name].metadata, getattr(Scene(), name)
    ends = max(about["allowed"].lower, -start), min(about["allowed"].upper, 3 * start)
    low, high = (start + 0.9 * (end - start) for end in ends)
    step = float(f"{(high - low) / 100:.0e}")
    unit = "" if about["units"] == "1" else about["units"]
    return Control(name, str(about["long_name"]).capitalize(), low, high, step, unit)


# In which descriptions of a building a control has a say, where it has not in all.
OF_BUILDINGS: Mapping[str, Sequence[str]] = {
    "storey_count": (REGULAR,),
    "storey_height": (REGULAR,),
    "yields": DESCRIPTIONS,
    "hardening": DESCRIPTIONS,
    "strength_by": (OSCILLATOR,),
    "reduction_factor": (OSCILLATOR,),
    "yield_displacement": (OSCILLATOR,),
    "base_shear_coefficient": (REGULAR,),
    "strength_factor": (OF_FILE,),
}
# Of what ground, and of what measure of its strength, a control is.
OF_CODES = {name: code for code, names in NAMES.items() for name in names}
OF_MEASURES = {"intensity": S0, "pga": PGA, "sa": SA, "sa_period": SA}
OF_STRENGTH = (
    "hardening",
    "strength_by",
    "base_shear_coefficient",
    "strength_factor",
    *STRENGTHS.values(),
)
OF_KINDS: Mapping[str, Mapping[str, type[Model]]] = {"Ground": GROUNDS, "Motion": ENVELOPES}
GROUPS = tuple(_with_others(group, OF_KINDS.get(group.title, {})) for group in SHOWN)
NUMBERS: Mapping[str, Control] = {
    control.name: control
    for group in GROUPS
    for control in group.controls
    if isinstance(control, Control)
}


def label_of(option: str) -> str:
    """Name of an option for a reader."""
    kind = GROUNDS.get(option)
    return LABELS.get(option, option if kind is None else f"{kind.name} filter")


def heading(title: str, scene: Scene) -> str:
    """Title of a group, with the name of its building if it has one of its own."""
    for number, name in enumerate(scene.names, start=1):
        if title.startswith(f"Building {number}") and name != f"Building {number}":
            return f"{title}: {name}"
    return title


def counts(name: str, values: Mapping[str, Any]) -> bool:
    """Whether a control has an effect with these values: the others are hidden."""
    if name in OF_CODES:
        return values["site"] == OF_CODES[name]
    if name == "measure" or name in OF_MEASURES:
        measure = OF_MEASURES.get(name, values["measure"])
        return values["site"] not in SPECTRA and values["measure"] == measure
    for role, kinds in (("site", GROUNDS), ("envelope", ENVELOPES)):
        if any(name in names_of(kind) for kind in kinds.values()):
            return name in names_of(kinds.get(values[role]))
    stem, _, number = name.rpartition("_")
    if stem not in OF_BUILDINGS:
        return True
    described, storeys = values[f"description_{number}"], values["storeys_of_file"][int(number) - 1]
    can_yield = described != OF_FILE or "yield_drifts" in storeys.given
    if stem == "yields":
        return can_yield
    other_way = stem in {*STRENGTHS.values()} - {STRENGTHS[values[f"strength_by_{number}"]]}
    return (
        described in OF_BUILDINGS[stem]
        and not other_way
        and (stem not in OF_STRENGTH or (can_yield and bool(values[f"yields_{number}"])))
    )
