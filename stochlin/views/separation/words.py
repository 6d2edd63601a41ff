"""An answer about a gap in plain words and short numbers: each sentence once, for screen and page."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy import constants

from stochlin.messages import hyphenated
from stochlin.models.buildings import ModalBuilding, MultistoreyBuilding
from stochlin.solver.tables.toml import toml_text
from stochlin.views.shared.blocks import Block, Table, Text
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
    site_in_words,
    with_interval,
)
from stochlin.views.sites.words import fit_in_words

if TYPE_CHECKING:
    import xarray as xr

    from stochlin.applications.cases.reading.buildings import Building
    from stochlin.applications.cases.reading.case import Case
    from stochlin.applications.cases.separation import CaseAnswer

ALIKE, MUCH = 0.05, 10.0  # gap over peak of buildings that move alike; ductility that is doubtful
SHARE = "no_pounding_probability"
LINE = (
    "Nothing beyond the property line is in the model: two neighbours that each stay on their own side "
    "cannot meet; for a neighbour nearer to the line, compute the gap between both buildings."
)


class Subject(NamedTuple):
    """The words that differ; ``{gap}`` stands for a length."""

    page: str  # title
    gap: str  # what is asked
    stand: str  # what the answer requires
    keeping: str  # what a sufficient gap does
    the_buildings: str
    column: str  # of the share of motions in which it is enough
    good: str  # motions in which it is
    meet: str  # what is not wanted


PAIR = Subject(
    page="the gap between two buildings",
    gap="gap",
    stand="should stand {gap} apart",
    keeping="keeps them apart",
    the_buildings="the buildings",
    column="apart",
    good="motions without pounding",
    meet="they pound",
)
ALONE = Subject(
    page="the set-back from the property line",
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
    return ALONE if case.alone else PAIR


def gap_of(dataset: xr.Dataset) -> str:
    """A gap or a set-back, of a table that `stochlin.separation` returned."""
    return PAIR.gap if "peak_2" in dataset else ALONE.gap


def measure_of(answer: CaseAnswer) -> tuple[str, str, float]:
    """The name of the intensity of the hazard, its unit, and that in SI."""
    hazard = answer.case.site.hazard
    assert hazard is not None
    if hazard.measure == "intensity":
        return "S0", "m²/s³", 1.0
    name = "PGA" if hazard.period is None else f"Sa({hazard.period:.3g} s)"
    return name, "g", constants.g


def first_lines(answer: CaseAnswer) -> list[str]:
    """Required gap, existing gap, verdict and reason; two of them where no gap exists."""
    case, table, about = answer.case, answer.separation, subject_of(answer.case)
    names = " and ".join(building.name for building in case.buildings)
    stand = about.stand.format(gap=length(float(table.gap[0])))
    lines = [f"{names} {stand}. 95{SPACE}% interval: {needed(answer)}."]
    if answer.existing is not None:
        gap, share = length(float(answer.existing.attrs["gap_m"])), share_of(answer.existing)
        share = share.replace(" (", " of the motions (")
        lines.append(f"The existing {about.gap} of {gap} {about.keeping} in {share}.")
        lines.append(f"Verdict: {judged(answer)}; {confidence(case)} are required.")
    peaks = of_each(table, "peak_mean")
    means = f"mean peak{'s' * (len(peaks) > 1)} {' and '.join(map(centimetres, peaks))}{SPACE}cm"
    why = f"{confidence(case)} of {case.simulated.motions} motions need no more"
    return [*lines, f"Why: {why}; {means}{meeting_level(answer)}."]


def needed(answer: CaseAnswer) -> str:
    """The interval of the answer, of 95 %."""
    return interval(answer.separation.isel(rule=0), "gap")


def share_of(table: xr.Dataset) -> str:
    """The share of motions in which a gap is enough, with its interval."""
    of_all, low, high = (per_cent(value, 1) for value in with_interval(table, SHARE))
    return f"{of_all} ({low} to {high})"


def judged(answer: CaseAnswer) -> str:
    """Whether the existing gap is enough."""
    assert answer.existing is not None
    _, low, high = with_interval(answer.existing, SHARE)
    if low >= answer.case.wanted.confidence:
        return "enough"
    undecided = "undecided within the error of the simulation"
    return "not enough" if high < answer.case.wanted.confidence else undecided


def confidence(case: Case) -> str:
    """The required probability of no pounding."""
    return f"{100 * case.wanted.confidence:.4g}{SPACE}%"


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


def names_of(answer: CaseAnswer) -> dict[str, str]:
    """The names of the models of the case."""
    buildings = enumerate(answer.case.buildings, start=1)
    return {**{f"structure_{n}": building.name for n, building in buildings}, "ground": "the ground"}


def cautions(answer: CaseAnswer) -> list[str]:
    """What makes the answer doubtful, or what it leaves out here."""
    table, buildings = answer.separation, answer.case.buildings
    shares = zip(buildings, of_each(table, "collapse_probability"), strict=False)
    sentences = [
        floors(answer.case),
        _without_storeys(answer),
        *(
            f"{building.name} falls in {per_cent(share, 1)} of the motions, for which no gap is enough; "
            "it has no mean peak."
            for building, share in shares
            if share > 0
        ),
        *left_out(answer.case),
    ]
    if "peak_2" in table and float(table.gap[0]) <= ALIKE * max(of_each(table, "peak")):
        sentences.append(
            "Both move alike in this model, but no two real buildings do. A small difference of the "
            "periods needs a gap: repeat the calculation with one."
        )
    if any(MUCH < ductility < np.inf for ductility in of_each(table, "ductility")):
        sentences.append(
            f"{_ductilities(table)} More than {MUCH:g} is more than most buildings can sustain, and the "
            "model does not include loss of strength."
        )
    return [sentence for sentence in sentences if sentence]


def _without_storeys(answer: CaseAnswer) -> str:
    """What a building without storeys is compared with beside one with storeys."""
    both = answer.case.buildings
    for building, other in zip(both, both[::-1], strict=True):
        if "height" in answer.separation.dims and not building.has_storeys:
            height = f", although it is {building.height:.4g}{SPACE}m high" if building.height else ""
            return (
                f"{building.name} is described without storeys: its displacement is compared with that "
                f"of the roof of {other.name}, {other.height:.4g}{SPACE}m up{height}."
            )
    return ""


def _ductilities(table: xr.Dataset) -> str:
    """Mean peak ductilities of the buildings."""
    values = of_each(table, "ductility")
    shown = ["none (elastic)" if np.isnan(v) else f"{v:.1f}".replace("inf", "infinite") for v in values]
    return f"Mean peak ductility: {' and '.join(shown)}."


def many_records(answer: CaseAnswer) -> str:
    """The gap over many records; empty where there are few, of which each has a row."""
    if answer.over_records is None:
        return ""
    gap, count = float(answer.separation.gap[0]), len(answer.case.site.records)
    return over_records(answer.over_records, count, gap, subject_of(answer.case).gap)


def details(answer: CaseAnswer) -> list[str]:
    """The shaking and its scatter, the fit of the ground, the height, ductilities and drifts."""
    case, table = answer.case, answer.separation
    sentences = [shaking(answer.shaking, case), scatter(case)]
    sentences.append(" ".join(fit_in_words(answer.spectrum, case.periods)))
    sentences += [_ductilities(table), _storeys(answer)]
    return [sentence for sentence in sentences if sentence]


def _storeys(answer: CaseAnswer) -> str:
    """The storey of each building with the largest ductility, or the largest drift if none yields."""
    table, parts = answer.separation, []
    for number, building in enumerate(answer.case.buildings, start=1):
        if not building.has_storeys or np.isinf(table[f"peak_mean_{number}"]):
            continue
        own = table.isel(element=(table.element_structure.values == number) & (table.storey.values > 0))
        yields = bool((own.ductility > 0).any())  # not of a building by its modes, of which modes yield
        worst = own.ductility if yields else own.peak_drift_mean
        row = own.isel(element=int(worst.argmax("element")))
        drift, storey = float(row.peak_drift_mean), int(row.storey)
        share = drift / float(building.structure.arrays()["heights"][storey - 1])
        text = f"storey {storey} of {building.name}, {length(drift)}, {per_cent(share, 2)} of its height"
        parts.append(f"{text}, ductility {float(row.ductility):.1f}" if yields else text)
    return f"Mean peak drifts of the worst storeys: {'; '.join(parts)}." if parts else ""


def allowances(answer: CaseAnswer) -> list[Block]:
    """Limits of single changes up to which the existing gap is sufficient."""
    limits, case = answer.existing, answer.case
    if limits is None:
        return []
    rows = _strength(limits, answer.separation)
    now = float(case.site.ground.arrays()["intensity"])
    shaking = (np.sqrt(end / now) for end in with_interval(limits, "largest_intensity"))
    rows.append(_limit("shaking, times that of the case", "at most", *shaking))
    damping = with_interval(limits, "least_added_damping")
    where = "" if case.alone else " of both"
    rows.append(_limit(f"added damping ratio{where}", "at least", *damping))
    note = (
        f"The existing {subject_of(case).gap} is sufficient with each change alone. Any, none: of what "
        f"was searched, {limits.attrs['searched']}."
    )
    heads = ("change", "sufficient", "95 % interval")
    return [Table.of(heads, rows, heads[1:]), Text(note, "note")]


def _strength(limits: xr.Dataset, table: xr.Dataset) -> list[tuple[str, ...]]:
    """Rows for the strength of both buildings, changed by one factor; none if neither yields."""
    what, rows = "strength, times the present one", []
    factors = [(n, now) for n, now in enumerate(of_each(table, "reduction_factor"), 1) if now > 0]
    for n, now in factors[:1]:
        value, low, high = (now / x for x in with_interval(limits, "largest_reduction_factor", f"_{n}"))
        rows.append(_limit(what, "at least", value, high, low))
        least = with_interval(limits, "least_reduction_factor", f"_{n}")
        if least[0] > 0:
            value, low, high = (now / x for x in least)
            rows.append(_limit(what, "at most", value, high, low))
    return rows


def _limit(what: str, bound: str, value: float, low: float, high: float) -> tuple[str, ...]:
    """A row for a limit of a change, of which all or no values may be sufficient."""
    if np.isnan(value):
        return what, "none", ""
    if value == 0 or np.isinf(value):
        return what, "any", ""
    return what, f"{bound} {value:.3g}", f"{low:.3g} to {high:.3g}" if low < high else ""


def method(case: Case) -> list[str]:
    """The models of the answer and what they leave out, for the page."""
    spread = f"; a scatter of {case.site.scatter:g} about it is in the answer" * bool(case.site.scatter)
    known = " that are not uncertain here" * bool(case.uncertain)
    models = ", ".join(f"{building.name} is {_model(building)}" for building in case.buildings)
    return [
        f"Motions: {case.simulated.motions} of a stationary random process with an envelope "
        f"({site_in_words(case)}); the interval covers their sampling only. The strength of the next "
        f"earthquake is the largest unknown{spread}.",
        f"Buildings: {models}. Modes beyond these models, torsion of irregular plans, soil under the "
        f"foundations, loss of strength and the error of the parameters{known} are left out.",
        "Rules: they combine the simulated peaks, and only a code as you apply it uses displacements "
        "of a design. Load factors and minimum distances of codes are left out.",
        *([LINE] if case.alone else []),
    ]


def _model(building: Building) -> str:
    """The model of a building: storeys, modes, or one oscillator."""
    structure = building.structure
    law = structure.element_law if isinstance(structure, MultistoreyBuilding) else structure
    name = hyphenated(type(law).__name__).replace("Bilinear", "bilinear")
    if isinstance(structure, ModalBuilding):
        count = structure.modes
        return f"a sum of {count} modes, each a {name} oscillator" if count > 1 else f"one {name} mode"
    return f"a row of {name} storeys" if building.has_storeys else f"one {name} oscillator"


def case_file(case: Case) -> list[Text]:
    """The tables of the case file, from which the same case can be typed again."""
    beside = ", ".join(path.name for path in case.files[1:])
    words = "With the same version of stochlin the case file gives the same numbers."
    needs = f" It needs these files beside it: {beside}." if beside else ""
    return [Text(words + needs), Text(toml_text(case.whole.table.values), "file")]
