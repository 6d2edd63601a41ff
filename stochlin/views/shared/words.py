"""Numbers and names in words, for every command and picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy import constants

from stochlin.applications.cases.shaking import MOST_RECORDS
from stochlin.applications.sites.elastic_spectra import taken_in_words
from stochlin.messages import plain
from stochlin.models.arguments import checked
from stochlin.models.grounds import ground_names
from stochlin.models.hazards import DESIGN_RETURN_PERIOD, Hazard, HazardCurve
from stochlin.models.rules.codes import CODE_RULES
from stochlin.models.rules.effective_properties import EFFECTIVE_RULES
from stochlin.solver.tables.labels import VALUE_AND_ENDS
from stochlin.views.shared.blocks import TextBlock, ViewSection

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    import xarray as xr

    from stochlin.applications.cases.reading.case import Case

NO_VALUE = "\N{EN DASH}"
MINUS = "\N{MINUS SIGN}"
NBSP = "\N{NO-BREAK SPACE}"
CENTIMETRES = 100.0  # in a metre
IN_SI = {"1": 1.0, "g": constants.g, "m/s": 1.0, "ms": 1e-3, "kJ": 1e3, "MN": 1e6, "MN/m": 1e6}
RULE_OF_PAPER = "as in Valles-Mattox and Reinhorn (1996)"
SLABS_ON_COLUMNS = (
    "A slab can break the column that it hits, and the storey with it. Codes that allow a smaller "
    "gap where floors align, such as Eurocode 8 (4.4.2.7) with 0.7 of the gap within one property, "
    "mean only floors at the same level."
)

TURNS_IN_PLAN = (
    "Caution: {building} turns in plan, and a gap can be too small: export the displacements of "
    'joints on the edge that faces the neighbour, and name one on each floor, as points = ["12"].'
)
YIELDS = (
    "Mode 1 of {building} has {share} of the mass, bears all of its strength and yields at "
    "{displacement}; its other modes stay elastic."
)


def centimetres(metres: float) -> str:
    """A length in cm: tenths, or two digits below one."""
    value = round(100 * metres, 3)
    if not np.isfinite(value):
        return NO_VALUE
    return f"{value:.1f}" if value >= 0.95 else f"{value:.2g}"


def counted(number: int, noun: str) -> str:
    """A number with its noun, such as ``2 impacts``."""
    return f"{number} {plural(noun, number)}"


def plural(noun: str, number: int) -> str:
    """The noun for this number of things."""
    return noun if number == 1 else f"{noun}s"


def length(metres: float) -> str:
    """A length in cm, with its unit."""
    return f"{centimetres(metres)}{NBSP}cm"


def with_interval(table: xr.Dataset, name: str, of: str = "") -> tuple[float, float, float]:
    """A number of a table, and the ends of its interval; ``of`` is the end of their names."""
    value, low, high = (float(table[f"{name}{end}{of}"]) for end in VALUE_AND_ENDS)
    return value, low, high


def interval(table: xr.Dataset, name: str) -> str:
    """The 95 % interval of a length of a table, in cm."""
    _, low, high = with_interval(table, name)
    if np.isfinite(high):
        return f"{centimetres(low)} to {length(high)}"
    return f"{length(low)} or more; the motions are too few for an upper end"


def along(table: xr.Dataset, dimension: str) -> list[xr.Dataset]:
    """The parts of a table along a dimension, in their order."""
    return [table.isel({dimension: place}) for place in range(table.sizes[dimension])]


def per_cent(share: float, digits: int = 0, sign: str = "") -> str:
    """A share in per cent."""
    if not np.isfinite(share):
        return NO_VALUE
    return f"{100 * share:{sign}.{digits}f}{NBSP}%".replace("-", MINUS)


@checked
def rule_label(rule: str) -> str:
    """Name of a rule for a reader, ``eq. (3), Iwan (1980)``; of one without a title by its name."""
    stem = rule.removeprefix("eq_3_")
    registered = EFFECTIVE_RULES.get(stem) or CODE_RULES.get(stem)
    plain = {"paper": RULE_OF_PAPER, "cqc": "CQC"}.get(stem, stem.replace("_", " "))
    name = registered.published_name() if registered and registered.title else plain
    return name if stem == rule else f"eq. (3), {name}"


def number(value: float, unit: str = "1") -> str:
    """A number in SI as it stands in a table in this unit, three digits; missing ones as a dash."""
    if unit == "cm" or not np.isfinite(value):
        return centimetres(value)
    shown = value / IN_SI[unit]
    return f"{shown:.0f}" if abs(shown) >= 1000 else f"{shown:.3g}"


def scatter(case: Case) -> str:
    """The scatter of the motions in strength and its source; empty where it is 0."""
    usual = case.site.usual_scatter
    now = case.site.scatter
    source = usual.source if now == usual.scatter else "scatter in [motion]"
    sentence = (
        "The motions differ in strength by a lognormal factor of median 1, whose logarithm has the "
        f"standard deviation {now:.2g} ({source})."
    )
    return sentence if now else ""


def files_taken(case: Case) -> str:
    """How spectrum, hazard and records of files were taken; empty without such files."""
    spectrum = case.site.spectrum
    hazard = case.site.hazard
    records = case.site.records
    sentences = []
    if spectrum is not None and "code" not in spectrum.attrs:
        taken = _together(taken_in_words(spectrum), plain(spectrum.attrs.get("columns", "")))
        sentences.append(f"The spectrum of {plain(spectrum.attrs['source'])}: {taken}.")
    if isinstance(hazard, HazardCurve) and hazard.source:
        sentences.append(f"The hazard of {_together(plain(hazard.source), _of_design(hazard))}.")
    for name, record in records.items():
        size = _size_of(record) if len(records) <= MOST_RECORDS else ""
        if taken := _together(plain(record.attrs.get("columns", "")), size):
            sentences.append(f"The record {plain(name)}: {taken}.")
    return " ".join(sentences)


def _together(*parts: str) -> str:
    """The parts of a sentence that are not empty."""
    return "; ".join(filter(None, parts))


def _size_of(record: xr.DataArray) -> str:
    """Peak, length and time step of a record."""
    step = record.attrs["dt"]
    seconds = f"{record.size * step:.4g}{NBSP}s in steps of {step:.4g}{NBSP}s"
    return f"peak {in_g(float(abs(record).max()))}, {seconds}"


def _of_design(hazard: HazardCurve) -> str:
    """What is exceeded once in 475 years, if the curve has that."""
    design = hazard.of_design()
    if not np.isfinite(design):
        return ""
    name, units, unit = measure_of(hazard)
    period = f"with a return period of {DESIGN_RETURN_PERIOD:g} years"
    return f"{period} {name} {design / unit:.3g}{NBSP}{units}"


def measure_of(hazard: Hazard) -> tuple[str, str, float]:
    """The name of the intensity of a hazard, its unit, and that in SI."""
    if hazard.measure == "intensity":
        return "S0", "m²/s³", 1.0
    name = "PGA" if hazard.period is None else f"Sa({hazard.period:.3g} s)"
    return name, "g", constants.g


def strength(table: xr.Dataset, case: Case) -> list[str]:
    """How strong the motions are, by which files, and how they differ."""
    return [shaking(table, case), files_taken(case), scatter(case)]


def in_g(acceleration: float) -> str:
    """An acceleration in g."""
    return f"{number(acceleration, 'g')}{NBSP}g"


def shaking(table: xr.Dataset, case: Case) -> str:
    """The strength of the motions of an answer, in measures that engineers use."""
    accelerations = [
        float(table[f"spectral_acceleration_{n}"]) for n, _ in enumerate(case.periods, 1)
    ]
    at_median = " at median strength" if case.site.scatter else ""
    begin = f"The shaking, mean of the motions{at_median}:"
    spectral = _spectral(case, accelerations)
    strength = f"S0 {float(table.ground_intensity):.3g} m²/s³"
    if np.isnan(table.peak_ground_acceleration):
        return f"{begin} {spectral}; white noise of {strength} has no PGA or rms."
    return f"{begin} {_peak_and_rms(table, spectral)}, {strength}."


def recorded_shaking(table: xr.Dataset, case: Case) -> str:
    """How strong a record is."""
    spectral = _spectral(case, table.spectral_acceleration.values)
    return f"The shaking: {_peak_and_rms(table, spectral)}."


def _spectral(case: Case, accelerations: Iterable[float]) -> str:
    """The spectral accelerations at the periods of the buildings; of equal periods one."""
    at_periods = {
        f"{period:.3g} s": in_g(float(acceleration))
        for period, acceleration in zip(case.periods, accelerations, strict=True)
    }
    shown = ", ".join(f"{acceleration} at {period}" for period, acceleration in at_periods.items())
    return f"Sa (damping 5{NBSP}%) {shown}"


def _peak_and_rms(table: xr.Dataset, spectral: str) -> str:
    peak = in_g(float(table["peak_ground_acceleration"]))
    rms = in_g(float(table["rms_acceleration"]))
    return f"PGA {peak}, {spectral}; rms {rms} in the strong part"


def over_records(table: xr.Dataset, count: int, gap: float, what: str = "gap") -> str:
    """The gap [m] in many records, in place of one number for each."""
    parts = []
    for quantile in along(table, "quantile"):
        needed, low, high = with_interval(quantile, "record_gap_quantile")
        ends = f"{centimetres(low)} to {centimetres(high)}"
        ends = ends if np.isfinite(high) else "too few records for an interval"
        share = 100 * float(quantile["quantile"])
        parts.append(f"{length(needed)} in {share:.4g}{NBSP}% of them ({ends})")
    share, low, high = with_interval(table, "record_no_pounding_probability")
    return (
        f"The {count} recorded motions would have needed {', '.join(parts)}. A {what} of "
        f"{length(gap)} is enough in {round(share * count)} of {count}, {per_cent(share)} "
        f"({per_cent(low)} to {per_cent(high)}, with {table.attrs['independent']} of them "
        "independent)."
    )


def doubt(doubts: Sequence[str]) -> TextBlock:
    """Doubtful input as the first line of an answer, if there is any."""
    return TextBlock(
        f"CHECK THE INPUT, ITS UNITS FIRST: {'; '.join(doubts)}." if doubts else "", "doubt"
    )


def opening(case: Case, doubts: Sequence[str]) -> ViewSection:
    """Doubtful input, if there is any, and the title of the case."""
    return ViewSection("", [doubt(doubts), TextBlock(case.title, "title")])


def site_in_words(case: Case) -> str:
    """The ground of a case: the name or spectrum that it is given by, and its model."""
    parts = [part.name for part in case.site.ground.parts]
    model = f"{' and '.join(dict.fromkeys(parts))} ground"
    if len(parts) > 1:
        model = f"{len(parts)} {model}s in parallel"
    if case.site.spectrum is not None:
        code = case.site.spectrum.attrs.get("code")
        return f"{rule_label(code) if code else case.site.name} spectrum, {model}"
    if case.site.name == "fitted":
        return f"{model}, fitted to a record"
    return f"{case.site.name}, {model}" if case.site.name in ground_names() else model


def left_out(case: Case) -> list[str]:
    """What the models leave out of buildings that turn in plan."""
    return [
        TURNS_IN_PLAN.format(building=building.name)
        for building in case.buildings
        if building.turning
    ]


def yielding_modes(case: Case) -> str:
    """What yields of buildings by modes with a strength of the whole building; maybe nothing."""
    return " ".join(
        YIELDS.format(
            building=building.name,
            share=per_cent(
                building.structure.effective_masses()[0] / building.structure.masses.sum()
            ),
            displacement=length(float(building.structure.oscillator().yield_displacement)),
        )
        for building in case.buildings
        if building.of_first_mode
    )


def floors(case: Case) -> str:
    """A warning that slabs meet columns, and the provision of codes; empty where none does."""
    if not (slabs := case.slabs):
        return ""
    more = {0: "", 1: ", and one more does"}.get(len(slabs) - 1, f", and {len(slabs) - 1} more do")
    return f"Floors are not level: {slabs[0].words}{more}. {SLABS_ON_COLUMNS}"


def with_uncertainty(case: Case, what: str) -> str:
    """A statement that the answer contains the uncertainty; empty where all is known."""
    if not case.uncertain:
        return ""
    return (
        f"Some parameters are uncertain. Each of the {case.simulated.motions} motions has its own "
        f"sample, and {what} of motions and samples together. Formulas and shaking are at the "
        "medians."
    )


def at_medians(case: Case) -> str:
    """A statement that the answer does not contain it; empty where all is known."""
    sentence = "Some parameters are uncertain: here they are taken at their medians."
    return sentence if case.uncertain else ""
