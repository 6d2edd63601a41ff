"""Sections as a page: one self-contained HTML file."""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from itertools import count
from typing import TYPE_CHECKING, Any

from stochlin.views.shared.blocks import PICTURE_FORMATS, Picture, ViewSection, typeset_html

if TYPE_CHECKING:
    from markupsafe import Markup

PAGE_STYLE = {"font.size": 10, "hatch.linewidth": 0.7, "svg.fonttype": "path"}


def page(
    title: str,
    sections: Sequence[ViewSection],
    footer: Sequence[str],
    as_given: Sequence[str] = (),
    template: str = "page.html",
    prefix: str = "p",
) -> str:
    """HTML with pictures and style within; ``as_given`` are names without symbols, the user's.

    The template ``"sections.html"`` is that of the sections alone, for another page that has the
    style; their ids begin with the prefix.
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
    """A picture for HTML: without prolog, with ids of its own and its text for screen readers."""
    import matplotlib as mpl
    from markupsafe import Markup, escape

    from stochlin.views.shared.style import STYLE

    with mpl.rc_context(STYLE | PAGE_STYLE), io.StringIO() as stream:
        picture.draw().savefig(stream, format="svg", metadata=PICTURE_FORMATS[".svg"])
        svg = stream.getvalue()
    svg = re.sub(r"<metadata>.*?</metadata>|<!--.*?-->\n?", "", svg, flags=re.DOTALL)
    svg = re.sub(r'(\bid="|url\(#|href="#)', rf"\g<1>{prefix}-", svg[svg.index("<svg") :])
    label = escape(f"{picture.title}. {picture.caption}")
    return Markup(svg.replace("<svg", f'<svg role="img" aria-label="{label}"', 1))
