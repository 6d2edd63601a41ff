"""Units of lengths, masses and forces, as programs of structural analysis write them."""

from __future__ import annotations

import re

from scipy import constants

from stochlin.messages import brief

LENGTHS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": constants.inch, "ft": constants.foot}
FORCES = {"n": 1.0, "kn": 1e3, "mn": 1e6, "kgf": constants.g, "tonf": 1e3 * constants.g}
FORCES |= {"lb": constants.lbf, "lbf": constants.lbf, "kip": 1e3 * constants.lbf}
MASSES = {"kg": 1.0, "t": 1e3, "tonne": 1e3}
ALLOWED = {
    "length": ", ".join(LENGTHS),
    "force": "N, kN, MN, kgf, tonf, lbf, kip",
    "mass": "kg, t, or a force over an acceleration such as kN-s2/m or kip-s2/in",
}
_OF_FORCE = re.compile(rf"({'|'.join(FORCES)})-s(?:ec)?2/({'|'.join(LENGTHS)})")
# Signs of multiplication, and the 2 as a raised sign, also one that was read in another encoding.
_SPELLED = str.maketrans({"²": "2", "\N{REPLACEMENT CHARACTER}": "2", "^": "", "*": "-", "·": "-"})


def size_of(quantity: str, unit: str) -> float | None:
    """A unit of a quantity in SI; None if it is not known, as ``ton``, which is several."""
    written = unit.strip().lower().translate(_SPELLED).replace(" ", "-")
    if quantity == "mass" and (match := _OF_FORCE.fullmatch(written)):
        return FORCES[match[1]] / LENGTHS[match[2]]
    return {"length": LENGTHS, "force": FORCES, "mass": MASSES}[quantity].get(written)


def size_stated(quantity: str, stated: str, asked: object, where: str) -> float:
    """The unit of a quantity in SI, as stated in the file, or asked for where it is not or not known.

    ``where`` is the place in the file, for messages. Raises a ValueError if neither says it, if both
    contradict each other, or if it is not known, and a TypeError if what is asked for is no text.
    """
    name, size, allowed = f"{quantity}_units", size_of(quantity, stated), ALLOWED[quantity]
    if asked is None:
        if size is None:
            what = f"{brief(stated)} is not a known unit of a {quantity}"
            missing = f"the file does not say the unit of the {quantity}"
            raise ValueError(f"{where}: {what if stated else missing}; give {name}=, allowed: {allowed}")
        return size
    if not isinstance(asked, str):
        raise TypeError(f"{name} = {brief(asked)}; allowed: a text, such as {allowed}")
    wanted = size_of(quantity, asked)
    if wanted is None:
        raise ValueError(f"{name} = {brief(asked)} is not a known unit; allowed: {allowed}")
    if size not in (None, wanted):
        what = f"{name} = {brief(asked)} contradicts {where}, which states {brief(stated)}"
        raise ValueError(f"{what}; correct it, or leave it out")
    return wanted
