"""The page of ``stochlin gap --report``: one self-contained HTML file."""

from __future__ import annotations

import io
import re
from collections.abc import Callable, Iterable
from itertools import groupby
from typing import TYPE_CHECKING, Any, NamedTuple

from stochlin.views.sensitivity import words as what_matters
from stochlin.views.sensitivity.pictures import draw_sensitivity
from stochlin.views.separation import facts as small_print
from stochlin.views.separation import pictures, words
from stochlin.views.separation.risk import risk_caption, risk_figure, risk_words
from stochlin.views.separation.statement import SIGNED, statement
from stochlin.views.separation.storeys import draw_heights
from stochlin.views.separation.subjects import subject_of
from stochlin.views.shared.style import STYLE
from stochlin.views.shared.symbols import typeset_html
from stochlin.views.shared.uncertain import HEADS, unknowns
from stochlin.views.shared.words import centimetres, doubted
from stochlin.views.sites.words import fit_in_words

if TYPE_CHECKING:
    import xarray as xr
    from markupsafe import Markup
    from matplotlib.figure import Figure

    from stochlin.analyses.cases.separation import CaseAnswer

KINDS = {
    "simulation": "simulation",
    "equation_3": "eq. (3) with a correlation coefficient",
    "linearization": "linearization",
    "code": "building codes and their families of rules",
}


class Picture(NamedTuple):
    """A picture with its description in words."""

    title: str
    svg: Markup
    caption: str


def report_page(answer: CaseAnswer) -> str:
    """The page of an answer: HTML with pictures and style within; text of the case file is escaped."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("stochlin.views.separation", "."),
        autoescape=True,
        undefined=StrictUndefined,
        finalize=_set_symbols(answer),
        trim_blocks=True,
        lstrip_blocks=True,
    )
    table = answer.separation
    shown = words.rows(answer)
    return environment.get_template("report.html").render(
        case=answer.case,
        subject=subject_of(answer.case),
        doubt=doubted(answer.doubts()),
        headline=words.headline(answer),
        summary=words.summary(answer),
        allowances=words.allowances(answer),
        unknowns=unknowns(answer.case),
        unknown_heads=HEADS,
        risk=risk_words(answer),
        rows=shown,
        kinds=[(KINDS[kind], list(group)) for kind, group in groupby(shown, lambda row: row.kind)],
        columns=words.columns(answer.case),
        marks=words.MARKS,
        families=words.families(answer.case),
        pictures=_pictures(answer),
        facts=_grouped(small_print.facts(answer)),
        records=_records(answer),
        matters=None if answer.matters is None else _matters(answer, answer.matters),
        uncertainties=small_print.uncertainties(answer),
        statement=statement(answer),
        signed=SIGNED,
        references=table.attrs["references"],
        history=table.attrs["history"],
    )


def _set_symbols(answer: CaseAnswer) -> Callable[[Any], Any]:
    """A function that typesets the symbols of a text, except in names of the user."""
    from markupsafe import Markup

    case = answer.case
    as_given = [case.file, case.title, *(building.name for building in case.buildings), *case.records]

    def typeset(value: Any) -> Any:
        plain = isinstance(value, str) and not isinstance(value, Markup)
        return Markup(typeset_html(value, as_given)) if plain else value

    return typeset


def _pictures(answer: CaseAnswer) -> list[Picture]:
    gap, about = centimetres(float(answer.separation.gap[0])), subject_of(answer.case)
    lines = "lines are the elastic periods" if not answer.case.alone else "line is the elastic period"
    drawn = [
        (
            f"{about.gap.capitalize()}s by rule",
            pictures.rules_figure,
            f"Each rule's {about.gap} against the answer, {gap} cm (dashed, its 95 % interval grey). "
            "Numbers as in the table.",
        ),
        (
            f"How often a {about.gap} is enough",
            pictures.distribution_figure,
            f"Share of the simulated motions in which {about.would}. The "
            "rules stand on the curve, squares where they are unsafe or within error; their numbers are "
            "those of the table.",
        ),
        (
            f"The ground and {about.the_buildings}",
            pictures.spectrum_figure,
            f"{_of_site(answer)} The {lines} of {about.the_buildings}; yielding lengthens "
            f"{'it' if answer.case.alone else 'them'}.",
        ),
    ]
    if "height" in answer.separation.dims:
        drawn.insert(
            1,
            (
                "Gap over height and storey drifts",
                lambda answer: draw_heights(answer.table(), caption=False),
                f"Above, the {about.gap} that is needed at each height, and the height that governs. "
                f"One {about.gap} for all heights has to be the largest of these or more, since "
                "different motions need it at different heights. Below, the drifts of storeys, and "
                "their drifts at yield.",
            ),
        )
    if answer.risk is not None:
        drawn.append((f"How often {about.meet}", risk_figure, risk_caption(answer)))
    if answer.case.records:
        drawn.append(
            (
                "Recorded motions",
                pictures.records_figure,
                f"{about.gap.capitalize()} that would just have been enough in each record, against "
                f"the answer. {about.records}".strip(),
            )
        )
    return [
        Picture(title, _svg(draw, answer, f"p{n}", f"{title}. {text}"), text)
        for n, (title, draw, text) in enumerate(drawn, start=1)
    ]


def _matters(answer: CaseAnswer, table: xr.Dataset) -> dict[str, Any]:
    """The influence of the inputs: sentences, a row for each input, the columns and the picture."""
    names, quantity = words.names_of(answer), what_matters.asked(table)
    text = (
        f"Change of the {quantity} with each input at the ends of its range; lines: standard errors. "
        "Numbers and ranges as in the table."
    )
    picture = _svg(
        lambda _: draw_sensitivity(table, names, caption=False),
        answer,
        "m",
        f"Influence of the inputs. {text}",
    )
    return {
        "sentences": what_matters.sentences(table, names),
        "rows": what_matters.rows(table, names),
        "asked": quantity,
        "shares": bool(table.uncertain.any()),
        "note": what_matters.note(table),
        "picture": Picture(f"Influence of each input on the {quantity}", picture, text),
    }


def _of_site(answer: CaseAnswer) -> str:
    sentences = fit_in_words(answer.spectrum)
    if not sentences:
        return "Power spectral density of the ground acceleration over period."
    return " ".join([*sentences, "Below, the ratio with its 95 % interval; dotted, 6 % to either side."])


def _svg(draw: Callable[[CaseAnswer], Figure], answer: CaseAnswer, prefix: str, text: str) -> Markup:
    """A picture for HTML: without prolog, with ids of its own, and with its text for screen readers."""
    import matplotlib as mpl
    from markupsafe import Markup, escape

    with mpl.rc_context(STYLE | pictures.PAGE_STYLE), io.StringIO() as stream:
        draw(answer).savefig(stream, format="svg", metadata={"Date": None})
        svg = stream.getvalue()
    svg = re.sub(r"<metadata>.*?</metadata>", "", svg[svg.index("<svg") :], flags=re.DOTALL)
    svg = re.sub(r"<!--.*?-->\n?", "", svg, flags=re.DOTALL)
    svg = re.sub(r'(\bid="|url\(#|href="#)', rf"\g<1>{prefix}-", svg)
    return Markup(svg.replace("<svg", f'<svg role="img" aria-label="{escape(text)}"', 1))


def _grouped(facts: Iterable[tuple[str, str, str]]) -> list[tuple[str, list[tuple[str, str]]]]:
    return [
        (group, [(name, value) for _, name, value in members])
        for group, members in groupby(facts, lambda fact: fact[0])
    ]


def _records(answer: CaseAnswer) -> list[tuple[str, list[str]]]:
    """Name of each record, and its gap and the peaks in cm."""
    table = answer.separation
    known = ("record_separation", "record_peak_1", "record_peak_2")
    names = [name for name in known if name in table]
    return [
        (record, [centimetres(float(table[name][n])) for name in names])
        for n, record in enumerate(answer.case.records)
    ]
