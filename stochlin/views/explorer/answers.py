"""What the explorer shows of a case, computed in a process beside the page and written as HTML."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from stochlin.applications.cases.examples import short_example
from stochlin.applications.cases.rows import pair_of
from stochlin.applications.explorer.answers import (
    PATHS_OF_ANSWER,
    OnGround,
    correlations,
    gap_by_few_motions,
)
from stochlin.applications.explorer.uploads import read_upload, uploaded
from stochlin.kernels.basics.parallel import Progress
from stochlin.views.separation.report import first_sections
from stochlin.views.separation.words import rules_sections
from stochlin.views.shared.blocks import Picture, TextBlock, ViewSection
from stochlin.views.shared.inches import sections_with_inches
from stochlin.views.shared.page import page
from stochlin.views.shared.style import CURVES, label_axis, legend_above, open_frame

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stochlin.applications.cases.reading.case import Case

MARKERS_OF_GROUNDS = "o", "s"
RHO_CAPTION = (
    "Building 1 stays, and the period of building 2 changes. Lines: linearization. Points: "
    "simulation, with 95 % intervals. The white noise is as strong as the ground of the case at "
    "the period of building 1. The vertical line is the ratio of the case."
)


def get_ready(progress: Progress) -> str:
    """Answer the example, so that libraries are loaded and code is compiled before a change."""
    text = short_example()
    upload = uploaded({"case.toml": text.encode()})
    try:
        return gap_of(upload.folder, upload.name, text, progress)
    finally:
        upload.remove()


def gap_of(folder: str, name: str, text: str, progress: Progress) -> str:
    """The gap, its picture and the rules for a case of this text, as `stochlin gap` has them."""
    case, doubts = read_upload(folder, name, text)
    answer = gap_by_few_motions(case, progress)
    of_few = (
        f"From {PATHS_OF_ANSWER} motions; 'stochlin gap' takes more for the saved case where it "
        "needs them."
    )
    sections = [
        *first_sections(answer),
        *sections_with_inches(case, rules_sections(answer)),
        ViewSection("", [TextBlock(of_few * (case.simulated.motions > PATHS_OF_ANSWER), "note")]),
    ]
    return _html(case, doubts, sections, "gap")


def correlation_of(folder: str, name: str, text: str, progress: Progress) -> str:
    """The correlation over the ratio of periods, on the ground of the case and on a broad band."""
    case, doubts = read_upload(folder, name, text)
    ratio = pair_of(case)[1].period / pair_of(case)[0].period
    grounds = list(correlations(case, progress))
    picture = Picture(
        "Correlation of the displacements", RHO_CAPTION, partial(_drawn, grounds, ratio)
    )
    sentences = [TextBlock(_in_words(ground, ratio)) for ground in grounds]
    return _html(case, doubts, [ViewSection("", [*sentences, picture])], "rho")


def _html(case: Case, doubts: list[str], sections: list[ViewSection], prefix: str) -> str:
    """Warnings on the file, and the sections; names of the case are the user's."""
    as_given = [case.title, *(building.name for building in case.buildings), *case.site.records]
    warned = ViewSection("", [TextBlock(f"Warning: {text}", "doubt") for text in doubts])
    return page("", [warned, *sections], [], as_given, "sections.html", prefix)


def _in_words(on: OnGround, ratio: float) -> str:
    """The correlation of the case itself."""
    simulated = on.simulated.sel(period_ratio=ratio, method="nearest")
    linearized = float(on.linearized.sel(period_ratio=ratio, method="nearest"))
    return (
        f"On {on.ground}: rho = {linearized:.2f} linearized and {float(simulated.rho):.2f} ± "
        f"{2 * float(simulated.rho_standard_error):.2f} simulated, at T2/T1 = {ratio:.3g}."
    )


def _drawn(grounds: list[OnGround], ratio: float) -> Figure:
    """Lines and points of each ground over the ratio of the periods."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.2, 4.0), layout="constrained")
    axes = figure.add_subplot()
    open_frame(axes)
    for (color, dash), marker, on in zip(CURVES, MARKERS_OF_GROUNDS, grounds, strict=False):
        axes.plot(on.linearized.period_ratio, on.linearized, color=color, ls=dash, label=on.ground)
        axes.errorbar(
            on.simulated.period_ratio, on.simulated.rho, 2 * on.simulated.rho_standard_error,
            fmt=marker, ms=4, color=color, mfc="white", capsize=2,
        )  # fmt: skip
    axes.axvline(ratio, color="0.5", lw=0.9)
    label_axis(axes, "x", grounds[0].linearized.period_ratio)
    label_axis(axes, "y", grounds[0].linearized)
    legend_above(axes)
    return figure


TABS = {"Gap": gap_of, "Correlation": correlation_of}
READY = "ready"
QUESTIONS = {READY: get_ready, **TABS}
