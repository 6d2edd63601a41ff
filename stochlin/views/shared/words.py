"""Numbers and names in words, for every command and picture."""

from __future__ import annotations

import numpy as np

MISSING, MINUS, SPACE = "\N{EN DASH}", "\N{MINUS SIGN}", "\N{NO-BREAK SPACE}"
CAPITALS = {"asce": "ASCE", "is": "IS", "ubc": "UBC", "e030": "E.030", "fema": "FEMA", "srss": "SRSS"}
COMMON = {
    *("simulation", "simulated", "linearization", "linearized", "elastic", "secant"),
    *("share", "of", "sum", "unverified", "drift", "white", "noise"),
}


def centimetres(metres: float) -> str:
    """A length in cm: tenths, or two digits below one."""
    value = 100 * metres
    if not np.isfinite(value):
        return MISSING
    return f"{value:.1f}" if value >= 0.95 else f"{value:.2g}"


def length(metres: float) -> str:
    """A length in cm, with its unit."""
    return f"{centimetres(metres)}{SPACE}cm"


def per_cent(share: float, digits: int = 0, sign: str = "") -> str:
    """A share in per cent."""
    if not np.isfinite(share):
        return MISSING
    return f"{100 * share:{sign}.{digits}f}{SPACE}%".replace("-", MINUS)


def label(rule: str) -> str:
    """Name of a rule for a reader, ``eq. (3), Iwan 1980``."""
    stem = rule.removeprefix("eq_3_")
    words = [w if w in COMMON else CAPITALS.get(w, w.title()) for w in stem.split("_")]
    return ("" if stem == rule else "eq. (3), ") + " ".join(words)


def short(value: float) -> str:
    """Three digits, without an exponent."""
    if not np.isfinite(value):
        return MISSING
    return f"{value:.0f}" if abs(value) >= 1000 else f"{value:.3g}"
