"""The explorer's controls for a reader: what options are called, and what an entry shows and accepts."""

from __future__ import annotations

from typing import Any

from stochlin.analyses.cases.files.quantities import Quantity
from stochlin.analyses.explorer.form import BUILDINGS, Form, NumberControl
from stochlin.messages import brief
from stochlin.models.arguments import Whole
from stochlin.models.grounds import GROUNDS
from stochlin.models.parameters import Range

SIGNS = str.maketrans({"^": "", "2": "²", "3": "³"})  # of units
LABELS = {  # of options that are keys of a case file
    "regular": "regular storeys",
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
}


def label_of(option: Any) -> str:
    """Name of an option for a reader."""
    kind = GROUNDS.get(option)
    return LABELS.get(option, str(option) if kind is None else f"{kind.name} filter")


def heading(title: str, form: Form) -> str:
    """Title of a group, with the name of its building if it has one of its own."""
    for number, name in enumerate(BUILDINGS, start=1):
        own = form.file.get(name, {}).get("name", "")
        if title.startswith(f"Building {number}") and own:
            return f"{title}: {own}"
    return title


def name_of(place: tuple[str, str]) -> str:
    """Name of a control in the page."""
    return ".".join(place)


def label_with_unit(number: NumberControl) -> str:
    """Label of a number with the unit of its entry."""
    unit = number.slider.unit.translate(SIGNS)
    return f"{number.key.label} [{unit}]" if unit else number.key.label


def shown(number: NumberControl, form: Form) -> float:
    """The number of a control in the unit of its entry."""
    return float(form[number.place] / number.key.unit_size)


def text_of(number: NumberControl, form: Form) -> str:
    """The number of a control as its entry shows it."""
    return f"{shown(number, form):.8g}"


def read_entry(number: NumberControl, text: str | None) -> float:
    """The number of an entry, in SI units; raises a ValueError that names what is allowed."""
    entered, limits = (text or "").strip(), _limits(number)
    try:
        value = float(entered) * number.key.unit_size
    except ValueError as error:
        raise ValueError(f"= {brief(entered)} is no number; allowed: {allowed(number)}") from error
    if isinstance(limits, Whole):
        whole = int(value) if value.is_integer() else value
        if not limits.contains(whole):
            raise ValueError(f"= {entered} {limits.refusal(whole)}")
        return whole
    if not limits.contains(value):
        raise ValueError(f"= {entered} is out of range; allowed: {allowed(number)}")
    return value


def allowed(number: NumberControl) -> str:
    """The allowed entries, in words."""
    limits, size = _limits(number), number.key.unit_size
    if isinstance(limits, Whole):
        return str(limits)
    ends = limits.lower / size, limits.upper / size
    return str(Range(*ends, limits.include_lower, limits.include_upper, limits.reason))


def _limits(number: NumberControl) -> Range | Whole:
    if number.slider.limits is not None:
        return number.slider.limits
    assert isinstance(number.key.kind, Quantity)
    return number.key.kind.allowed
