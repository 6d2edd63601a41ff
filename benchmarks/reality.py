"""Do predicted gaps hold in earthquakes? `python benchmarks/reality.py RECORDS --work FOLDER`.

RECORDS is a folder whose table suites.csv lists two suites, as `read_records` takes it, with the
columns event and station; records from its folder mexico_city are of a lake bed, the others are the
far field. Motions are predicted from a spectrum, or fitted to one record or both components of a
station; the gaps that they ask for, and those of every rule for a spectrum, are tried on records.
Takes half an hour or so on two cores; a run that was stopped goes on with what is in FOLDER.
`--page FILE` writes the tables into a page, `--save FILE` what its pictures show.
"""

from __future__ import annotations

import argparse
import csv
import itertools
import pickle
import sys
import time
import warnings
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import scipy.constants
import xarray as xr
from reality_tables import (
    BOTH,
    CONFIDENCE,
    FAR_FIELD,
    FITTED,
    LAKE_BED,
    LEVELS,
    OTHER,
    OWN_COMPONENT,
    PGA_ELSEWHERE,
    SA_ELSEWHERE,
    SA_ELSEWHERE_BOTH,
    SPECTRUM,
    USUAL,
    figures_of,
    tables_of,
    write_page,
)

import stochlin as sl
from stochlin.applications.sites.elastic_spectra import marked
from stochlin.applications.sites.motion_fit import Components
from stochlin.applications.sites.spectra import labelled
from stochlin.files.storage import save_table, whole_file
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import DoubtfulInput
from stochlin.models.grounds import OTHER_COMPONENT

OF_RECORDS = "elastic, of records"
DAMPING, HARDENING, STOREY_HEIGHT, MASS = 0.05, 0.05, 3.2, 4e5
# Period [s] and storeys of the left and of the right building; one storey: an oscillator.
OSCILLATORS = ((0.3, 0.45), (0.5, 0.8), (1.0, 0.6), (1.0, 1.4), (1.8, 1.2), (2.5, 1.5))
PAIRS = (
    *(((left, 1), (right, 1)) for left, right in OSCILLATORS),
    ((0.8, 3), (0.5, 2)),
    ((1.2, 4), (0.8, 3)),
)
GROUPS = (list(range(len(OSCILLATORS))), [6], [7])  # simulated together
STRENGTHS = (1.0, 2.0, 4.0)  # mean elastic peak over yield displacement, 1: elastic
LEVELS_OF_FITS = (*LEVELS, OTHER_COMPONENT.scatter)  # of scatter
GAP_SHARES = (0.1, 0.2, 0.35, 0.5, 0.75)  # of the sum of both mean elastic peaks
BAND = (0.5, 2.0)  # of the shorter and of the longer period, between which records meet a spectrum
LONGEST = 4.0  # s
PATHS, SPECTRUM_PATHS, SEED = 256, 1024, 17


class Recorded(NamedTuple):
    """A record of a suite, and where it is from."""

    values: xr.DataArray
    suite: str
    event: str
    station: str

    @property
    def place(self) -> str:
        """What the two components of a station share in one earthquake."""
        return f"{self.event}, {self.station}"


def suites(table: Path) -> dict[str, Recorded]:
    """The records by name; those with a remark in the column flag are left out."""
    with table.open(encoding="utf-8", newline="") as file:
        rows = {row["file"]: row for row in csv.DictReader(file)}
    records = sl.read_records(table)
    return {
        name: Recorded(
            records[name],
            LAKE_BED if name.startswith("mexico_city") else FAR_FIELD,
            row["event"],
            row["station"],
        )
        for name, row in rows.items()
        if not row["flag"]
    }


# --- structures and what is predicted of them
# ---------------------------------------------------------


def structure(
    period: float, storeys: int, strength: float | None
) -> sl.Bilinear | sl.ShearBuilding:
    """Elastic, or with this displacement [m] at yield, of a building that of its roof."""
    if storeys == 1:
        law = {} if strength is None else {"hardening": HARDENING, "yield_displacement": strength}
        return sl.Bilinear(period, DAMPING, **law)
    law = {}
    if strength is not None:
        push = (2 * np.pi / period) ** 2 * strength * (storeys + 1) / (2 * storeys)
        law = {"hardening": HARDENING, "base_shear_coefficient": push / scipy.constants.g}
    return sl.ShearBuilding.regular(
        period=period,
        storeys=storeys,
        storey_height=STOREY_HEIGHT,
        mass=MASS,
        damping=DAMPING,
        **law,
    )


class Motion(NamedTuple):
    """What `simulate` needs to know."""

    ground: Any
    envelope: Any
    duration: float
    paths: int = PATHS
    groups: Sequence[Sequence[int]] = GROUPS  # of pairs; what is not simulated is NaN


def simulated(motion: Motion, yields: Array | None, scatter: float) -> tuple[Array, Array]:
    """Gaps (pair, path), sorted, and mean peaks of the roofs (pair, side) [m]."""
    gaps, peaks = np.full((len(PAIRS), motion.paths), np.nan), np.full((len(PAIRS), 2), np.nan)
    for pairs in motion.groups:
        sides = [
            structure(*PAIRS[n][side], None if yields is None else float(yields[n, side]))
            for n in pairs
            for side in (0, 1)
        ]
        table = sl.simulate(
            sides,
            motion.ground,
            duration=motion.duration,
            envelope=motion.envelope,
            scatter=scatter,
            paths=motion.paths,
            seed=SEED,
        )
        roofs = np.cumsum([PAIRS[n][side][1] for n in pairs for side in (0, 1)]) - 1
        first = 2 * np.arange(len(pairs))
        gaps[pairs] = np.sort(table.separation.values[:, first, first + 1], axis=0).T
        peaks[pairs] = table.peak.values[:, roofs].mean(axis=0).reshape(-1, 2)
    return gaps, peaks


def strengths(motion: Motion) -> Array:
    """Displacements at yield (strength, pair, side) [m]; the first are of the elastic peaks."""
    _, peaks = simulated(motion, None, 0.0)
    return np.array([peaks / strength for strength in STRENGTHS])


def predicted(motion: Motion, yields: Array, scatter: float) -> Array:
    """Gaps (strength, pair, path), sorted [m]."""
    return np.array(
        [
            simulated(motion, at_yield if strength > 1 else None, scatter)[0]
            for strength, at_yield in zip(STRENGTHS, yields, strict=True)
        ]
    )


def tried(yields: Array, records: Mapping[str, xr.DataArray], pairs: Iterable[int]) -> Array:
    """Gaps that records need (record, strength, pair) [m], NaN of other pairs."""
    needed = np.full((len(records), len(STRENGTHS), len(PAIRS)), np.nan)
    for number, n in itertools.product(range(len(STRENGTHS)), pairs):
        both = [
            structure(*PAIRS[n][side], float(yields[number, n, side]) if number else None)
            for side in (0, 1)
        ]
        needed[:, number, n] = sl.recorded_gap(*both, dict(records)).separation
    return needed


class Prediction(NamedTuple):
    """Gaps (scatter, strength, pair, path), sorted, and strengths (strength, pair, side) [m]."""

    gaps: Array
    yields: Array
    levels: Sequence[float]


def _mean(values: Array) -> Array:
    """Over the last axis, of what is known; NaN of nothing."""
    defined = ~np.isnan(values)
    count = np.where(defined.any(axis=-1), defined.sum(axis=-1), np.nan)
    mean: Array = np.where(defined, values, 0.0).sum(axis=-1) / count
    return mean


def compared(prediction: Prediction, needed: Array, names: list[str], part: str) -> xr.Dataset:
    """Where the gaps that records need lie among those predicted."""
    gaps, yields, levels = prediction
    record = needed[:, None]  # (case, scatter, strength, pair)
    below = (gaps < record[..., None]).mean(axis=-1)
    # A structure that yields away from its neighbour may need no gap at all.
    logs = np.log(np.where(gaps > 0, gaps, np.nan))
    log_record = np.log(np.where(record > 0, record, np.nan))
    gap = np.array(GAP_SHARES) * yields[0].sum(axis=-1)[:, None]
    needed = needed[..., None]
    likely = (gaps[..., None] > gap[:, None]).mean(axis=-2)
    dims = ("case", "scatter", "strength", "pair")
    return xr.Dataset(
        {
            "below": (dims, np.where(np.isnan(record), np.nan, below)),
            "off": (dims, log_record - _mean(logs)),
            "spread": (
                dims,
                np.broadcast_to(np.sqrt(_mean(logs**2) - _mean(logs) ** 2), below.shape),
            ),
            "probability": (
                (*dims, "gap"),
                np.broadcast_to(likely, (*below.shape, len(GAP_SHARES))),
            ),
            "hit": (("case", *dims[2:], "gap"), np.where(np.isnan(needed), np.nan, needed > gap)),
            "needed": (("case", *dims[2:]), needed[..., 0]),
        },
        {
            "scatter": list(levels),
            "strength": list(STRENGTHS),
            "gap": list(GAP_SHARES),
            "record": ("case", names),
            "part": ("case", [part] * len(names)),
        },
    )


class SavedResults:
    """What was computed under a name stays in a folder."""

    def __init__(self, folder: Path) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.folder = folder

    def __call__(self, name: str, function: Callable[..., Any], *arguments: Any) -> Any:
        file = self.folder / f"{name.replace('/', ' ')}.pickle"
        if not file.exists():
            begin, result = time.perf_counter(), function(*arguments)
            with whole_file(file) as temporary:
                Path(temporary).write_bytes(pickle.dumps(result))
            print(f"{name}: {time.perf_counter() - begin:.1f} s", flush=True)
        return pickle.loads(file.read_bytes())

    def prediction(self, name: str, motion: Motion, levels: Sequence[float] = LEVELS) -> Prediction:
        """Gaps by scatter, and strengths."""
        yields = self(f"{name}, strengths", strengths, motion)
        gaps = [self(f"{name}, scatter {s:g}", predicted, motion, yields, s) for s in levels]
        return Prediction(np.array(gaps), yields, levels)


# --- (a) from a spectrum
# ------------------------------------------------------------------------------


def mean_spectrum(records: Mapping[str, xr.DataArray]) -> xr.DataArray:
    """Geometric mean of the spectra of records of one peak acceleration, that of their median."""
    period = np.geomspace(0.05, LONGEST, 80)
    median = float(np.median([abs(record).max() for record in records.values()]))
    logs = [
        np.log(sl.response_spectrum(record, period, DAMPING).pseudo_acceleration.values.ravel())
        for record in sl.scale_records(records, pga=median).values()
    ]
    return xr.DataArray(
        np.exp(np.mean(logs, axis=0)),
        dims="period",
        coords={"period": period},
        attrs={
            "units": "m/s^2",
            "damping": DAMPING,
            "source": "mean spectrum of a suite",
            "elastic": OF_RECORDS,
        },
    )


# Duration [s] and envelope: of the far field those of the documentation's examples, of the lake bed
# the medians of what fit_envelope finds.
LENGTHS = {
    FAR_FIELD: (20.0, (2.0, 12.0, 0.4)),
    LAKE_BED: (80.0, (1.0, 12.0, 0.02)),
}


class OfSpectrum(NamedTuple):
    """A suite, the spectrum to which it is scaled, and what is predicted from this."""

    records: Mapping[str, xr.DataArray]
    target: xr.DataArray
    motion: Motion
    prediction: Prediction


def of_spectrum(saved: SavedResults, records: Mapping[str, Recorded], suite: str) -> OfSpectrum:
    of_suite = {name: record.values for name, record in records.items() if record.suite == suite}
    target = (
        sl.eurocode_8(0.25 * scipy.constants.g, "B")
        if suite == FAR_FIELD
        else mean_spectrum(of_suite)
    )
    duration, shape = LENGTHS[suite]
    envelope = sl.AminAng(*shape)

    def fitted() -> Motion:
        ground = sl.fit_ground(target, duration=duration, envelope=envelope)
        return Motion(ground, envelope, duration, SPECTRUM_PATHS)

    motion = saved(f"{suite}, motion", fitted)
    return OfSpectrum(of_suite, target, motion, saved.prediction(suite, motion))


def tried_by_spectrum(
    yields: Array, records: Mapping[str, xr.DataArray], target: xr.DataArray, pairs: Iterable[int]
) -> Array:
    """As `tried`, each record scaled to a spectrum in a band around the periods of the pair."""
    needed = np.full((len(records), len(STRENGTHS), len(PAIRS)), np.nan)
    for n in pairs:
        periods = [side[0] for side in PAIRS[n]]
        band = (BAND[0] * min(periods), min(BAND[1] * max(periods), LONGEST))
        scaled = sl.scale_records(records, spectrum=target, band=band)
        needed[..., n] = tried(yields, scaled, [n])[..., n]
    return needed


def from_spectrum(saved: SavedResults, records: Mapping[str, Recorded], suite: str) -> xr.Dataset:
    of_suite, target, _, prediction = of_spectrum(saved, records, suite)
    pairs = range(len(PAIRS))
    needed = saved(
        f"{suite}, records", tried_by_spectrum, prediction.yields, of_suite, target, pairs
    )
    return compared(prediction, needed, list(of_suite), SPECTRUM)


# --- gaps of every rule
# -------------------------------------------------------------------------------


def gaps_by_rule(motion: Motion, yields: Array) -> xr.DataArray:
    """Gaps [m] of every rule of `separation` for the oscillators, over rule, strength and pair."""
    cells = []
    for (number, strength), n in itertools.product(enumerate(STRENGTHS), GROUPS[0]):
        both = [
            structure(*PAIRS[n][side], float(yields[number, n, side]) if number else None)
            for side in (0, 1)
        ]
        table = sl.separation(
            *both,
            motion.ground,
            motion.duration,
            envelope=motion.envelope,
            confidence=CONFIDENCE,
            scatter=USUAL,
            paths=motion.paths,
            seed=SEED,
        )
        gap = table.gap.where(~table.family.isin(["height", "fixed"]))
        gap = gap.drop_vars(set(gap.coords) - {"rule"})
        cells.append(gap.expand_dims(strength=[strength], pair=[n]).to_dataset(name="gap"))
    by_rule: xr.DataArray = xr.combine_by_coords(cells).gap
    return by_rule.dropna("rule")


def rules_of(saved: SavedResults, records: Mapping[str, Recorded]) -> xr.DataArray:
    """Gaps [m] of every rule in (a), over suite, rule, strength and pair."""
    of_suites = []
    for suite in LENGTHS:
        _, _, motion, (_, yields, _) = of_spectrum(saved, records, suite)
        of_suites.append(saved(f"{suite}, rules", gaps_by_rule, motion, yields))
    return xr.concat(of_suites, xr.DataArray(list(LENGTHS), dims="suite", name="suite"))


# --- (b) and (c) from one record
# ----------------------------------------------------------------------


def pairs_on(suite: str) -> Sequence[Sequence[int]]:
    """Buildings in records of minutes take minutes; on the lake bed they are tried in (a) alone."""
    return GROUPS[:1] if suite == LAKE_BED else GROUPS


def from_record(saved: SavedResults, records: Mapping[str, Recorded], name: str) -> xr.Dataset:
    """The record itself, the other component of its station, and the rest of its suite."""
    record = records[name]
    groups = pairs_on(record.suite)
    pairs = [n for group in groups for n in group]

    def fitted() -> Motion:
        motion = sl.fit_motion(record.values)
        return Motion(motion.ground, motion.envelope, motion.duration, groups=groups)

    prediction = saved.prediction(name, saved(f"{name}, motion", fitted), LEVELS_OF_FITS)
    parts = []

    def add(part: str, others: Mapping[str, xr.DataArray], pairs: Sequence[int] = pairs) -> None:
        if others:
            needed = saved(f"{name}, {part}", tried, prediction.yields, others, pairs)
            parts.append(compared(prediction, needed, list(others), part))

    add(OWN_COMPONENT, {name: record.values})
    rest = {key: other for key, other in records.items() if key != name}
    beside = {key: other.values for key, other in rest.items() if other.place == record.place}
    add(OTHER, beside)
    far = {
        key: other
        for key, other in rest.items()
        if other.suite == record.suite and key not in beside
    }
    others = {key: other.values for key, other in far.items()}
    scaled = sl.scale_records(others, pga=float(abs(record.values).max()))
    if record.suite == LAKE_BED:
        for part, same in (("other station", True), ("other event", False)):
            some = {
                key: scaled[key]
                for key, other in far.items()
                if (other.event == record.event) is same
            }
            add(part, some)
    target = spectrum_of([record.values])
    add(PGA_ELSEWHERE, scaled, GROUPS[0])
    needed = saved(
        f"{name}, {SA_ELSEWHERE}", tried_by_spectrum, prediction.yields, others, target, GROUPS[0]
    )
    parts.append(compared(prediction, needed, list(others), SA_ELSEWHERE))
    return xr.concat(parts, "case")


def spectrum_of(components: Sequence[xr.DataArray]) -> xr.DataArray:
    """Geometric mean of the spectra of components."""
    period = np.geomspace(0.05, LONGEST, 80)
    values = Components(components, np.empty((0, 0)), np.nan).spectrum(period)
    return marked(labelled(period, values, DAMPING, "a record"), OF_RECORDS)


def from_both(saved: SavedResults, records: Mapping[str, Recorded], place: str) -> xr.Dataset:
    """Fitted to both components of a station: each of them, and the rest of its suite by Sa.

    The scatter is that of the fit, which differs from station to station.
    """
    both = {name: record for name, record in records.items() if record.place == place}
    suite = next(iter(both.values())).suite
    groups = pairs_on(suite)
    shortest = min(record.values.size for record in both.values())
    components = [record.values[:shortest] for record in both.values()]

    def fitted() -> tuple[Motion, float]:
        motion = sl.fit_motion(components)
        return Motion(
            motion.ground, motion.envelope, motion.duration, groups=groups
        ), motion.scatter

    name = f"{place}, both"
    motion, scatter = saved(f"{name}, motion", fitted)
    prediction = saved.prediction(name, motion, (0.0, scatter))
    prediction = prediction._replace(levels=(0.0, FITTED))
    pairs = [n for group in groups for n in group]
    of_place = {key: record.values for key, record in both.items()}
    needed = saved(f"{name}, own", tried, prediction.yields, of_place, pairs)
    near = compared(prediction, needed, list(of_place), BOTH)
    rest = {
        key: record.values
        for key, record in records.items()
        if record.suite == suite and key not in both
    }
    target = spectrum_of(components)
    needed = saved(f"{name}, by Sa", tried_by_spectrum, prediction.yields, rest, target, GROUPS[0])
    far = compared(prediction, needed, list(rest), SA_ELSEWHERE_BOTH)
    return xr.concat([near, far], "case")


# --- all of it
# ----------------------------------------------------------------------------------------


def all_cases(records: Mapping[str, Recorded], work: Path) -> xr.Dataset:
    """All that was tried, over case; with where each record is from."""
    saved = SavedResults(work)
    tables = [from_spectrum(saved, records, suite) for suite in LENGTHS]
    tables += [from_record(saved, records, name) for name in records]
    count = Counter(record.place for record in records.values())
    tables += [from_both(saved, records, place) for place, number in count.items() if number == 2]
    cases = xr.concat(tables, "case", join="outer")
    names = cases.record.values
    return cases.assign_coords(
        suite=("case", [records[name].suite for name in names]),
        place=("case", [records[name].place for name in names]),
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("records", type=Path, nargs="?", default=Path("../shared/records"))
    parser.add_argument("--work", type=Path, required=True)
    parser.add_argument("--page", type=Path)
    parser.add_argument("--save", type=Path)
    parser.add_argument(
        "--every", type=int, default=1, help="take one place in so many, for a trial"
    )
    options = parser.parse_args()
    table = options.records / "suites.csv"
    if not table.exists():
        sys.exit(
            f"{table} is not there: records are not part of the repository. Give the folder of the "
            "suites; their table has the columns file, event, station, dt, units and flag."
        )
    warnings.simplefilter("ignore", DoubtfulInput)  # strong buildings, large factors
    records = suites(table)
    places = list(dict.fromkeys(record.place for record in records.values()))[:: options.every]
    records = {name: record for name, record in records.items() if record.place in places}
    cases = all_cases(records, options.work)
    save_table(cases, options.work / "cases.nc")
    saved = SavedResults(options.work)
    figures = figures_of(cases, rules_of(saved, records))
    text = tables_of(figures)
    print("\n\n".join(text.values()))
    if options.save:
        save_table(figures, options.save)
    if options.page:
        write_page(options.page, text)


if __name__ == "__main__":
    main()
