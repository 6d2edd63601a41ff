"""What a command shows, as plain data for screen and page, and the symbols of formulas in it."""

from __future__ import annotations

import html
import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Endings of pictures, with what their files would say of themselves but for this.
PICTURE_FORMATS = {
    ".png": {"Software": None},
    ".svg": {"Date": None},
    ".pdf": {"CreationDate": None},
}
GREEK = dict(zip(("alpha", "beta", "xi", "rho", "sigma", "tau", "omega"), "αβξρστω", strict=True))
LETTERS = {letter: name for name, letter in GREEK.items()}
LATIN = r"T[0-9fguyL]|T(?=/)|S[0-9afguy]|SD[S1]|u[0-9fgy]|[mv][0-9]|r_PER|ag|Cd|Ie|Ra"
SYMBOL = re.compile(
    rf"(?<![\w$])(?:{LATIN}|[{''.join(LETTERS)}](?:el|[0-9fguy])?"
    rf"|(?:{'|'.join(GREEK)})(?:_(?:el|[0-9a-z]))?)(?!\w)"
)
POWER = re.compile(r"\^(\((?:[^()]|\([^()]*\))*\)|-?\w)")


@dataclass(frozen=True)
class TextBlock:
    """A paragraph, none if it is empty. ``look``: title, answer, doubt, note, file or signed."""

    text: str
    look: str = ""


@dataclass(frozen=True)
class Items:
    """Texts below one another, each with a mark."""

    texts: Sequence[str]


@dataclass(frozen=True)
class Row:
    """Cells of a table; on the page ``label`` replaces the first, below the name of the group."""

    cells: Sequence[str]
    label: str = ""
    group: str = ""
    look: str = ""


@dataclass(frozen=True)
class TableBlock:
    """Numbers below heads like ``gap [cm]``; the first column and those of words are flush left."""

    heads: Sequence[str]
    rows: Sequence[Row]
    words: Sequence[str] = ()

    @classmethod
    def of(
        cls, heads: Sequence[str], rows: Iterable[Sequence[str]], words: Sequence[str] = ()
    ) -> TableBlock:
        """A table of rows that are cells and nothing else."""
        return cls(heads, [Row(cells) for cells in rows], words)


@dataclass(frozen=True)
class Picture:
    """A picture, drawn where it is shown, with its description in words."""

    title: str
    caption: str
    draw: Callable[[], Figure]
    beside: bool = False  # first of a page, without its title: what follows stands beside it


Block: TypeAlias = TextBlock | Items | TableBlock | Picture


@dataclass(frozen=True)
class ViewSection:
    """Blocks below a title, which may be empty; a section without content is not shown."""

    title: str
    blocks: Sequence[Block]
    on_screen: bool = True
    on_page: bool = True
    detail: bool = False  # on the screen only if details are asked for
    columns: bool = False  # side by side, where the page is wide enough


def texts(sentences: Iterable[str]) -> list[TextBlock]:
    """A paragraph for each sentence."""
    return [TextBlock(sentence) for sentence in sentences]


def typeset(text: str) -> str:
    """Plain text for a picture: ``T1/Tg``, ``ξg``, ``rho`` and ``m^2`` with indices and powers."""

    def symbol(letter: str, index: str) -> str:
        name = f"\\{LETTERS[letter]}" if letter in LETTERS else letter
        return f"${name}_{{{index}}}$" if index else f"${name}$"

    return _replaced(text.replace("$", r"\$"), symbol, "$^{{{}}}$")


def typeset_html(text: str, as_given: Iterable[str] = ()) -> str:
    """The same as HTML, all else escaped; ``as_given`` are names without symbols, the user's."""

    def symbol(letter: str, index: str) -> str:
        return f"<i>{letter}</i>" + (f"<sub>{index}</sub>" if index else "")

    names = "|".join(map(re.escape, sorted(filter(None, as_given), key=len, reverse=True)))
    parts = re.split(rf"((?<!\w)(?:{names})(?!\w))", text) if names else [text]
    escaped = [html.escape(part) for part in parts]
    escaped[::2] = [_replaced(part, symbol, "<sup>{}</sup>") for part in escaped[::2]]
    return "".join(escaped)


def _replaced(text: str, symbol: Callable[[str, str], str], power: str) -> str:
    """Text with its symbols as ``symbol`` writes them, and powers in this pattern."""

    def of_symbol(match: re.Match[str]) -> str:
        name, _, index = match[0].partition("_")
        return symbol(GREEK.get(name, name[0]), index if name in GREEK else index or name[1:])

    def of_power(match: re.Match[str]) -> str:
        raised = match[1]
        return power.format(raised[1:-1] if raised.startswith("(") else raised)

    return POWER.sub(of_power, SYMBOL.sub(of_symbol, text))
