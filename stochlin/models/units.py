"""Units of all quantities: of arguments, of case files and of the files of other programs."""

from __future__ import annotations

import re
from collections.abc import Mapping

from scipy import constants

from stochlin.messages import brief

# Allowed units of a quantity by its SI unit; the first is shown in examples.
UNITS: Mapping[str, tuple[str, ...]] = {
    "s": ("s", "ms"),
    "m": ("cm", "m", "mm", "in", "ft"),
    "1/s": ("1/s",),
    "kg": ("kg", "t", "kN s^2/m", "tonf s^2/m", "kip s^2/in"),
    "N": ("N", "kN", "MN", "kgf", "tonf", "lb", "kip"),
    "N/m": ("N/m", "kN/m", "MN/m", "tonf/m", "kip/in"),
    "N s/m": ("N s/m", "kN s/m", "MN s/m", "tonf s/m", "kip s/in"),
    "m/s": ("cm/s", "m/s", "mm/s", "in/s", "ft/s"),
    "m/s^2": ("g", "m/s^2", "cm/s^2", "gal", "mm/s^2", "%g", "mg"),
    "m^2/s^3": ("m^2/s^3", "cm^2/s^3"),
    "yr": ("yr", "years", "a"),
    "1": ("%",),
}
PERCENT = "%"
_FORCES = {"n": 1.0, "kn": 1e3, "MN": 1e6, "kgf": constants.g, "lb": constants.lbf}
_FORCES |= {"tonf": 1e3 * constants.g, "kip": 1e3 * constants.lbf}
_FORCES |= {"ton": _FORCES["tonf"], "lbf": _FORCES["lb"], "kips": _FORCES["kip"]}
# Names with their sizes in SI, by their powers of length, mass, time and years. Headers of files in
# capitals have MM.
_SIZES_IN_SI: dict[tuple[float, ...], dict[str, float]] = {
    (0, 0, 0, 0): {"1": 1.0, PERCENT: 0.01},
    (1, 0, 0, 0): {"m": 1.0, "cm": 0.01, "mm": 0.001, "MM": 0.001, "in": 0.0254, "ft": 0.3048},
    (0, 1, 0, 0): {"kg": 1.0, "t": 1e3, "tonne": 1e3},
    (0, 0, 1, 0): {
        **dict.fromkeys(("s", "sec", "secs", "second", "seconds", "seg", "sek", "sn"), 1.0),
        **dict.fromkeys(("ms", "msec"), 1e-3),
    },
    (0, 0, 0, 1): {"yr": 1.0, "years": 1.0, "a": 1.0},
    (1, 0, -2, 0): {
        "g": constants.g,
        "gal": 0.01,
        "%g": 0.01 * constants.g,
        "mg": 1e-3 * constants.g,
    },
    (1, 1, -2, 0): _FORCES,
    (-1, 1, -2, 0): {"psi": constants.psi},
}
# The case of letters changes the prefix of these from milli to mega; of all others it changes
# nothing.
_WITH_CASE = {name.lower(): name for name in ("mm", "ms", "msec", "MN", "mg")}
# a ton of force, as in "ton s^2/m", but alone also of mass
_TON = re.compile(r"\s*tons?\s*", re.IGNORECASE)
_QUANTITIES = {
    "length": "m",
    "mass": "kg",
    "force": "N",
    "acceleration": "m/s^2",
    "velocity": "m/s",
}
_KNOWN = {name: (size, powers) for powers, of in _SIZES_IN_SI.items() for name, size in of.items()}
# Signs of powers and products, also a raised 2 that was read in another encoding.
_SIGNS = str.maketrans("²³\N{REPLACEMENT CHARACTER}*·-", "232   ", "^")
_RATIO_UNIT = re.compile(r"\((\w+)/(\w+)\)([\d.]+)")  # (s/m)0.5
_PERCENT_OF_G = re.compile(r"% ?g", re.IGNORECASE)  # a hundredth of it
_FACTOR_OF_UNIT = re.compile(r" ?(/?) ?(1(?=/)|[A-Za-z%]+)(\d(?:\.\d*)?)?")
# Characters of a unit. With powers below 10, no product of factors is too large or small for a
# float.
_LONGEST = 32
_NAME = re.compile("[A-Za-z]+")


def size_of(unit: str, quantity: str) -> float | None:
    """The size of a unit in SI; None if it is unknown, or no unit of the quantity.

    ``quantity`` is the SI unit, such as ``"kg"`` or ``"N/m"``. Units are spelled as people do:
    ``"kip-sec²/in"``, ``"cm/s/s"``, ``"KN s/m"``. A ``"ton"`` has 1000 kg, as mass and as force, as
    programs of structural analysis have it. The case of letters does not matter but in a prefix:
    ``"mN"`` and ``"Ms"`` are unknown, and ``"mg"``, a thousandth of g, is no mass.
    """
    spelled = "t" if quantity == "kg" and _TON.fullmatch(unit) else unit
    stated = parsed(spelled)
    wanted = parsed("s/s" if quantity == "1" else quantity)
    return stated[0] / wanted[0] if stated and wanted and stated[1] == wanted[1] else None


def likely_unit(unit: str, quantity: str) -> str:
    """Words before the allowed units for a unit that is unknown: the one that was probably meant.

    They are empty if it differs by more than the case of a prefix or a sign of percent.
    """
    prefixed = _NAME.sub(lambda name: _WITH_CASE.get(name[0].lower(), name[0]), unit)
    likely = (
        prefixed,
        " ".join(prefixed.replace(PERCENT, "").split()),
        PERCENT * (PERCENT in unit),
    )
    near = next((text for text in likely if size_of(text, quantity) is not None), "")
    return f"did you mean {brief(near)}? " if near else ""


def stated_size(
    quantity: str, stated: str, wanted: object, where: str, argument: str = ""
) -> float:
    """The size of a unit in SI, as a file states it, or as the caller does where the file does not.

    ``quantity`` is ``"length"``, ``"mass"``, ``"force"``, ``"acceleration"`` or ``"velocity"``,
    ``where`` the place in the file, and ``argument`` the name of what the caller states, for
    messages. Raises a ValueError if neither says it, if both contradict each other, or if it is not
    known, and a TypeError if the unit that the caller states is no text.
    """
    of = _QUANTITIES[quantity]
    name = argument or ("units" if quantity == "acceleration" else f"{quantity}_units")
    allowed = ", ".join(UNITS[of])
    size = size_of(stated, of)
    if wanted is None:
        if size is not None:
            return size
        what = f"{brief(stated)} is not a known" if stated else "the file does not say the"
        what = f"{where}: {what} unit of the {quantity}; {likely_unit(stated, of)}"
        raise ValueError(f"{what}give {name}=, allowed: {allowed}")
    if not isinstance(wanted, str):
        raise TypeError(f"{name} = {brief(wanted)}; allowed: a text, such as {allowed}")
    wanted_size = size_of(wanted, of)
    if wanted_size is None:
        what = f"{name} = {brief(wanted)} is not a known unit; {likely_unit(wanted, of)}"
        raise ValueError(f"{what}allowed: {allowed}")
    of_other_quantity = any(size_of(stated, other) for other in {"m", "m/s"} - {of})
    if size not in (None, wanted_size) or of_other_quantity:
        what = f"{name} = {brief(wanted)} contradicts {where}, which states {brief(stated)}"
        raise ValueError(f"{what}; correct it, or leave it out")
    return wanted_size


def parsed(unit: str) -> tuple[float, tuple[float, ...]] | None:
    """Size in SI and powers of length, mass, time and years of any unit; None if it is unknown."""
    text = " ".join(unit.replace("**", "").translate(_SIGNS).split())
    if len(text) > _LONGEST:
        return None
    text = _RATIO_UNIT.sub(r"\1\3/\2\3", text)
    text = _PERCENT_OF_G.sub("%g", text)
    factors = _FACTOR_OF_UNIT.findall(text)
    if PERCENT in text and text not in (PERCENT, "%g"):
        return None
    if text[:1] in ("", "/") or "".join(map("".join, factors)) != text.replace(" ", ""):
        return None
    size = 1.0
    powers = [0.0] * 4
    for over, name, power in factors:
        entry = _KNOWN.get(name if name.lower() in _WITH_CASE else name.lower())
        if entry is None:
            return None
        exponent = float(power or 1) * (-1 if over else 1)
        in_si, its = entry
        size *= in_si**exponent
        powers = [
            before + exponent * dimension for before, dimension in zip(powers, its, strict=True)
        ]
    return size, tuple(round(dimension, 6) for dimension in powers)
