"""The rules beside the answer: a row for each on screen and page, its source and its assumptions."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from stochlin.applications.cases.codes import APPLIED, APPLY, KIND
from stochlin.applications.separation.separation import COMBINED
from stochlin.models.rules.codes import CODE_RULES
from stochlin.views.separation.words import subject_of
from stochlin.views.shared.blocks import Items, Row, Table, Text
from stochlin.views.shared.words import along, centimetres, per_cent, rule_label

if TYPE_CHECKING:
    import xarray as xr

    from stochlin.applications.cases.reading.case import Case
    from stochlin.applications.cases.separation import CaseAnswer

AS_APPLIED, COMBINATION = "the code as you apply it", "the code's combination of simulated peaks"
KINDS = {
    "simulation": "",
    "equation_3": "eq. (3) with a correlation coefficient",
    "response_spectrum": "response spectrum analysis",
    "linearization": "linearization",
    "code": "families of rules of building codes",
    KIND: AS_APPLIED,
}
GROUPS = (*KINDS.values(), COMBINATION)  # in the order in which they are shown
NAMED = {AS_APPLIED: "as you apply it", COMBINATION: "of simulated peaks"}
MORE = "'stochlin gap --all-rules' shows all other rules and codes."
NO_CODES = (
    'For a building code as you apply it write, for instance, codes = ["eurocode_8"] in [separation], '
    "and in each building displacements of your analysis and the factors of the code."
)
MARKS = (
    "Marks: S, compared with its source; C, derived and checked; P, in the text of the paper; M, not "
    "compared with its source."
)
AT_LEAST, LESS, WITHIN = "at least the answer", "less than the answer", "within error"  # verdicts
OF_TWO = "needs a second building"  # the reason why a rule is not available


class RuleLine(NamedTuple):
    """One rule as it is shown."""

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


def rows(answer: CaseAnswer) -> list[RuleLine]:
    """The rules that are shown, the answer first; for one building those that apply to one building."""
    table = answer.shown
    if answer.case.alone:
        of_two = [str(text).startswith(OF_TWO) for text in table.missing.values]
        table = table.isel(rule=~np.array(of_two))
    grouped = [(_group(answer.case, row), row) for row in along(table, "rule")]
    grouped.sort(key=lambda of_rule: GROUPS.index(of_rule[0]))
    return [_line(answer, *of_rule) for of_rule in grouped]


def _group(case: Case, row: xr.Dataset) -> str:
    """The group to which a rule belongs; a code without displacements is applied as it is."""
    kind, rule = str(row.kind.item()), str(row.rule.item())
    if kind == "code" and CODE_RULES[rule].multiplies:
        return COMBINATION
    return AS_APPLIED if rule in case.codes else KINDS[kind]


def _line(answer: CaseAnswer, group: str, row: xr.Dataset) -> RuleLine:
    meanings = answer.separation.verdict.attrs["flag_meanings"].split()
    rule, words = str(row.rule.item()), NAMED.get(group, "")
    stem = rule.removesuffix(APPLIED)
    return RuleLine(
        rule=rule,
        name=f"{stem} {words}" if words else rule,
        label=f"{rule_label(stem)}, {words}" if words else rule_label(stem),
        group=group,
        metres=float(row.gap),
        gap=centimetres(float(row.gap)),
        error=per_cent(float(row.error), sign="+") if group else "",
        probability=per_cent(float(row.no_pounding_probability), 1),
        verdict=meanings[int(row.verdict)].replace("_", " "),
        **{name: str(row[name].item()) for name in ("mark", "reference", "assumptions", "missing")},
    )


def own_codes(answer: CaseAnswer) -> list[RuleLine]:
    """The codes of the case file as its engineer applies them, and the rules with numbers of its own."""
    numbers = answer.case.wanted.of_rules()
    return [row for row in rows(answer) if row.group == AS_APPLIED or row.rule in numbers]


def rules_table(answer: CaseAnswer) -> Table:
    """A row for each rule that has a gap: on the screen by its name in files, on a page by its title."""
    about = subject_of(answer.case)
    heads = ("rule", f"{about.gap} [cm]", "error", about.column, "verdict", "mark")
    table_rows = [
        Row(
            (row.name, row.gap, row.error, row.probability, row.verdict, row.mark),
            label=row.label.removeprefix("eq. (3), "),
            group=row.group,
            look=row.verdict,
        )
        for row in rows(answer)
        if not row.missing
    ]
    return Table(heads, table_rows, words=heads[4:], minor=heads[5:])


def not_available(answer: CaseAnswer) -> Items:
    """The rules without a gap, each with the reason."""
    return Items([f"{row.name}: {row.missing}" for row in rows(answer) if row.missing])


def rules_notes(answer: CaseAnswer) -> list[Text]:
    """The meaning of the columns and marks, and the two ways to use a code."""
    about, groups = subject_of(answer.case), {row.group for row in rows(answer)}
    columns = f"Error: relative to the answer. {about.column.capitalize()}: {about.good}. {MARKS}"
    ways = {AS_APPLIED: APPLY, COMBINATION: COMBINED}
    codes = [text for group, text in ways.items() if group in groups] or [NO_CODES]
    codes = codes if answer.every_rule else [*codes, MORE]
    return [Text(note, "note") for note in (columns, " ".join(codes))]


def assumptions(answer: CaseAnswer) -> Items:
    """The assumptions and the source of each rule that has a gap."""
    return Items(
        [
            f"{row.label}: {'. '.join(filter(None, (row.assumptions, row.reference)))}."
            for row in rows(answer)[1:]
            if not row.missing
        ]
    )
