"""The statement of the analysis: what a reviewer needs on one page, with lines to sign."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stochlin.views.separation import words
from stochlin.views.separation.facts import models
from stochlin.views.separation.risk import risk_sentences
from stochlin.views.separation.subjects import subject_of
from stochlin.views.shared.blocks import Term
from stochlin.views.shared.descriptions import site_in_words, source_in_words
from stochlin.views.shared.uncertain import contained
from stochlin.views.shared.words import SPACE, scatter, shaking

if TYPE_CHECKING:
    from stochlin.analyses.cases.separation import CaseAnswer

KNOWN = "All parameters are taken as known; their errors are not in the answer."
SIGNED = ("Date", "Prepared by", "Checked by")  # by hand: the same case makes the same page


def statement(answer: CaseAnswer) -> list[Term]:
    """What was asked, by which method, with what result and error, and by which program."""
    case, table, about = answer.case, answer.separation, subject_of(answer.case)
    site = ": ".join(filter(None, (site_in_words(case), source_in_words(case))))
    said = [
        ("Result", words.headline(answer)),
        (
            "Criterion",
            f"{about.kept.capitalize()} in {words.confidence(case)} of the motions of the site, if the "
            f"{about.gap} is at least this result.",
        ),
        (
            "Error",
            f"The 95{SPACE}% interval of the {about.gap} is {words.interval(table)}. It covers the "
            f"sampling of {case.paths} motions; 'Limits of this answer' lists what it leaves out.",
        ),
        (
            "Method",
            f"Nonlinear time-history simulation of {about.the_buildings} in {case.paths} random ground "
            f"motions of {case.duration:g}{SPACE}s, Gaussian filtered noise with an envelope: "
            f"{models(case)[0]}.",
        ),
        ("Site", f"{site}. {shaking(answer.shaking, case)} {scatter(case)}".strip()),
        ("Uncertainty", contained(case, f"the {about.gap} is that") or KNOWN),
        ("Inputs", f"They are listed under 'The case', as read from {case.file}."),
        (
            "Program",
            f"stochlin {table.attrs['stochlin_version']}, seed {case.seed}. The same file and version "
            "give the same numbers.",
        ),
    ]
    if sentences := risk_sentences(answer):
        said.insert(3, ("Risk", " ".join(sentences)))
    if answer.existing is not None:
        said.insert(3, (f"Existing {about.gap}", words.existing(answer.existing, case)))
    return [Term(name, text) for name, text in said]
