"""Numbers and names in words, for every command and picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from stochlin.analyses.cases.case import Case
    from stochlin.analyses.cases.storeys import SlabOnColumn

MISSING, MINUS, SPACE = "\N{EN DASH}", "\N{MINUS SIGN}", "\N{NO-BREAK SPACE}"
CAPITALS = {"asce": "ASCE", "is": "IS", "ubc": "UBC", "e030": "E.030", "fema": "FEMA", "srss": "SRSS"}
COMMON = {
    *("simulation", "simulated", "linearization", "linearized", "elastic", "secant"),
    *("share", "of", "sum", "unverified", "drift", "white", "noise"),
}

SLABS = (
    "A slab can break the column that it hits, and the storey with it; codes that ask for less where "
    "floors align, as Eurocode 8 (4.4.2.7) for .7 of the gap, mean level floors alone."
)


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


def columns_hit(slabs: Sequence[SlabOnColumn]) -> str:
    """That slabs meet columns, and what codes say of that; empty where none does."""
    if not slabs:
        return ""
    more = {0: "", 1: ", and one more does"}.get(len(slabs) - 1, f", and {len(slabs) - 1} more do")
    return f"Floors are not level: {slabs[0]}{more}. {SLABS}"


def scatter(case: Case) -> str:
    """How motions differ in strength, and where that number is from; empty where it is 0 as usual."""
    usual = case.usual_scatter
    if not case.scatter:
        told = f"suites of records show a scatter of {usual:g} about such a site"
        return f"With scatter = 0 in [motion] all motions are of one strength; {told}." if usual else ""
    shown = "what suites of records show about such a site; scatter = 0 in [motion] leaves it out"
    return (
        "From earthquake to earthquake the motions differ in strength by a lognormal factor of median 1 "
        f"and scatter {case.scatter:g} (standard deviation of its natural logarithm): "
        f"{shown if case.scatter == usual else 'scatter in [motion] of the file'}."
    )


def floors(case: Case) -> str:
    """That floors are not level, and what codes say of that; empty where that is not known."""
    slabs, unlike = case.slabs_on_columns, case.unlike_storeys
    if slabs:
        return columns_hit(slabs)
    if unlike:
        names, heights = zip(*((one.name, f"{one.storey_height:.2f} m") for one in unlike), strict=True)
        said = ", although the file says so" if case.floors_align else ""
        return (
            f"Floors can hardly all be level{said}: storeys are {' and '.join(heights)} high in "
            f"{' and '.join(names)}. {SLABS}"
        )
    return ""
