"""What a command shows, as plain data: the screen and the page write the same sections."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PICTURES = (".png", ".svg", ".pdf")


@dataclass(frozen=True)
class Text:
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
class Table:
    """Numbers below heads such as ``gap [cm]``; the first column and those of words are flush left."""

    heads: Sequence[str]
    rows: Sequence[Row]
    words: Sequence[str] = ()
    minor: Sequence[str] = ()  # columns that a phone leaves out

    @classmethod
    def of(cls, heads: Sequence[str], rows: Iterable[Sequence[str]], words: Sequence[str] = ()) -> Table:
        """A table of rows that are cells and nothing else."""
        return cls(heads, [Row(cells) for cells in rows], words)


@dataclass(frozen=True)
class Picture:
    """A picture, drawn where it is shown, with its description in words."""

    title: str
    caption: str
    draw: Callable[[], Figure]
    beside: bool = False  # first of a page, without its title: what follows stands beside it


Block: TypeAlias = Text | Items | Table | Picture


@dataclass(frozen=True)
class ViewSection:
    """Blocks below a title, which may be empty; a section without content is not shown."""

    title: str
    blocks: Sequence[Block]
    on_screen: bool = True
    on_page: bool = True
    detail: bool = False  # on the screen only if details are asked for
    columns: bool = False  # side by side, where the page is wide enough


def texts(sentences: Iterable[str]) -> list[Text]:
    """A paragraph for each sentence."""
    return [Text(sentence) for sentence in sentences]
