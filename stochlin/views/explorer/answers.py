"""What the explorer shows of a case, computed in a process beside the page and written as HTML."""

from __future__ import annotations

from dataclasses import replace

import xarray as xr

from stochlin.applications.cases.examples import short_example
from stochlin.applications.cases.reading.case import Case
from stochlin.applications.cases.rows import gap_of
from stochlin.applications.cases.separation import CaseAnswer, answer_case
from stochlin.applications.explorer.uploads import read_upload, uploaded
from stochlin.kernels.basics.parallel import Progress
from stochlin.solver.simulation.finite_motions import keeping_apart
from stochlin.views.separation.report import first_sections
from stochlin.views.separation.words import rules_sections
from stochlin.views.shared.blocks import Text, ViewSection
from stochlin.views.shared.page import page

PATHS = 256  # motions


def get_ready(progress: Progress) -> None:
    """Answer the example, so that libraries are loaded and code is compiled before a change."""
    upload = uploaded({"case.toml": short_example().encode()})
    page_of(upload.folder, upload.name, upload.text, progress)
    upload.remove()


def by_few_motions(case: Case, progress: Progress | None = None) -> CaseAnswer:
    """The answer of `answer_case` with few motions, without what would make an existing gap sufficient.

    The search for that takes longer than all else.
    """
    few = replace(case, simulated=replace(case.simulated, paths=min(case.simulated.motions, PATHS)))
    answer = answer_case(replace(few, wanted=replace(case.wanted, existing=[])), progress)
    if not (gap := gap_of(case)):
        return answer
    existing = xr.Dataset(keeping_apart(answer.separation.separation_samples, gap))
    return replace(answer, case=few, existing=existing.assign_attrs(gap_m=gap))


def page_of(folder: str, name: str, text: str, progress: Progress) -> str:
    """The gap, its picture and the rules for a case of this text, as ``stochlin gap`` has them."""
    case, doubts = read_upload(folder, name, text)
    answer = by_few_motions(case, progress)
    of_few = f"From {PATHS} motions; 'stochlin gap' takes more for the saved case where it needs them."
    sections = [
        ViewSection("", [Text(f"Warning: {text}", "doubt") for text in doubts]),
        *first_sections(answer),
        *rules_sections(answer),
        ViewSection("", [Text(of_few * (case.simulated.motions > PATHS), "note")]),
    ]
    # Names of the case are the user's.
    as_given = [case.title, *(building.name for building in case.buildings), *case.site.records]
    return page("", sections, [], as_given, "sections.html", "gap")
