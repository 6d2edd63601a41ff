"""Codes without a rule of their name, as engineers write them, and what is known in their place."""

from __future__ import annotations

import re

_MEXICO = "mexico_city is the NTC-Sismo of Mexico City of 2017"
_OTHERS = {
    r"(ntc|sismo|cdmx)+20?23": (
        f"the edition of 2023 of Mexico City has no rule here, and {_MEXICO}"
    ),
    r"(ntc|sismo|cdmx)+(20)?(17|20)|ntcsismo|ntccdmx": _MEXICO,
    r"ntc|ntcitaly": f"{_MEXICO}, and ntc_2018 is the code of Italy",
    r"ec8|eurocode|en1998.*": "eurocode_8 is EN 1998-1",
    r"(ibc|asce|asce7)\d*": "asce_7 is that of ASCE 7, to which IBC refers",
    r"nch|nch?433.*|ds61|chile": "Chile (NCh 433, DS 61) has no rule here",
    r"bsl|bslj|japan|japanese.*|buildingstandardlaw": (
        "Japan (Building Standard Law) has no rule here"
    ),
}


def other_code(name: str) -> str:
    """Words before a list of known codes, for the name of one that has no rule here; maybe none."""
    spelled = re.sub(r"[^a-z0-9]", "", name.lower())
    said = next((text for pattern, text in _OTHERS.items() if re.fullmatch(pattern, spelled)), "")
    return f"{said}; " if said else ""
