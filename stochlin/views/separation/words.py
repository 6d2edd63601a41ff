"""An answer about a gap in plain words and short numbers, for the screen and the page."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from stochlin.analyses.cases.codes import APPLIED, KIND, applied_in_words
from stochlin.analyses.cases.storeys import StoreyBuilding
from stochlin.analyses.separation.separation import COMBINED
from stochlin.models.rules.codes import CODE_RULES
from stochlin.views.separation.subjects import subject_of
from stochlin.views.shared.blocks import Block, Items, Row, Table, Text
from stochlin.views.shared.words import (
    SPACE,
    along,
    centimetres,
    floors,
    length,
    over_records,
    per_cent,
    rule_label,
    scatter,
    shaking,
    with_interval,
)
from stochlin.views.sites.words import fit_in_words

if TYPE_CHECKING:
    import xarray as xr

    from stochlin.analyses.cases.case import Case
    from stochlin.analyses.cases.separation import CaseAnswer

# Groups of rules, in the order in which they are shown.
FORMULAS, FAMILY = "eq. (3) with a correlation coefficient", "families of rules of building codes"
AS_APPLIED, COMBINATION = "the code as you apply it", "the code's combination of simulated peaks"
GROUPS = ("", FORMULAS, "linearization", FAMILY, AS_APPLIED, COMBINATION)
KINDS = {
    "simulation": "",
    "equation_3": FORMULAS,
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
MARKS = (
    "Marks: S, formula seen in a copy of its source; C, derived and checked; P, in the text of the "
    "paper that was available; M, not compared with its source."
)
FAMILIES = (
    "SRSS, root of the sum of squared displacements; sum, a factor times "
    "their sum; height, a factor times the height; fixed, a distance."
)
MOST_SHOWN = 4  # heights at which the gap is told
ALIKE, MUCH = 0.05, 10.0  # gap over peak of buildings that move alike; ductility that is doubtful
OF_TWO = "needs a second building"  # the reason why a rule is not available
SHOWN_TEXTS = ("family", "mark", "reference", "assumptions", "missing")


class RuleLine(NamedTuple):
    """One rule as it is shown."""

    number: int
    rule: str  # as in the dataset
    name: str  # on the screen
    label: str  # as in a text
    group: str
    family: str
    gap: str
    error: str
    probability: str
    verdict: str
    mark: str
    reference: str
    assumptions: str
    missing: str


def _of_each(table: xr.Dataset, name: str) -> list[float]:
    """A number for each building of the case."""
    return [float(table[f"{name}_{n}"]) for n in (1, 2) if f"{name}_{n}" in table]


def ductilities(table: xr.Dataset) -> str:
    """Mean peak ductilities of the buildings."""
    texts = [f"{v:.1f}" if np.isfinite(v) else "none (elastic)" for v in _of_each(table, "ductility")]
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
        gap=centimetres(float(row.gap)),
        error=per_cent(float(row.error), sign="+") if number > 1 else "",
        probability=per_cent(float(row.no_pounding_probability), 1),
        verdict=meanings[int(row.verdict)].replace("_", " "),
        **{name: str(row[name].item()) for name in SHOWN_TEXTS},
    )


def rules_table(answer: CaseAnswer) -> Table:
    """A row for each rule: on the screen by its name in files, on a page by its number and title."""
    about = subject_of(answer.case)
    heads = ("rule", f"{about.gap} [cm]", "error", about.column, "verdict", "mark", "family")
    table_rows = [
        Row(
            (row.name, row.gap, row.error, row.probability, row.verdict, row.mark, row.family),
            label=f"{row.number}{SPACE}{SPACE}{row.label.removeprefix('eq. (3), ')}",
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
    """The two ways to use a code, and the meaning of the columns, marks and families."""
    about = subject_of(answer.case)
    columns = (
        f"Error: the rule's {about.gap} relative to the answer; negative is unsafe. "
        f"{about.column.capitalize()}: share of the simulated motions in which {about.share}. Within "
        "error: the difference is within the error of the simulation."
    )
    return [
        Text(text, "note")
        for text in (
            rules_caption(answer),
            about.rules,
            columns,
            MARKS,
            f"{about.families}: {FAMILIES}",
        )
    ]


def names_of(answer: CaseAnswer) -> dict[str, str]:
    """The names of the models of the case."""
    buildings = enumerate(answer.case.buildings, start=1)
    return {**{f"structure_{n}": building.name for n, building in buildings}, "ground": "the ground"}


def headline(answer: CaseAnswer) -> str:
    """The answer in one sentence."""
    names = " and ".join(building.name for building in answer.case.one_or_two)
    gap = length(float(answer.separation.gap[0]))
    return f"{names} {subject_of(answer.case).stand.format(gap=gap)}."


def confidence(case: Case) -> str:
    """The required probability of no pounding."""
    return f"{100 * case.confidence:.4g}{SPACE}%"


def interval(table: xr.Dataset) -> str:
    """The interval of the answer, of 95 %."""
    _, low, high = with_interval(table.isel(rule=0), "gap")
    if np.isfinite(high):
        return f"{centimetres(low)} to {length(high)}"
    return f"{length(low)} or more; the motions are too few for an upper end"


def summary(answer: CaseAnswer) -> list[str]:
    """The meaning of the answer, its confidence, and the results of the rules."""
    case, table, about = answer.case, answer.separation, subject_of(answer.case)
    sentences = [
        floors(case),
        f"With that {about.gap} {about.kept} in {confidence(case)} of motions like the one "
        f"described. This comes from simulating {case.paths} such motions; the 95{SPACE}% interval of "
        f"the {about.gap} is {interval(table)}.",
        shaking(answer.shaking, case),
        scatter(case),
        _heights(answer),
        _alike(table),
        _yielding(table),
        _storeys(answer),
        _verdicts(answer),
    ]
    if answer.existing is not None and case.gap is not None:
        sentences.append(existing(answer.existing, case))
    if answer.over_records is not None:
        gap = float(table.gap[0])
        sentences.append(over_records(answer.over_records, len(case.records), gap, about.gap))
    elif case.records:
        gaps = ", ".join(
            f"{name} {length(float(gap))}"
            for name, gap in zip(case.records, table.record_separation.values, strict=True)
        )
        sentences.append(f"In the recorded motions {about.they} would have needed: {gaps}.")
    sentences += [f"Record {name}: {text}" for name, text in answer.doubts_of_records().items()]
    sentences.append(" ".join(fit_in_words(answer.spectrum, answer.case.periods)))
    return [sentence for sentence in sentences if sentence]


def allowances(answer: CaseAnswer) -> list[Block]:
    """Changes that make the existing gap sufficient, or the limits up to which it is."""
    if answer.existing is None:
        return []
    limits, case, about = answer.existing, answer.case, subject_of(answer.case)
    enough = float(limits.required_gap) <= float(limits.attrs["gap_m"])
    now = float(case.ground.arrays()["intensity"])
    intensity = float(limits.largest_intensity)
    damping, low, high = with_interval(limits, "least_added_damping")
    bracket = f" [{per_cent(low, 1)} to {per_cent(high, 1)}]" if low < high else ""
    more = f"at least {per_cent(damping, 1)}{bracket} more{'' if case.alone else ' in both'}"
    more = more if damping else "no additional damping is needed"
    strongest = f"S0 up to {_with_interval(limits, 'largest_intensity')} m²/s³ (now {now:.3g})"
    begin = (
        f"The existing {about.gap} stays sufficient up to these values, each changed alone:"
        if enough
        else f"Each of these changes alone would make the existing {about.gap} sufficient:"
    )
    changes = [f"Shaking: {_limit(intensity, strongest)}", f"Damping: {_limit(damping, more)}"]
    note = f"Searched: {limits.attrs['searched']}. In brackets: 95 % intervals."
    return [Text(begin), Items(_strength(limits, answer.separation) + changes), Text(note, "note")]


def _heights(answer: CaseAnswer) -> str:
    """The height that governs the gap, and the gaps needed below it; nothing for oscillators."""
    table = answer.separation
    if "height" not in table.dims:
        return ""
    both = answer.case.one_or_two
    for building, other in zip(both, both[::-1], strict=True):
        if not isinstance(building, StoreyBuilding):
            own_height = (
                f", although it is {building.height:.4g}{SPACE}m high" if building.height else ""
            )
            return (
                f"{building.name} is described without storeys: its displacement is compared with that "
                f"of the roof of {other.name}, {other.height:.4g}{SPACE}m up{own_height}."
            )
    governs = float(table.governing_height[0])
    lower = table.gap_at_height[0].sel(height=table.height < governs)
    places = np.linspace(0, max(lower.size - 1, 0), min(MOST_SHOWN, lower.size))
    parts = [
        f"{centimetres(float(gap))}{SPACE}cm at {float(gap.height):.4g}{SPACE}m"
        for gap in (lower[int(index)] for index in np.unique(places.astype(int)))
    ]
    below = f"; at lower heights less is sufficient: {', '.join(parts)}" if parts else ""
    what = subject_of(answer.case).gap
    return f"The {what} is needed at {governs:.4g}{SPACE}m{below}."


def _alike(table: xr.Dataset) -> str:
    if "peak_2" not in table:
        return ""
    if float(table.gap[0]) > ALIKE * max(float(table.peak_1), float(table.peak_2)):
        return ""
    return (
        "Both move alike in this model, but no two real buildings do. A small difference of the "
        "periods needs a gap: repeat the calculation with one."
    )


def _yielding(table: xr.Dataset) -> str:
    values = _of_each(table, "ductility")
    alone = len(values) == 1
    if not np.isfinite(values).any():
        return "The building stays elastic." if alone else "Both buildings stay elastic."
    begin = "Its mean peak ductility is" if alone else "Their mean peak ductilities are"
    sentence = f"{begin} {ductilities(table)}"
    if np.nanmax(values) < 1:
        return f"{sentence}: {'it hardly yields' if alone else 'they hardly yield'}."
    if np.nanmax(values) > MUCH:
        return (
            f"{sentence}: more than most buildings can sustain. The model does not include loss of "
            "strength."
        )
    return f"{sentence}."


def _storeys(answer: CaseAnswer) -> str:
    """The storey of each building with the largest ductility, or the largest drift if none yields."""
    table, parts = answer.separation, []
    for number, building in enumerate(answer.case.one_or_two, start=1):
        if not isinstance(building, StoreyBuilding):
            continue
        own = table.isel(element=np.flatnonzero(table.element_structure == number))
        yields = building.structure.yields
        worst = own.ductility if yields else own.peak_drift_mean
        row = own.isel(element=int(worst.argmax("element")))
        drift, storey = float(row.peak_drift_mean), int(row.storey)
        share = drift / float(building.structure.arrays()["heights"][storey - 1])
        text = f"storey {storey} of {building.name}, {length(drift)}, {per_cent(share, 2)} of its height"
        parts.append(f"{text}, ductility {float(row.ductility):.1f}" if yields else text)
    return f"Mean peak drifts of the worst storeys: {'; '.join(parts)}." if parts else ""


def _verdicts(answer: CaseAnswer) -> str:
    shown = rows(answer)[1:]
    count = {word: sum(row.verdict == word for row in shown) for word in {r.verdict for r in shown}}
    words = {
        "safe": "safe here",
        "unsafe": "unsafe",
        "within error": "undecided within the error of the simulation",
    }
    parts = [f"{count[word]} {text}" for word, text in words.items() if count.get(word)]
    about = subject_of(answer.case)
    sentence = (
        f"Rules for the {about.gap}, {sum(count.get(w, 0) for w in words)} of them: {', '.join(parts)}."
    )
    if not count.get("unsafe"):
        return sentence
    worst = answer.worst()
    lacking = per_cent(-float(worst.error))
    row = next(row for row in shown if row.rule == worst.rule)
    return f"{sentence} The worst, {row.label}, gives {row.gap}{SPACE}cm, {lacking} less than needed."


def existing(found: xr.Dataset, case: Case) -> str:
    """Whether the existing gap is enough."""
    share, low, high = with_interval(found, "no_pounding_probability")
    word, about = "undecided within the error of the simulation", subject_of(case)
    if low >= case.confidence:
        word = "enough"
    elif high < case.confidence:
        word = "not enough"
    return (
        f"The existing {about.gap} of {length(float(found.attrs['gap_m']))} {about.keeping} in "
        f"{per_cent(share, 1)} of the motions ({per_cent(low, 1)} to {per_cent(high, 1)}): {word}."
    )


def _strength(found: xr.Dataset, table: xr.Dataset) -> list[str]:
    factors = _of_each(table, "reduction_factor")
    yielding = [n for n, now in enumerate(factors, start=1) if np.isfinite(now)]
    if not yielding:
        return []
    least, largest = (
        [found[f"{which}_reduction_factor_{n}"] for n in yielding] for which in ("least", "largest")
    )
    now = " and ".join(f"{factors[n - 1]:.3g}" for n in yielding)

    def both(which: str) -> str:
        return " and ".join(
            _with_interval(found, f"{which}_reduction_factor", f"_{n}") for n in yielding
        )

    low, high = float(least[0]), float(largest[0])
    if np.isnan(high):
        text = "none of those searched"
    elif np.isinf(high):
        text = f"R from {both('least')} on (now {now})" if low > 0 else "any of those searched"
    else:
        begin = f"from {both('least')} " if low > 0 else ""
        text = f"R {begin}up to {both('largest')} (now {now})"
    return [f"Strength: {text}"]


def _with_interval(table: xr.Dataset, name: str, of: str = "") -> str:
    """A value and its 95 % interval."""
    value, low, high = with_interval(table, name, of)
    return f"{value:.3g} [{low:.3g} to {high:.3g}]" if low < high else f"{value:.3g}"


def _limit(value: float, text: str) -> str:
    """The text of a limit, also of one that is infinite or missing."""
    if np.isnan(value):
        return "none of those searched"
    return "any of those searched" if np.isinf(value) else text
