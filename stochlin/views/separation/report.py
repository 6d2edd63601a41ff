"""All that ``stochlin gap`` shows of an answer, on the screen and on its page."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from stochlin._version import __version__
from stochlin.applications.cases.shaking import doubts
from stochlin.views.sensitivity import tornado
from stochlin.views.separation import pictures, words
from stochlin.views.separation.risk import risk_blocks
from stochlin.views.shared.blocks import (
    Block,
    Items,
    Picture,
    TableBlock,
    TextBlock,
    ViewSection,
    texts,
)
from stochlin.views.shared.inches import sections_with_inches
from stochlin.views.shared.page import page
from stochlin.views.shared.words import centimetres, doubt, over_records, with_uncertainty
from stochlin.views.sites.pictures import draw_spectrum

if TYPE_CHECKING:
    from stochlin.applications.cases.separation import CaseAnswer

SPECTRUM = "Response spectra of the motions and of the target. Vertical: elastic periods."


def first_sections(answer: CaseAnswer) -> list[ViewSection]:
    """Doubts, the answer with its picture, and cautions."""
    first, *others = texts(words.first_lines(answer))
    sections = [
        ViewSection("", [doubt(answer.case.doubts)], on_screen=False),  # printed as warnings there
        ViewSection("", [doubt(doubts(answer.shaking))]),
        ViewSection("", [TextBlock(answer.case.title, "title")], on_screen=False),
        ViewSection(
            "", [replace(first, look="answer"), pictures.elevation_picture(answer), *others]
        ),
        ViewSection("", texts(words.taken(answer.case))),
        ViewSection("", texts(words.cautions(answer))),
    ]
    return sections_with_inches(answer.case, sections)


def answer_sections(answer: CaseAnswer) -> list[ViewSection]:
    """The answer first, then the existing gap, the rules and the risk, and the small print."""
    case = answer.case
    about = words.subject_of(answer.case)
    matters = answer.matters
    influence = [] if matters is None else tornado.blocks(matters, words.names_of(answer))
    sections = [
        ViewSection(f"The existing {about.gap}", words.allowances(answer)),
        ViewSection("", words.details(answer), on_page=False, detail=True),
        ViewSection("", words.details(answer, on_page=True), on_screen=False),
        ViewSection(
            "Uncertain parameters", [TextBlock(with_uncertainty(case, f"the {about.gap} is that"))]
        ),
        ViewSection(f"How often {about.meet}", risk_blocks(answer)),
        ViewSection("The records", [_records(answer)]),
        *words.rules_sections(answer),
        ViewSection("Pictures", _pictures(answer), on_screen=False, columns=True),
        ViewSection("Influence of the inputs", influence),
        ViewSection(
            "Method", [Items(words.method(case)), words.assumptions(answer)], on_screen=False
        ),
        ViewSection("The case", words.case_file(case), on_screen=False),
        ViewSection("", [TextBlock(words.signed(answer), "signed")], on_screen=False),
    ]
    return [*first_sections(answer), *sections_with_inches(case, sections)]


def report_page(answer: CaseAnswer) -> str:
    """The page of an answer; text of the case file is escaped."""
    case = answer.case
    names = [building.name for building in answer.case.buildings]
    as_given = [case.whole.table.source.name, case.title, *names, *case.site.records]
    footer = [answer.separation.attrs["references"], f"stochlin {__version__}."]
    title = f"{case.title}: the {words.subject_of(case).gap}"
    return page(title, answer_sections(answer), footer, as_given)


def _pictures(answer: CaseAnswer) -> list[Picture]:
    """What the sentences and tables of the page do not say."""
    about = words.subject_of(answer.case)
    drawn = []
    if answer.separation.sizes.get("height", 0) > 1:
        caption = (
            "One gap for all heights is larger: different motions need it at different heights."
        )
        draw = partial(pictures.draw_heights, answer.table(), caption=False)
        drawn.append(Picture(f"The {about.gap} over the height", caption, draw))
    draw = partial(pictures.distribution_figure, answer)
    drawn.append(Picture(f"{about.good.capitalize()}, by the {about.gap}", "", draw))
    if "target" in answer.spectrum:
        draw = partial(draw_spectrum, answer.spectrum, False, answer.case.periods)
        drawn.append(Picture(f"The ground and {about.the_buildings}", SPECTRUM, draw))
    return drawn


def _records(answer: CaseAnswer) -> Block:
    """A row for each record with the gap that it needs and the peaks; a sentence of many."""
    table = answer.separation
    case = answer.case
    gap = words.subject_of(answer.case).gap
    if answer.over_records is not None:
        count = len(case.site.records)
        return TextBlock(over_records(answer.over_records, count, float(table.gap[0]), gap))
    heads = {"record_separation": f"{gap} [cm]"}
    where = words.contact_level(answer)
    peaks = {1: "peak [cm]"} if case.alone else {n: f"peak {n}{where} [cm]" for n in (1, 2)}
    heads |= {f"record_peak_{n}": head for n, head in peaks.items() if f"record_peak_{n}" in table}
    rows = [
        (record, *(centimetres(float(table[name][n])) for name in heads))
        for n, record in enumerate(case.site.records)
    ]
    return TableBlock.of(("record", *heads.values()), rows)
