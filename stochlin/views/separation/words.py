"""An answer on a gap in plain words and short numbers: each sentence once, for screen and page."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy import constants

from stochlin.applications.cases.codes import APPLIED, APPLY, KIND, stated
from stochlin.applications.cases.separation import WITH_SCATTER
from stochlin.applications.separation.separation import COMMENT_ON_CODES
from stochlin.models.grounds import SCATTER_OF_SPECTRUM
from stochlin.models.rules.codes import CODE_RULES
from stochlin.views.shared.blocks import (
    Block,
    Items,
    Row,
    TableBlock,
    TextBlock,
    ViewSection,
    texts,
)
from stochlin.views.shared.words import (
    NBSP,
    along,
    centimetres,
    files_taken,
    floors,
    interval,
    left_out,
    length,
    per_cent,
    plural,
    rule_label,
    scatter,
    shaking,
    site_in_words,
    with_interval,
    yielding_modes,
)
from stochlin.views.sites.pictures import fit_in_words

if TYPE_CHECKING:
    import xarray as xr

    from stochlin.applications.cases.reading.case import Case
    from stochlin.applications.cases.separation import CaseAnswer

ALIKE_RATIO = 0.05  # gap over peak of buildings that move alike
MUCH = 10.0  # ductility that is doubtful
NO_POUNDING = "no_pounding_probability"
ONE_MASS = (
    "A building that is described by its period moves as one mass: its displacement counts at any "
    "height. Roofs of equal storeys move farther, up to 1.5 times; describe the storeys for that."
)
BEYOND_PROPERTY_LINE = (
    "Nothing beyond the property line is in the model: two neighbours that each stay on their own "
    "side cannot meet; for a neighbour nearer to the line, compute the gap between both buildings."
)
AS_APPLIED = "the code as you apply it"
COMBINATION = "the code's combination of simulated peaks"
GROUPS_OF_KINDS = {
    "simulation": "",
    "first_passage": "first passage with the plastic drift in time",
    "equation_3": "eq. (3) with a correlation coefficient",
    "response_spectrum": "response spectrum analysis",
    "linearization": "linearization",
    "code": "families of rules of building codes",
    KIND: AS_APPLIED,
}
GROUPS_IN_ORDER = (*GROUPS_OF_KINDS.values(), COMBINATION)  # in the order in which they are shown
WORDS_OF_GROUPS = {AS_APPLIED: "as you apply it", COMBINATION: "of simulated peaks"}
# Without details.
USUAL_RULES = (
    "simulation",
    "first_passage_drift",
    "srss",
    "eq_3_linearized",
    "eq_3_drift",
    "eq_3_paper",
)
NO_CODES = (
    'For a building code as you apply it write, for instance, codes = ["eurocode_8"] in '
    "[separation], and in each building displacements of your analysis and the factors of the code."
)
MARKS = (
    "Marks: S, compared with its source; C, derived and checked; P, in the text of the paper; M, "
    "not compared with its source."
)
SURE_MARK = " high"  # end of marks M of what is well known without its source
# How a code combines the displacements of two buildings, by the family of its rule.
COMBINATIONS = {
    "sum": "the sum of both displacements",
    "SRSS": "the root of the sum of the squares of both displacements (SRSS)",
    "height": "a share of the height, without displacements",
    "fixed": "a fixed distance, without displacements",
}
ON_ONE = ", since both buildings stand on one property"
ON_TWO = (
    ", since the buildings stand on two properties (on one, write same_property = true in "
    "[separation])"
)
MEANING_OF_R = (
    "R is three standard deviations of the stationary elastic displacement over that at yield."
)
SIGNED = "Date, prepared by, checked by:"
NEEDS_TWO = "needs a second building"  # the reason why a rule is not available


class Subject(NamedTuple):
    """The words that differ; ``{gap}`` stands for a length."""

    gap: str  # what is asked
    stand: str  # what the answer requires
    keeping: str  # what a sufficient gap does
    the_buildings: str
    column: str  # of the share of motions in which it is enough
    good: str  # motions in which it is
    meet: str  # what is not wanted


TWO_BUILDINGS = Subject(
    gap="gap",
    stand="should stand {gap} apart",
    keeping="keeps them apart",
    the_buildings="the buildings",
    column="apart",
    good="motions without pounding",
    meet="they pound",
)
ONE_BUILDING = Subject(
    gap="set-back",
    stand="should stand {gap} away from its property line",
    keeping="keeps it on its side of the line",
    the_buildings="the building",
    column="inside",
    good="motions inside the line",
    meet="it crosses its property line",
)


def subject_of(case: Case) -> Subject:
    """The subject of the answer to a case."""
    return ONE_BUILDING if case.alone else TWO_BUILDINGS


def gap_of(dataset: xr.Dataset) -> str:
    """A gap or a set-back, of a table that `stochlin.separation` returned."""
    return TWO_BUILDINGS.gap if "peak_2" in dataset else ONE_BUILDING.gap


def first_lines(answer: CaseAnswer) -> list[str]:
    """Required gap, existing gap, verdict and reason; two of them where no gap exists."""
    case = answer.case
    table = answer.separation
    about = subject_of(answer.case)
    names = " and ".join(building.name for building in case.buildings)
    required = float(table.gap[0])
    if np.isfinite(required):
        stand = about.stand.format(gap=length(required))
        lines = [f"{names} {stand}. 95{NBSP}% interval of sampling: {needed(answer)}."]
    else:
        falls = (
            f"in more than {per_cent(1 - case.wanted.confidence)} of the motions a building falls"
        )
        lines = [f"No {about.gap} is enough for {names}: {falls}."]
    lines.append(of_earthquakes(answer))
    if answer.existing is not None:
        gap = length(float(answer.existing.attrs["gap_m"]))
        share = share_of(answer.existing)
        share = share.replace(" (", " of the motions (")
        lines.append(f"The existing {about.gap} of {gap} {about.keeping} in {share}.")
        lines.append(f"Verdict: {judged(answer)}; {confidence(case)} are required.")
    if not np.isfinite(required):
        return [*filter(None, lines)]
    peaks = of_each(table, "peak_mean")
    means = f"mean {plural('peak', len(peaks))} {' and '.join(map(centimetres, peaks))}{NBSP}cm"
    why = f"{confidence(case)} of {case.simulated.motions} motions need no more"
    return [*filter(None, lines), f"Why: {why}; {means}{contact_level(answer)}."]


def of_earthquakes(answer: CaseAnswer) -> str:
    """The gap with the scatter between earthquakes, or whether it is in the answer."""
    table = answer.separation
    site = answer.case.site
    if site.scatter:
        return f"This includes a scatter of {site.scatter:.2g} in strength between earthquakes."
    if not np.isfinite(table.get(WITH_SCATTER, np.nan)):
        return ""
    size = f"{length(float(table[WITH_SCATTER]))} ({interval(table, WITH_SCATTER)})"
    scatter = f"{SCATTER_OF_SPECTRUM.scatter:g}"
    return f"With a scatter of {scatter} in strength between earthquakes: {size}."


def needed(answer: CaseAnswer) -> str:
    """The interval of the answer, of 95 %."""
    return interval(answer.separation.isel(rule=0), "gap")


def share_of(table: xr.Dataset) -> str:
    """The share of motions in which a gap is enough, with its interval."""
    of_all, low, high = (per_cent(value, 1) for value in with_interval(table, NO_POUNDING))
    return f"{of_all} ({low} to {high})"


def judged(answer: CaseAnswer) -> str:
    """Whether the existing gap is enough."""
    assert answer.existing is not None
    _, low, high = with_interval(answer.existing, NO_POUNDING)
    if low >= answer.case.wanted.confidence:
        return "enough"
    undecided = "undecided within the error of the simulation"
    return "not enough" if high < answer.case.wanted.confidence else undecided


def confidence(case: Case) -> str:
    """The required probability of no pounding."""
    return f"{100 * case.wanted.confidence:.4g}{NBSP}%"


def contact_level(answer: CaseAnswer) -> str:
    """The level at which both buildings could meet, to which peaks refer; empty if unknown."""
    if answer.case.alone:
        return ""
    table = answer.separation
    buildings = answer.case.buildings
    heights = [building.height or np.nan for building in buildings]
    level = float(table.height[-1]) if "height" in table.dims else float(np.min(heights))
    return f" at {level:.4g}{NBSP}m" if np.isfinite(level) else ""


def of_each(table: xr.Dataset, name: str) -> list[float]:
    """A number for each building of the case."""
    return [float(table[f"{name}_{n}"]) for n in (1, 2) if f"{name}_{n}" in table]


def names_of(answer: CaseAnswer) -> dict[str, str]:
    """The names of the models of the case."""
    buildings = enumerate(answer.case.buildings, start=1)
    return {
        **{f"structure_{n}": building.name for n, building in buildings},
        "ground": "the ground",
    }


def cautions(answer: CaseAnswer) -> list[str]:
    """What makes the answer doubtful, or what it leaves out here."""
    table = answer.separation
    buildings = answer.case.buildings
    shares = zip(buildings, of_each(table, "collapse_probability"), strict=False)
    sentences = [
        floors(answer.case),
        _without_storeys(answer),
        *(
            f"{building.name} falls in {per_cent(share, 1)} of the motions, for which no gap is "
            "enough; it has no mean peak."
            for building, share in shares
            if share > 0
        ),
        *left_out(answer.case),
    ]
    gap = float(table.gap[0])
    if "peak_2" in table and np.isfinite(gap) and gap <= ALIKE_RATIO * max(of_each(table, "peak")):
        sentences.append(
            "Both move alike in this model, but no two real buildings do. A small difference of "
            "the periods needs a gap: repeat the calculation with one."
        )
    if any(MUCH < ductility < np.inf for ductility in of_each(table, "ductility")):
        sentences.append(
            f"{_ductilities(table)} More than {MUCH:g} is more than most buildings can sustain, "
            "and the model does not include loss of strength."
        )
    return [sentence for sentence in sentences if sentence]


def taken(case: Case) -> list[str]:
    """What was taken for the motions: what files say, and the scatter in strength."""
    return [files_taken(case), scatter(case)]


def _without_storeys(answer: CaseAnswer) -> str:
    """What a building without storeys is compared with beside one with storeys."""
    both = answer.case.buildings
    for building, other in zip(both, both[::-1], strict=True):
        if "height" in answer.separation.dims and not building.has_storeys:
            height = (
                f", although it is {building.height:.4g}{NBSP}m high" if building.height else ""
            )
            return (
                f"{building.name} is described without storeys: its displacement is compared with "
                f"that of the roof of {other.name}, {other.height:.4g}{NBSP}m up{height}."
            )
    return ""


def _ductilities(table: xr.Dataset) -> str:
    """Mean peak ductilities of the buildings."""
    values = of_each(table, "ductility")
    shown = [
        "none (elastic)" if np.isnan(v) else f"{v:.1f}".replace("inf", "infinite") for v in values
    ]
    return f"Mean peak ductility: {' and '.join(shown)}."


def _strengths(answer: CaseAnswer) -> str:
    """Displacement, share of the weight and R at which each oscillator yields."""
    table = answer.separation
    parts = []
    for number, building in enumerate(answer.case.buildings, start=1):
        at_yield = float(table.get(f"yield_displacement_{number}", np.nan))
        factor = float(table.get(f"reduction_factor_{number}", np.nan))
        if building.has_storeys or not np.isfinite([at_yield, factor]).all():
            continue
        share = at_yield * (2 * np.pi / building.period) ** 2 / constants.g
        parts.append(
            f"{building.name} at {length(at_yield)}, {share:.2g} of its weight, R = {factor:.3g}"
        )
    return f"Yielding: {'; '.join(parts)}. {MEANING_OF_R}" if parts else ""


def details(answer: CaseAnswer, on_page: bool = False) -> list[TextBlock]:
    """The shaking, its fit that a page draws, ductilities and drifts."""
    case = answer.case
    motions = fit_in_words(answer.spectrum, case.periods)
    of_yielding = [_strengths(answer), yielding_modes(case)]
    moved = [_ductilities(answer.separation), *of_yielding, _storeys(answer)]
    return texts([shaking(answer.shaking, case), *([] if on_page else motions), *moved])


def _storeys(answer: CaseAnswer) -> str:
    """The storey of each building with the largest ductility, or drift if none yields."""
    table = answer.separation
    parts = []
    for number, building in enumerate(answer.case.buildings, start=1):
        if not building.has_storeys or np.isinf(table[f"peak_mean_{number}"]):
            continue
        storeys = table.isel(
            element=(table.element_structure.values == number) & (table.storey.values > 0)
        )
        # In a building that is described by its modes, modes yield in place of storeys.
        yields = bool((storeys.ductility > 0).any())
        worst = storeys.ductility if yields else storeys.peak_drift_mean
        row = storeys.isel(element=int(worst.argmax("element")))
        drift = float(row.peak_drift_mean)
        storey = int(row.storey)
        share = drift / float(building.structure.arrays()["heights"][storey - 1])
        text = (
            f"storey {storey} of {building.name}, {length(drift)}, {per_cent(share, 2)} of its "
            "height"
        )
        parts.append(f"{text}, ductility {float(row.ductility):.1f}" if yields else text)
    return f"Mean peak drifts of the worst storeys: {'; '.join(parts)}." if parts else ""


def allowances(answer: CaseAnswer) -> list[Block]:
    """Limits of single changes up to which the existing gap is sufficient."""
    limits = answer.existing
    case = answer.case
    if limits is None:
        return []
    rows = _strength(limits, answer.separation)
    now = float(case.site.ground.arrays()["intensity"])
    shaking = (np.sqrt(end / now) for end in with_interval(limits, "largest_intensity"))
    rows.append(_limit("factor on the ground motion", "at most", *shaking))
    damping = with_interval(limits, "least_added_damping")
    where = "" if case.alone else " to both"
    rows.append(_limit(f"damping ratio added{where}", "at least", *damping))
    note = (
        f"The existing {subject_of(case).gap} is enough after one of these changes alone. The "
        f"values tried: {limits.attrs['searched']}."
    )
    heads = ("change", "enough with", "95 % interval")
    return [TableBlock.of(heads, rows, heads[1:]), TextBlock(note, "note")]


def _strength(limits: xr.Dataset, table: xr.Dataset) -> list[tuple[str, ...]]:
    """Rows for the strength of both buildings, changed by one factor; none if neither yields."""
    where = "the yield strength" if "peak_2" not in table else "both yield strengths"
    what = f"factor on {where}"
    rows: list[tuple[str, ...]] = []
    factors = of_each(table, "reduction_factor")
    yielding = next((n for n, factor in enumerate(factors) if factor > 0), None)
    if yielding is None:
        return rows
    of_building = f"_{yielding + 1}"
    now = factors[yielding]
    largest = with_interval(limits, "largest_reduction_factor", of_building)
    rows.append(_limit_of_strength(what, "at least", now, *largest))
    least = with_interval(limits, "least_reduction_factor", of_building)
    if least[0] > 0:
        rows.append(_limit_of_strength(what, "at most", now, *least))
    return rows


def _limit_of_strength(
    what: str, bound: str, now: float, factor: float, low: float, high: float
) -> tuple[str, ...]:
    """A row for the limit of a strength, of which R is ``now``, by the limit of R."""
    return _limit(what, bound, now / factor, now / high, now / low)


def _limit(what: str, bound: str, value: float, low: float, high: float) -> tuple[str, ...]:
    """A row for a limit of a change, of which all or no values may be sufficient."""
    if np.isnan(value):
        return what, "no tried value is enough", ""
    if value == 0 or np.isinf(value):
        return what, "every value tried", ""
    return what, f"{bound} {value:.3g}", f"{low:.3g} to {high:.3g}" if low < high else ""


def method(case: Case) -> list[str]:
    """The models of the answer and what they leave out, for the page."""
    scatter = case.site.scatter
    spread = f"; a scatter of {scatter:g} about it is in the answer" if scatter else ""
    certain = " that are not uncertain here" if case.uncertain else ""
    by_one_mass = any(not building.has_storeys for building in case.buildings)
    return [
        f"{case.simulated.motions} motions of a stationary random process with an envelope "
        f"({site_in_words(case)}); the interval covers their sampling only. The strength of the "
        f"next earthquake is the largest unknown{spread}.",
        "Left out: modes beyond the models, torsion, soil under the foundations, loss of strength, "
        f"errors of the parameters{certain}; load factors and least distances of codes.",
        *([ONE_MASS] if by_one_mass else []),
        *([BEYOND_PROPERTY_LINE] if case.alone else []),
    ]


def signed(answer: CaseAnswer) -> str:
    """What is signed, by hand: the required gap, and those of the codes of the case file."""
    gap = f"{subject_of(answer.case).gap} {length(float(answer.separation.gap[0]))}"
    numbers = [f"{row.label} {length(row.metres)}" for row in own_codes(answer) if not row.missing]
    return f"{'; '.join([f'{answer.case.whole.table.source.name}: {gap}', *numbers])}. {SIGNED}"


def case_file(case: Case) -> list[TextBlock]:
    """The text of the case file, from which the same case can be computed again."""
    beside = ", ".join(path.name for path in case.files[1:])
    words = "With the same version of stochlin the case file gives the same numbers."
    needs = f" It needs these files beside it: {beside}." if beside else ""
    return [TextBlock(words + needs), TextBlock(case.whole.table.source.text, "file")]


class RuleLine(NamedTuple):
    """One rule as it is shown."""

    rule: str  # as in the dataset
    label: str  # below the name of its group
    group: str
    usual: bool  # whether it is shown without details
    metres: float
    verdict: str
    cells: tuple[str, ...]  # of the table on the screen
    missing: str
    combination: str  # of the displacements, and why it is this one
    basis: str  # what is assumed in this case, and the source


def rows(answer: CaseAnswer) -> list[RuleLine]:
    """All rules, the answer first; for one building those that apply to one building."""
    table = answer.separation
    if answer.case.alone:
        of_two = [str(text).startswith(NEEDS_TWO) for text in table.missing.values]
        table = table.isel(rule=~np.array(of_two))
    grouped = [(_group(answer.case, row), row) for row in along(table, "rule")]
    grouped.sort(key=lambda of_rule: GROUPS_IN_ORDER.index(of_rule[0]))
    return [_line(answer, *of_rule) for of_rule in grouped]


def usual_rows(answer: CaseAnswer) -> list[RuleLine]:
    """The usual rules, and those the case asks for: codes as applied, and rules with a number."""
    return [row for row in rows(answer) if row.usual]


def _group(case: Case, row: xr.Dataset) -> str:
    """The group to which a rule belongs; a code without displacements is applied as it is."""
    kind = str(row.kind.item())
    rule = str(row.rule.item())
    if kind == "code" and CODE_RULES[rule].multiplies:
        return COMBINATION
    return AS_APPLIED if rule in case.codes else GROUPS_OF_KINDS[kind]


def _line(answer: CaseAnswer, group: str, row: xr.Dataset) -> RuleLine:
    rule = str(row.rule.item())
    words = WORDS_OF_GROUPS.get(group, "")
    gap = float(row.gap)
    stem = rule.removesuffix(APPLIED)
    verdict = row.verdict.attrs["flag_meanings"].split()[int(row.verdict)].replace("_", " ")
    error = per_cent(float(row.error), sign="+") if group else ""
    share = per_cent(float(row.no_pounding_probability), 1)
    texts = {
        name: str(row[name].item()) for name in ("mark", "assumptions", "reference", "missing")
    }
    mark = texts["mark"].removesuffix(SURE_MARK)
    if stem != rule:
        texts["assumptions"] = stated(answer.case, CODE_RULES[stem])
    return RuleLine(
        rule=rule,
        label=rule_label(stem.removeprefix("eq_3_")),
        group=group,
        usual=rule in USUAL_RULES or group == AS_APPLIED or rule in answer.case.wanted.numbers.more,
        metres=gap,
        verdict=verdict,
        cells=(
            f"{stem} {words}".strip(),
            centimetres(gap),
            error,
            share,
            verdict,
            mark,
        ),
        missing=texts["missing"],
        combination=_combination(answer.case, stem, str(row.family.item())),
        basis=". ".join(filter(None, (texts["assumptions"], texts["reference"]))),
    )


def _combination(case: Case, rule: str, family: str) -> str:
    """How a code combines the displacements, and why so; empty for one building and other rules."""
    if case.alone or family not in COMBINATIONS:
        return ""
    why = ON_ONE if case.wanted.same_property else ON_TWO
    return f"{COMBINATIONS[family]}{why if CODE_RULES[rule].between else ''}"


def combinations(answer: CaseAnswer) -> Items:
    """How the codes of the case combine the displacements of both buildings."""
    shown = [row for row in own_codes(answer) if not row.missing and row.combination]
    return Items([f"{row.label}, {length(row.metres)}: {row.combination}." for row in shown])


def own_codes(answer: CaseAnswer) -> list[RuleLine]:
    """The codes of the case as its engineer applies them, and the rules with numbers of its own."""
    numbers = answer.case.wanted.numbers.more
    return [row for row in usual_rows(answer) if row.group == AS_APPLIED or row.rule in numbers]


def rules_table(answer: CaseAnswer, shown: list[RuleLine]) -> TableBlock:
    """A row for each rule with a gap: on screen by its name in files, on a page by its title."""
    about = subject_of(answer.case)
    heads = ("rule", f"{about.gap} [cm]", "error", about.column, "verdict", "mark")
    table_rows = [
        Row(row.cells, row.label, row.group, row.verdict) for row in shown if not row.missing
    ]
    return TableBlock(heads, table_rows, words=heads[4:])


def not_available(shown: list[RuleLine]) -> Items:
    """The rules without a gap, each with the reason."""
    return Items([f"{row.cells[0]}: {row.missing}" for row in shown if row.missing])


def rules_sections(answer: CaseAnswer) -> list[ViewSection]:
    """The usual rules beside the answer; in details the notes on them, and all others."""
    usual = usual_rows(answer)
    others = [row for row in rows(answer) if not row.usual]
    combines = COMBINATION in {row.group for row in others}
    combined = TextBlock(COMMENT_ON_CODES if combines else "", "note")
    more: list[Block] = [rules_table(answer, others), not_available(others), combined]
    return [
        ViewSection("The rules and the answer", [rules_table(answer, usual), combinations(answer)]),
        ViewSection("Rules that are not available", [not_available(usual)], on_page=False),
        ViewSection("", [rules_notes(answer)], detail=True),
        ViewSection("All other rules", more, on_page=False, detail=True),
    ]


def rules_notes(answer: CaseAnswer) -> TextBlock:
    """The meaning of the columns and marks, and how a code is applied."""
    about = subject_of(answer.case)
    groups = {row.group for row in usual_rows(answer)}
    columns = f"Error: relative to the answer. {about.column.capitalize()}: {about.good}. {MARKS}"
    return TextBlock(f"{columns} {APPLY if AS_APPLIED in groups else NO_CODES}", "note")


def assumptions(answer: CaseAnswer) -> Items:
    """What codes of the case assume, and their sources; those of all rules are in the dataset."""
    shown = [row for row in own_codes(answer) if not row.missing]
    return Items([f"{row.label}: {row.basis}." for row in shown])
