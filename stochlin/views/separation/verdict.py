"""The first lines of an answer: the required gap, the existing one, the verdict and its reason.

Behind them stand cautions, what codes say, and details of the answer.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from stochlin.views.separation.subjects import subject_of
from stochlin.views.separation.words import (
    AS_APPLIED,
    AT_LEAST,
    LESS,
    WITHIN,
    RuleLine,
    confidence,
    ductilities,
    meeting_level,
    of_each,
    rows,
)
from stochlin.views.shared.words import (
    SPACE,
    centimetres,
    floors,
    interval,
    left_out,
    length,
    over_records,
    per_cent,
    scatter,
    shaking,
    with_interval,
)
from stochlin.views.sites.words import fit_in_words

if TYPE_CHECKING:
    import xarray as xr

    from stochlin.analyses.cases.separation import CaseAnswer

MOST_SHOWN = 4  # heights at which the gap is told
ALIKE, MUCH = 0.05, 10.0  # gap over peak of buildings that move alike; ductility that is doubtful
SHARE = "no_pounding_probability"


def first_lines(answer: CaseAnswer) -> list[str]:
    """Required gap, existing gap, verdict and reason; two of them where no gap exists."""
    both = [existing(answer), verdict(answer)]
    return list(filter(None, [required(answer), *both, reason(answer)]))


def required(answer: CaseAnswer) -> str:
    """The answer in one sentence, and its interval."""
    names = " and ".join(building.name for building in answer.case.buildings)
    stand = subject_of(answer.case).stand.format(gap=length(float(answer.separation.gap[0])))
    return f"{names} {stand}. 95{SPACE}% interval: {needed(answer)}."


def needed(answer: CaseAnswer) -> str:
    """The interval of the answer, of 95 %."""
    return interval(answer.separation.isel(rule=0), "gap")


def existing(answer: CaseAnswer) -> str:
    """The share of motions for which the existing gap is enough; empty without one."""
    if answer.existing is None:
        return ""
    about, gap = subject_of(answer.case), length(float(answer.existing.attrs["gap_m"]))
    enough = share(answer.existing, " of the motions")
    return f"The existing {about.gap} of {gap} {about.keeping} in {enough}."


def share(table: xr.Dataset, of_what: str = "") -> str:
    """The share of motions in which a gap is enough, with its interval."""
    of_all, low, high = (per_cent(value, 1) for value in with_interval(table, SHARE))
    return f"{of_all}{of_what} ({low} to {high})"


def judged(answer: CaseAnswer) -> str:
    """Whether the existing gap is enough; empty without one."""
    if answer.existing is None:
        return ""
    _, low, high = with_interval(answer.existing, SHARE)
    if low >= answer.case.wanted.confidence:
        return "enough"
    undecided = "undecided within the error of the simulation"
    return "not enough" if high < answer.case.wanted.confidence else undecided


def verdict(answer: CaseAnswer) -> str:
    """Whether the existing gap is enough, in a sentence; empty without one."""
    if answer.existing is None:
        return ""
    return f"Verdict: {judged(answer)}; {confidence(answer.case)} are required."


def reason(answer: CaseAnswer) -> str:
    """The reason of the answer: the share of the motions, and how far each building moves."""
    case, table = answer.case, answer.separation
    peaks = of_each(table, "peak_mean")
    means = f"mean peak{'s' * (len(peaks) > 1)} {' and '.join(map(centimetres, peaks))}{SPACE}cm"
    where = meeting_level(answer)
    return f"Why: {confidence(case)} of {case.simulated.motions} motions need no more; {means}{where}."


def cautions(answer: CaseAnswer) -> list[str]:
    """What makes the answer doubtful, or what it leaves out here."""
    case, table = answer.case, answer.separation
    sentences = [
        floors(case),
        _without_storeys(answer),
        _alike(table),
        *_falling(answer),
        _yielding(table) if _yields_much(table) else "",
        scatter(case),
        *left_out(case),
    ]
    return [sentence for sentence in sentences if sentence]


def comparisons(answer: CaseAnswer) -> list[str]:
    """The answer beside codes and rules, records, and the spectrum or record of the site."""
    case, about = answer.case, subject_of(answer.case)
    sentences = [_codes(answer), _verdicts(answer)]
    gap, records = float(answer.separation.gap[0]), case.site.records
    if answer.over_records is not None:
        sentences.append(over_records(answer.over_records, len(records), gap, about.gap))
    elif records:
        needed = zip(records, answer.separation.record_separation.values, strict=True)
        gaps = ", ".join(f"{name} {length(float(gap))}" for name, gap in needed)
        sentences.append(f"In the recorded motions {about.they} would have needed: {gaps}.")
    sentences.append(" ".join(fit_in_words(answer.spectrum, case.periods)))
    return [sentence for sentence in sentences if sentence]


def details(answer: CaseAnswer) -> list[str]:
    """The shaking, the heights, ductilities and drifts."""
    case, table = answer.case, answer.separation
    sentences = [
        shaking(answer.shaking, case),
        _heights(answer),
        "" if _yields_much(table) else _yielding(table),
        _at_yield(table),
        _storeys(answer),
    ]
    return [sentence for sentence in sentences if sentence]


def own_codes(answer: CaseAnswer) -> list[RuleLine]:
    """The codes of the case file as its engineer applies them, and the rules with numbers of its own."""
    numbers = answer.case.wanted.of_rules()
    return [row for row in rows(answer) if row.group == AS_APPLIED or row.rule in numbers]


def _codes(answer: CaseAnswer) -> str:
    """What these rules say; empty where the file names none."""
    parts = [
        f"{row.label}{row.remark}: {row.missing or f'{row.gap}{SPACE}cm, {row.verdict}'}"
        for row in own_codes(answer)
    ]
    return f"The codes of the case file: {'; '.join(parts)}." if parts else ""


def _without_storeys(answer: CaseAnswer) -> str:
    """What a building without storeys is compared with beside one with storeys."""
    both = answer.case.buildings
    if "height" not in answer.separation.dims:
        return ""
    for building, other in zip(both, both[::-1], strict=True):
        if not building.has_storeys:
            own_height = (
                f", although it is {building.height:.4g}{SPACE}m high" if building.height else ""
            )
            return (
                f"{building.name} is described without storeys: its displacement is compared with that "
                f"of the roof of {other.name}, {other.height:.4g}{SPACE}m up{own_height}."
            )
    return ""


def _heights(answer: CaseAnswer) -> str:
    """The height that governs the gap, and the gaps needed below it; nothing for oscillators."""
    table = answer.separation
    if "height" not in table.dims or _without_storeys(answer):
        return ""
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


def _falling(answer: CaseAnswer) -> list[str]:
    """In how many motions each building falls that does."""
    shares = of_each(answer.separation, "collapse_probability")
    named = zip(answer.case.buildings, shares, strict=False)
    fallen = [f"{one.name} falls in {per_cent(share, 1)}" for one, share in named if share > 0]
    return [
        f"{falls} of the motions, for which no gap is enough; it has no mean peak." for falls in fallen
    ]


def _yields_much(table: xr.Dataset) -> bool:
    """Whether a mean peak ductility is more than most buildings can sustain, which do not fall."""
    return any(MUCH < ductility < np.inf for ductility in of_each(table, "ductility"))


def _yielding(table: xr.Dataset) -> str:
    values = of_each(table, "ductility")
    alone = len(values) == 1
    if np.isnan(values).all():
        return "The building stays elastic." if alone else "Both buildings stay elastic."
    begin = "Its mean peak ductility is" if alone else "Their mean peak ductilities are"
    sentence = f"{begin} {ductilities(table)}"
    if np.nanmax(values) < 1:
        return f"{sentence}: {'it hardly yields' if alone else 'they hardly yield'}."
    if _yields_much(table):
        return (
            f"{sentence}: more than most buildings can sustain. The model does not include loss of "
            "strength."
        )
    return f"{sentence}."


def _at_yield(table: xr.Dataset) -> str:
    """Yield displacements, however the strengths are given."""
    yields = of_each(table, "yield_displacement")
    if not np.isfinite(yields).any():
        return ""
    which = " of the first modes" if "height" in table.dims else ""
    return f"Yield displacements{which}: {' and '.join(map(centimetres, yields))}{SPACE}cm."


def _storeys(answer: CaseAnswer) -> str:
    """The storey of each building with the largest ductility, or the largest drift if none yields."""
    table, parts = answer.separation, []
    for number, building in enumerate(answer.case.buildings, start=1):
        if not building.has_storeys or np.isinf(table[f"peak_mean_{number}"]):
            continue
        of_building = (table.element_structure == number) & (table.storey > 0)
        own = table.isel(element=np.flatnonzero(of_building))
        yields = bool((own.ductility > 0).any())  # not of a building by its modes, of which modes yield
        worst = own.ductility if yields else own.peak_drift_mean
        row = own.isel(element=int(worst.argmax("element")))
        drift, storey = float(row.peak_drift_mean), int(row.storey)
        share = drift / float(building.structure.arrays()["heights"][storey - 1])
        text = f"storey {storey} of {building.name}, {length(drift)}, {per_cent(share, 2)} of its height"
        parts.append(f"{text}, ductility {float(row.ductility):.1f}" if yields else text)
    return f"Mean peak drifts of the worst storeys: {'; '.join(parts)}." if parts else ""


def _verdicts(answer: CaseAnswer) -> str:
    """How many rules give as much as the answer, and the one that gives the least."""
    shown = rows(answer)[1:]
    count = Counter(row.verdict for row in shown)
    verdicts = [verdict for verdict in (AT_LEAST, LESS, WITHIN) if count[verdict]]
    parts = ", ".join(f"{count[verdict]} {verdict}" for verdict in verdicts)
    gap, total = subject_of(answer.case).gap, sum(count[verdict] for verdict in verdicts)
    sentence = f"Rules for the {gap}, {total} of them: {parts}."
    if not count[LESS]:
        return sentence
    least = min((row for row in shown if row.verdict == LESS), key=lambda row: row.metres)
    return f"{sentence} The smallest, {least.label}, gives {least.gap}{SPACE}cm ({least.error})."
