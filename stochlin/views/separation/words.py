"""An answer about a gap in plain words and short numbers, for the screen and the page."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from stochlin.analyses.cases.codes import APPLIED, KIND, applied_in_words
from stochlin.analyses.separation.separation import COMBINED
from stochlin.models.rules.codes import CODE_RULES
from stochlin.views.separation.subjects import subject_of
from stochlin.views.shared.blocks import Block, Items, Row, Table, Text, texts
from stochlin.views.shared.words import (
    SPACE,
    along,
    centimetres,
    in_g,
    per_cent,
    rule_label,
    with_interval,
)

if TYPE_CHECKING:
    import xarray as xr

    from stochlin.analyses.cases.reading.case import Case
    from stochlin.analyses.cases.separation import CaseAnswer

# Groups of rules, in the order in which they are shown.
FORMULAS, FAMILY = "eq. (3) with a correlation coefficient", "families of rules of building codes"
AS_APPLIED, COMBINATION = "the code as you apply it", "the code's combination of simulated peaks"
SPECTRUM = "response spectrum analysis"
GROUPS = ("", FORMULAS, SPECTRUM, "linearization", FAMILY, AS_APPLIED, COMBINATION)
KINDS = {
    "simulation": "",
    "equation_3": FORMULAS,
    "response_spectrum": SPECTRUM,
    "linearization": "linearization",
    "code": FAMILY,
    KIND: AS_APPLIED,
}
NAMED = {AS_APPLIED: "as you apply it", COMBINATION: "of simulated peaks"}
MORE = "'stochlin gap --all-rules' shows all other rules and codes."
NO_CODES = (
    'For a building code as you apply it write, for instance, codes = ["eurocode_8"] in [separation], '
    "and in each building displacements of your analysis and the factors of the code."
)
NOT_COMPARED = "not compared with its source"  # what the mark M says
MARKS = (
    "Marks: S, formula seen in a copy of its source; C, derived and checked; P, in the text of the "
    f"paper that was available; M, {NOT_COMPARED}, with a high or a low confidence that it agrees."
)
AT_LEAST, LESS, WITHIN = "at least the answer", "less than the answer", "within error"  # verdicts
ANY = "any of those searched"
OF_TWO = "needs a second building"  # the reason why a rule is not available
SHOWN_TEXTS = ("mark", "reference", "assumptions", "missing")


class RuleLine(NamedTuple):
    """One rule as it is shown."""

    number: int
    rule: str  # as in the dataset
    name: str  # on the screen
    label: str  # as in a text
    group: str
    metres: float
    gap: str
    error: str
    probability: str
    verdict: str
    mark: str
    reference: str
    assumptions: str
    missing: str

    @property
    def remark(self) -> str:
        """That the rule was not compared with its source, to stand behind its name."""
        return f" ({NOT_COMPARED})" if "M" in self.mark else ""


def meeting_level(answer: CaseAnswer) -> str:
    """The level at which both buildings could meet, to which peaks refer; empty if it is not known."""
    if answer.case.alone:
        return ""
    table, buildings = answer.separation, answer.case.buildings
    known = table.height[-1:] if "height" in table.dims else [b.height or np.nan for b in buildings]
    level = float(np.min(known))
    return f" at {level:.4g}{SPACE}m" if np.isfinite(level) else ""


def of_each(table: xr.Dataset, name: str) -> list[float]:
    """A number for each building of the case."""
    return [float(table[f"{name}_{n}"]) for n in (1, 2) if f"{name}_{n}" in table]


def ductilities(table: xr.Dataset) -> str:
    """Mean peak ductilities of the buildings."""
    values = of_each(table, "ductility")
    texts = ["none (elastic)" if np.isnan(v) else f"{v:.1f}".replace("inf", "infinite") for v in values]
    return " and ".join(texts)


def rows(answer: CaseAnswer) -> list[RuleLine]:
    """The rules that are shown, the answer first; for one building those that apply to one building."""
    table = answer.shown
    if answer.case.alone:
        of_two = [str(text).startswith(OF_TWO) for text in table.missing.values]
        table = table.isel(rule=~np.array(of_two))
    grouped = [(_group(answer.case, row), row) for row in along(table, "rule")]
    grouped.sort(key=lambda of_rule: GROUPS.index(of_rule[0]))
    return [_line(answer, n, *of_rule) for n, of_rule in enumerate(grouped, start=1)]


def _group(case: Case, row: xr.Dataset) -> str:
    """The group to which a rule belongs; a code without displacements is applied as it is."""
    kind, rule = str(row.kind.item()), str(row.rule.item())
    if kind == "code" and CODE_RULES[rule].multiplies:
        return COMBINATION
    return AS_APPLIED if rule in case.codes else KINDS[kind]


def _line(answer: CaseAnswer, number: int, group: str, row: xr.Dataset) -> RuleLine:
    meanings = answer.separation.verdict.attrs["flag_meanings"].split()
    rule = str(row.rule.item())
    stem, words = rule.removesuffix(APPLIED), NAMED.get(group, "")
    label = subject_of(answer.case).labels.get(rule, rule_label(stem))
    return RuleLine(
        number=number,
        rule=rule,
        name=f"{stem} {words}" if words else rule,
        label=f"{label}, {words}" if words else label,
        group=group,
        metres=float(row.gap),
        gap=centimetres(float(row.gap)),
        error=per_cent(float(row.error), sign="+") if number > 1 else "",
        probability=per_cent(float(row.no_pounding_probability), 1),
        verdict=meanings[int(row.verdict)].replace("_", " "),
        **{name: str(row[name].item()) for name in SHOWN_TEXTS},
    )


def rules_table(answer: CaseAnswer) -> Table:
    """A row for each rule: on the screen by its name in files, on a page by its number and title."""
    about = subject_of(answer.case)
    heads = ("rule", f"{about.gap} [cm]", "error", about.column, "verdict", "mark")
    table_rows = [
        Row(
            (row.name, row.gap, row.error, row.probability, row.verdict, row.mark),
            label=f"{row.number}{SPACE}{SPACE}{row.label.removeprefix('eq. (3), ')}{row.remark}",
            group=row.group,
            look=row.verdict,
        )
        for row in rows(answer)
    ]
    return Table(heads, table_rows, words=heads[4:], minor=heads[5:])


def rules_caption(answer: CaseAnswer) -> str:
    """Which rows are a code as its engineer applies it, and which are its combination of peaks."""
    told = {AS_APPLIED: applied_in_words(answer.case), COMBINATION: COMBINED}
    groups = {row.group for row in rows(answer)}
    sentences = [text for group, text in told.items() if group in groups] or [NO_CODES]
    return " ".join(sentences if answer.every_rule else [*sentences, MORE])


def rules_notes(answer: CaseAnswer) -> list[Text]:
    """The two ways to use a code, and the meaning of the columns and marks."""
    about = subject_of(answer.case)
    columns = (
        f"Error: the rule's {about.gap} relative to the answer. "
        f"{about.column.capitalize()}: share of the simulated motions in which {about.share}. Within "
        "error: the difference is within the error of the simulation."
    )
    notes = rules_caption(answer), about.rules, columns, MARKS
    return [Text(note, "note") for note in notes]


def names_of(answer: CaseAnswer) -> dict[str, str]:
    """The names of the models of the case."""
    buildings = enumerate(answer.case.buildings, start=1)
    return {**{f"structure_{n}": building.name for n, building in buildings}, "ground": "the ground"}


def confidence(case: Case) -> str:
    """The required probability of no pounding."""
    return f"{100 * case.wanted.confidence:.4g}{SPACE}%"


def allowances(answer: CaseAnswer) -> list[Block]:
    """Changes that make the existing gap sufficient, or the limits up to which it is."""
    if answer.existing is None:
        return []
    limits, about = answer.existing, subject_of(answer.case)
    changes = _strength(limits, answer.separation)
    changes |= {"shaking": _shaking(answer.case, limits), "damping": _damping(answer.case, limits)}
    known = [f"{name.capitalize()}: {text}" for name, text in changes.items() if text]
    none = " or ".join(name for name, text in changes.items() if not text)
    begin = f"Each of these changes alone would make the existing {about.gap} sufficient:"
    if float(limits.required_gap) <= float(limits.attrs["gap_m"]):
        begin = f"The existing {about.gap} stays sufficient up to these values, each changed alone:"
    return [
        *texts([begin] if known else []),
        Items(known),
        *texts([f"No {none} that was searched is sufficient alone."] if none else []),
        Text(f"Searched: {limits.attrs['searched']}. In brackets: 95 % intervals.", "note"),
    ]


def _shaking(case: Case, limits: xr.Dataset) -> str:
    """The strongest sufficient shaking, as the site states its strength; empty if none is."""
    now, strongest = float(case.site.ground.arrays()["intensity"]), float(limits.largest_intensity)
    if not np.isfinite(strongest):
        return ANY if np.isinf(strongest) else ""
    if "intensity" in case.site.form.table:
        return f"S0 up to {_with_interval(limits, 'largest_intensity')} m²/s³ (now {now:.3g})"
    key, value = case.site.stated_strength
    factor = np.sqrt(strongest / now)
    shown = f", {key} = {value * factor:.3g}" if key == "scale" else f", {key} = {in_g(value * factor)}"
    times = _with_interval((limits / now) ** 0.5, "largest_intensity")
    return f"up to {times} times as strong{shown if key else ''}"


def _damping(case: Case, limits: xr.Dataset) -> str:
    """The least added damping that is sufficient; empty if none is."""
    damping, low, high = with_interval(limits, "least_added_damping")
    if not damping:
        return "no additional damping is needed"
    bracket = f" [{per_cent(low, 1)} to {per_cent(high, 1)}]" if low < high else ""
    more = f"at least {per_cent(damping, 1)}{bracket} more{'' if case.alone else ' in both'}"
    return more if np.isfinite(damping) else ""


def _strength(limits: xr.Dataset, table: xr.Dataset) -> dict[str, str]:
    """The sufficient strengths, an empty text if none is; nothing for buildings that never yield."""
    factors = of_each(table, "reduction_factor")
    yielding = [n for n, now in enumerate(factors, start=1) if np.isfinite(now)]
    if not yielding:
        return {}
    now = " and ".join(f"{factors[n - 1]:.3g}" for n in yielding)
    least, largest = (
        " and ".join(_with_interval(limits, f"{which}_reduction_factor", f"_{n}") for n in yielding)
        for which in ("least", "largest")
    )
    first = yielding[0]
    low, high = (float(limits[f"{end}_reduction_factor_{first}"]) for end in ("least", "largest"))
    begin = f"from {least} " if low > 0 else ""
    text = f"R {begin}up to {largest} (now {now})"
    if np.isinf(high):
        text = f"R {begin}on (now {now})" if begin else ANY
    return {"strength": "" if np.isnan(high) else text}


def _with_interval(table: xr.Dataset, name: str, of: str = "") -> str:
    """A value and its 95 % interval."""
    value, low, high = with_interval(table, name, of)
    return f"{value:.3g} [{low:.3g} to {high:.3g}]" if low < high else f"{value:.3g}"
