"""What the title of a column says: its quantity and unit, and what narrows these."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator, Sequence
from functools import lru_cache
from math import e, nan
from typing import NamedTuple

import numpy as np

from stochlin.applications.sheets.quantities import (
    ACCELERATION_COLUMN,
    ANGULAR_COLUMN,
    DISPLACEMENT_COLUMN,
    FORCE_COLUMN,
    FREQUENCY_COLUMN,
    INDEX_COLUMN,
    MODE_COLUMN,
    NAME_COLUMN,
    OTHER_COLUMN,
    PERIOD_COLUMN,
    QUANTITIES,
    RATE_COLUMN,
    STRANGE_COLUMN,
    TIME_COLUMN,
    VELOCITY_COLUMN,
    Quantity,
)
from stochlin.models.units import likely_unit, parsed

# What a title that has a unit alone may mean.
_BY_UNIT = (
    TIME_COLUMN,
    PERIOD_COLUMN,
    ACCELERATION_COLUMN,
    VELOCITY_COLUMN,
    DISPLACEMENT_COLUMN,
    FORCE_COLUMN,
    FREQUENCY_COLUMN,
    ANGULAR_COLUMN,
    RATE_COLUMN,
)
# which give way to a quantity that the title names, too
_BESIDE = {INDEX_COLUMN, MODE_COLUMN, NAME_COLUMN}
_BRACKETS = re.compile(r"[(\[{]([^()\[\]{}]*)[)\]}]")
_LOGARITHM = re.compile(r"\s*(log_?10|lg|ln|log)[\s_]*(.*)", re.IGNORECASE)
_BASES = {"log10": 10.0, "log_10": 10.0, "lg": 10.0, "ln": e, "log": nan}
_SENTENCE = 8  # words from which a title is a sentence, of which the unit alone is looked for
_LONG = 5  # letters from which a word is also known within another one, the longest first
_WITHIN = sorted((word for word in QUANTITIES if len(word) >= _LONG), key=len, reverse=True)
_INNER_CAPITAL = re.compile(r"(?<=[a-z])(?=[A-Z])")  # FrequencyHz
_BEFORE_UNIT = re.compile(rf"[\s_,;/-]+|{_INNER_CAPITAL.pattern}")  # before a unit without brackets
_DIRECTION = re.compile(r"[A-Z]|[tan]")  # in brackets: a component, or an argument
_OF_PERIOD = re.compile(
    r"\bSA\s*\(\s*(\d*\.?\d+)\s*(?:s|sec)?\s*(?:,[^)]*)?\)|\bSA(\d{1,3})P(\d{1,6})\b"
    r"|\bSA[\s_]*(\d*\.\d+)(?![\d.]|\s*%)|\bSA[\s_]+(\d+)\s*s(?:ec)?\b",
    re.IGNORECASE,
)
_DAMPED = r"damp|crit|amort|smorz|d[aä]mpf|s[oö]n"
_OF_DAMPING = re.compile(
    rf"(\d+(?:[.,]\d+)?)\s*%\s*(?=$|[()\[\],;_]|{_DAMPED})"
    r"|\b(?:damping|xi|zeta|h|ξ|ζ)\s*=\s*(0?\.\d+)",
    re.IGNORECASE,
)
# Of several curves one that is not the usual one, or a part of it, as that of a storey.
_ASIDE = re.compile(
    r"quantile|fractil|percentil|\d\s*(?:st|nd|rd|th)\b|sigma|σ|\bstd|deviation|\bcov\b|±|[+-]\s*1\b"
    r"|stor(?:e?y|ies)[\s_-]*(?:drift|shear|force|disp|defl)|entrepiso|interpiano|geschoss"
    r"|\bsrss\b|/\s*(?:pga|a_?gr?|r|q)\b|\b[rq]\s*=\s*\d|\bdesign\b"
    # S_d of Eurocode 8, divided by q:
    r"|\bs_?d\b(?:\(t\))?\s*[\[(]\s*(?:m?g\b|gal|[cm]*m/s)[^\])]*[\])]?"
    r"|\bno[nt]?[\s_-].*ex[cz]e|(?<!damping )\bratio|normali[sz]|amplification|residual|\berror",
    re.IGNORECASE,
)

_OF_DIVISOR = re.compile(r"\b(?:R|[qQ]0?)\s*[=:]\s*(\d+(?:[.,]\d+)?)")


class Said(NamedTuple):
    """What a title says of its column.

    ``quantities`` are those that it may mean, none if it names none; ``base`` is that of a
    logarithm, NaN if it is not stated, ``period`` [s] that of ``SA(0.5)``, and ``damping`` that of
    ``5 %``. ``aside`` is why it is not to be taken unless it is asked for, as ``/R`` or the words
    of a fractile.
    """

    quantities: tuple[Quantity, ...] = ()
    unit: str = ""
    base: float | None = None
    period: float | None = None
    damping: float | None = None
    aside: str = ""


@lru_cache(maxsize=1024)
def said_by(title: str, below: str = "") -> Said:
    """What a title says, and the cell of units ``below`` it."""
    if log := _LOGARITHM.fullmatch(title):
        within = said_by(_opened(log[2]), below)
        if within.quantities and not {*within.quantities} & {
            *_BESIDE,
            OTHER_COLUMN,
            STRANGE_COLUMN,
        }:
            return within._replace(base=_BASES[log[1].lower()])
    of_period = _OF_PERIOD.search(title)
    of_damping = _OF_DAMPING.search(title)
    name = _OF_PERIOD.sub(" sa ", title)
    inner = list[str]()
    if of_damping and of_damping[1]:
        name = name.replace(of_damping[0], " ")
    while texts := _BRACKETS.findall(name):
        inner += texts
        name = _BRACKETS.sub(" ", name)
    stated = [text.strip() for text in (*_of_cell(below), *inner) if text.strip()]
    quantities, unit = _meant(name, stated)
    period = None
    if of_period:
        whole, first, second, *others = of_period.groups()
        period = float(whole or next(filter(None, others), None) or f"{first}.{second}")
    damping = None
    if of_damping:
        percent, share = of_damping.groups()
        damping = float(percent.replace(",", ".")) / 100 if percent else float(share)
    aside = _ASIDE.search(title)
    return Said(quantities, unit, None, period, damping, aside[0] if aside else "")


def divided_by_remark(text: str) -> float:
    """The factor R or q that a remark states, as ``q = 3``; 1 if it states none."""
    stated = _OF_DIVISOR.search(text)
    return float(stated[1].replace(",", ".")) if stated else 1.0


def damping_in_remark(text: str) -> float | None:
    """The damping ratio that a remark states, as ``damping 2 %``; None if it states none."""
    return said_by(text).damping if re.search(_DAMPED, text, re.IGNORECASE) else None


def _opened(text: str) -> str:
    """A text without the brackets in which it begins, as ``(Sa(T)) [g]``."""
    if text[:1] not in ("(", "["):
        return text
    depths = np.cumsum([(sign in "([") - (sign in ")]") for sign in text])
    end = int(np.argmax(depths == 0))  # of the first bracket
    return f"{text[1:end]} {text[end + 1 :]}" if end else text


def compared(text: str) -> str:
    """A text in small letters without accents."""
    dotted = text.replace("\N{LATIN SMALL LETTER DOTLESS I}", "i")
    parts = unicodedata.normalize("NFKD", dotted.casefold())
    return "".join(sign for sign in parts if not unicodedata.combining(sign))


def _of_cell(below: str) -> Sequence[str]:
    """What a cell of units states, with brackets or without them."""
    return _BRACKETS.findall(below) or [below]


def _meant(name: str, stated: Sequence[str]) -> tuple[tuple[Quantity, ...], str]:
    """The quantities that a name and what stands in brackets may mean, and the unit."""
    named = _named(name)
    remark = max(stated, key=len, default="")
    if not any(map(_is_unit, stated)):
        return _without_brackets(name, named, remark)
    if fitting := next((unit for unit in stated if _fit(named, unit)), ""):
        return _fit(named, fitting), fitting
    units = [unit for unit in stated if _is_unit(unit) and not _DIRECTION.fullmatch(unit)]
    if not units or (named and not any(quantity.unit for quantity in named)):
        return named, units[0] if units else remark
    says_nothing = not named or len(compared(name.strip())) == 1  # a letter may name a component
    return (says_nothing and _fit(_BY_UNIT, units[0])) or (STRANGE_COLUMN,), units[0]


def _without_brackets(
    name: str, named: tuple[Quantity, ...], remark: str
) -> tuple[tuple[Quantity, ...], str]:
    """The quantities and unit of ``Sa_g`` and of ``s``; the remark in place of a unit otherwise."""
    if "".join(_words(name)) not in QUANTITIES:
        for edge in _BEFORE_UNIT.finditer(name):
            rest = _named(name[: edge.start()])
            unit = name[edge.end() :].strip()
            for text in (unit, unit.replace("_", "/")):
                if fits := _fit(rest, text):
                    return fits, text
                if any(likely_unit(text, of.unit) for of in rest):  # refused when it is read
                    return rest, text
    alone = name.strip()
    of_unit = () if named or _DIRECTION.fullmatch(alone) else _fit(_BY_UNIT, alone)
    return (of_unit, alone) if of_unit else (named, remark)


def _fit(quantities: Sequence[Quantity], unit: str) -> tuple[Quantity, ...]:
    """Those of the quantities that have this unit."""
    return tuple(of for of in quantities if of.unit and of.size(unit) is not None)


def _is_unit(text: str) -> bool:
    is_parsed = text != "1" and parsed(text) is not None
    return is_parsed or bool(_fit((FREQUENCY_COLUMN, ANGULAR_COLUMN), text))


def _words(name: str) -> list[str]:
    """The words of a name as they are compared."""
    return re.findall(r"[^\W_]+", compared(_INNER_CAPITAL.sub(" ", name)))


def _named(name: str) -> tuple[Quantity, ...]:
    """The quantities that a name may mean: those of all its words; none if these contradict."""
    words = _words(name)
    if len(words) > _SENTENCE:
        return ()
    whole = "".join(re.findall(r"[^\W_]+", compared(name)))
    hits = [QUANTITIES[whole]] if whole in QUANTITIES else [*_hits(words)]
    if not hits:
        hits = [QUANTITIES[word] for word in _WITHIN if word in whole][:1]
    measured = [hit for hit in hits if not {*hit} & _BESIDE] or hits
    return tuple(of for of in measured[0] if all(of in hit for hit in measured)) if measured else ()


def _hits(words: Sequence[str]) -> Iterator[tuple[Quantity, ...]]:
    """The meanings of the words from left to right, the longest ones of several words."""
    start = 0
    while start < len(words):
        ends = range(len(words), start, -1)
        joined = ("".join(words[start:end]) for end in ends)
        end = next(
            (end for end, text in zip(ends, joined, strict=True) if _is_word(text, words)), None
        )
        if end is not None:
            yield QUANTITIES["".join(words[start:end])]
        start = start + 1 if end is None else end


def _is_word(text: str, words: Sequence[str]) -> bool:
    """Whether a text is known: a single letter alone only, beside which there may be numbers."""
    alone = len(text) > 1 or sum(not word.isdigit() for word in words) == 1
    return alone and text in QUANTITIES
