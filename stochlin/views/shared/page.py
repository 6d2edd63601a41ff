"""Symbols of formulas in pictures and on pages, and sections as a page: one self-contained HTML file."""

from __future__ import annotations

import html
import io
import re
from collections.abc import Callable, Iterable, Sequence
from itertools import count
from typing import TYPE_CHECKING, Any

from stochlin.views.shared.blocks import Picture, ViewSection

if TYPE_CHECKING:
    from markupsafe import Markup

PAGE_STYLE = {"font.size": 10, "hatch.linewidth": 0.7, "svg.fonttype": "path"}
GREEK = dict(zip(("alpha", "beta", "xi", "rho", "sigma", "tau", "omega"), "αβξρστω", strict=True))
LETTERS = {letter: name for name, letter in GREEK.items()}
LATIN = r"T[0-9fguyL]|T(?=/)|S[0-9afguy]|SD[S1]|u[0-9fgy]|[mv][0-9]|r_PER|ag|Cd|Ie|Ra"
SYMBOL = re.compile(
    rf"(?<![\w$])(?:{LATIN}|[{''.join(LETTERS)}](?:el|[0-9fguy])?"
    rf"|(?:{'|'.join(GREEK)})(?:_(?:el|[0-9a-z]))?)(?!\w)"
)
POWER = re.compile(r"\^(\((?:[^()]|\([^()]*\))*\)|-?\w)")


def page(
    title: str,
    sections: Sequence[ViewSection],
    footer: Sequence[str],
    as_given: Sequence[str] = (),
    template: str = "page.html",
    prefix: str = "p",
) -> str:
    """HTML with pictures and style within; ``as_given`` are names without symbols, the user's.

    The template ``"sections.html"`` is that of the sections alone, for another page that has the style;
    their ids begin with the prefix.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined
    from markupsafe import Markup

    def typeset(value: Any) -> Any:
        """Escaped, with the symbols of formulas."""
        plain = isinstance(value, str) and not isinstance(value, Markup)
        return Markup(typeset_html(value, as_given)) if plain else value

    environment = Environment(
        loader=PackageLoader("stochlin.views.shared", "."),
        autoescape=True,
        undefined=StrictUndefined,
        finalize=typeset,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    numbers = count(1)
    environment.globals["svg"] = lambda picture: _svg(picture, f"{prefix}{next(numbers)}")
    shown = [section for section in sections if section.on_page]
    return environment.get_template(template).render(title=title, sections=shown, footer=footer)


def _svg(picture: Picture, prefix: str) -> Markup:
    """A picture for HTML: without prolog, with ids of its own, and with its text for screen readers."""
    import matplotlib as mpl
    from markupsafe import Markup, escape

    from stochlin.views.shared.style import STYLE

    with mpl.rc_context(STYLE | PAGE_STYLE), io.StringIO() as stream:
        picture.draw().savefig(stream, format="svg", metadata={"Date": None})
        svg = stream.getvalue()
    svg = re.sub(r"<metadata>.*?</metadata>|<!--.*?-->\n?", "", svg, flags=re.DOTALL)
    svg = re.sub(r'(\bid="|url\(#|href="#)', rf"\g<1>{prefix}-", svg[svg.index("<svg") :])
    label = escape(f"{picture.title}. {picture.caption}")
    return Markup(svg.replace("<svg", f'<svg role="img" aria-label="{label}"', 1))


def typeset(text: str) -> str:
    """Plain text for a picture: ``T1/Tg``, ``ξg``, ``rho`` and ``m^2`` with indices and powers."""

    def symbol(letter: str, index: str) -> str:
        name = f"\\{LETTERS[letter]}" if letter in LETTERS else letter
        return f"${name}_{{{index}}}$" if index else f"${name}$"

    return _replaced(text.replace("$", r"\$"), symbol, "$^{{{}}}$")


def typeset_html(text: str, as_given: Iterable[str] = ()) -> str:
    """The same as HTML, with all else escaped; ``as_given`` are names without symbols, the user's."""

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
