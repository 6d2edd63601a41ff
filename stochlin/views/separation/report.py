"""All that ``stochlin gap`` shows of an answer, on the screen and on its page."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from stochlin.analyses.cases.rows import name_of_file
from stochlin.views.sensitivity import words as what_matters
from stochlin.views.sensitivity.pictures import draw_sensitivity
from stochlin.views.separation import facts as small_print
from stochlin.views.separation import pictures, verdict, words
from stochlin.views.separation.elevation import elevation_picture
from stochlin.views.separation.risk import risk_blocks, risk_caption, risk_figure
from stochlin.views.separation.storeys import draw_heights
from stochlin.views.separation.subjects import subject_of
from stochlin.views.shared.blocks import (
    Block,
    Items,
    Picture,
    Table,
    Term,
    Terms,
    Text,
    ViewSection,
    texts,
)
from stochlin.views.shared.page import page
from stochlin.views.shared.uncertain import unknowns
from stochlin.views.shared.words import SPACE, centimetres, doubt

if TYPE_CHECKING:
    from stochlin.analyses.cases.separation import CaseAnswer

DENSITY = "Power spectral density of the ground acceleration over period."
SPECTRUM = (
    "Response spectra of the motions and of the target. Below, the ratio with its 95 % interval; "
    "dotted, 6 % to either side."
)
SIGNED = "Date, prepared by, checked by:"  # by hand: the same case makes the same page


def answer_sections(answer: CaseAnswer) -> list[ViewSection]:
    """The answer first, then the existing gap, the risk and the rules, and the small print."""
    case, about = answer.case, subject_of(answer.case)
    missing = [f"{row.name}: {row.missing}" for row in words.rows(answer) if row.missing]
    first, *others = texts(verdict.first_lines(answer))
    return [
        ViewSection("", [doubt(answer.doubts())]),
        ViewSection("", [Text(case.title, "title")], on_screen=False),
        ViewSection("", [replace(first, look="answer"), elevation_picture(answer), *others]),
        ViewSection("", texts(verdict.cautions(answer))),
        ViewSection(f"The existing {about.gap}", words.allowances(answer)),
        ViewSection("", texts(verdict.comparisons(answer))),
        ViewSection("", texts(verdict.details(answer)), detail=True),
        ViewSection("Uncertain parameters", unknowns(case, f"the {about.gap} is that")),
        ViewSection(f"How often {about.meet}", risk_blocks(answer)),
        ViewSection("The rules and the answer", [words.rules_table(answer)], detail=True),
        ViewSection("Rules that are not available", [Items(missing)], on_page=False),
        ViewSection("", words.rules_notes(answer), detail=True),
        ViewSection("Limits of this answer", [Items(small_print.uncertainties(case))], on_screen=False),
        ViewSection("Pictures", _pictures(answer), on_screen=False, columns=True),
        ViewSection("The records", _records(answer), on_screen=False),
        ViewSection("Influence of the inputs", _influence(answer)),
        ViewSection(
            "The case", [small_print.facts(case), *small_print.case_file(case)], on_screen=False
        ),
        ViewSection("Assumptions of each rule", [_assumptions(answer)], on_screen=False, columns=True),
        ViewSection("", [Text(f"{name_of_file(case)}. {SIGNED}", "signed")], on_screen=False),
    ]


def report_page(answer: CaseAnswer) -> str:
    """The page of an answer; text of the case file is escaped."""
    case, attrs = answer.case, answer.separation.attrs
    file, names = name_of_file(case), [building.name for building in case.buildings]
    as_given = [file, case.title, *names, *case.site.records]
    footer = [attrs["references"], f"{attrs['history']}, from {file}."]
    title = f"{case.title}: {subject_of(case).page}"
    return page(title, answer_sections(answer), footer, as_given)


def _pictures(answer: CaseAnswer) -> list[Picture]:
    about = subject_of(answer.case)
    lines = "line is the elastic period" if answer.case.alone else "lines are the elastic periods"
    drawn = [
        Picture(
            f"{about.gap.capitalize()}s by rule",
            f"Each rule's {about.gap} against the answer (dashed, its 95 % interval grey). Numbers as "
            "in the table.",
            partial(pictures.rules_figure, answer),
        ),
        Picture(
            f"How often a {about.gap} is enough",
            f"Share of the simulated motions in which {about.would}. The "
            "rules stand on the curve, squares where they give less than the answer or are within "
            "error; their numbers are those of the table.",
            partial(pictures.distribution_figure, answer),
        ),
        Picture(
            f"The ground and {about.the_buildings}",
            f"{SPECTRUM if 'target' in answer.spectrum else DENSITY} The {lines} of "
            f"{about.the_buildings}; yielding lengthens {'it' if answer.case.alone else 'them'}.",
            partial(pictures.spectrum_figure, answer),
        ),
    ]
    if "height" in answer.separation.dims:
        over_height = Picture(
            "Gap over height and storey drifts",
            f"Above, the {about.gap} that is needed at each height, and the height that governs. "
            f"One {about.gap} for all heights has to be the largest of these or more, since "
            "different motions need it at different heights. Below, the drifts of storeys, and "
            "their drifts at yield.",
            partial(draw_heights, answer.table(), caption=False),
        )
        drawn.insert(1, over_height)
    if answer.risk is not None:
        title = f"How often {about.meet}"
        drawn.append(Picture(title, risk_caption(answer), partial(risk_figure, answer)))
    if answer.case.site.records:
        text = (
            f"{about.gap.capitalize()} that would just have been enough in each record, against "
            f"the answer. {about.records}"
        )
        drawn.append(Picture("Recorded motions", text.strip(), partial(pictures.records_figure, answer)))
    return drawn


def _records(answer: CaseAnswer) -> list[Block]:
    """A row for each record: the gap that it needs, and the peaks."""
    table, case = answer.separation, answer.case
    heads = {"record_separation": f"{subject_of(case).gap} [cm]"}
    where = words.meeting_level(answer)
    peaks = {1: "peak [cm]"} if case.alone else {n: f"peak {n}{where} [cm]" for n in (1, 2)}
    heads |= {f"record_peak_{n}": head for n, head in peaks.items() if f"record_peak_{n}" in table}
    rows = [
        (f"{n + 1}  {record}", *(centimetres(float(table[name][n])) for name in heads))
        for n, record in enumerate(case.site.records)
    ]
    return [Table.of(("record", *heads.values()), rows)]


def _influence(answer: CaseAnswer) -> list[Block]:
    """The influence of the inputs: sentences, a row for each input, and the picture."""
    table = answer.matters
    if table is None:
        return []
    names, quantity = words.names_of(answer), what_matters.asked(table)
    if not what_matters.rows(table, names):
        return what_matters.blocks(table, names)
    text = (
        f"Change of the {quantity} with each input at the ends of its range; lines: standard errors. "
        "Numbers and ranges as in the table."
    )
    draw = partial(draw_sensitivity, table, names, caption=False)
    picture = Picture(f"Influence of each input on the {quantity}", text, draw)
    return [*what_matters.blocks(table, names), picture]


def _assumptions(answer: CaseAnswer) -> Terms:
    """The assumptions of each rule, why it is not available, and its source and mark."""
    terms = []
    for row in words.rows(answer):
        missing = row.missing and f"Not available: {row.missing}."
        mark = row.mark and f"Mark{SPACE}{row.mark}."
        text = f"{row.assumptions and row.assumptions + '.'} {missing}"
        note = f"{row.reference and row.reference + '.'} {mark}"
        terms.append(Term(f"{row.number} {row.label}", text.strip(), note.strip()))
    return Terms(terms)
