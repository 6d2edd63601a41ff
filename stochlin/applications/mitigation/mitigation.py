"""Comparison of measures against pounding in one table, and the least sufficient ones."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np
import xarray as xr

from stochlin.applications.separation.energy_gap import DAMPED_STRUCTURES
from stochlin.applications.separation.existing_gap import DAMPINGS, Required
from stochlin.applications.separation.separation import NOT_AVAILABLE, VERDICT_ATTRS, verdict_of
from stochlin.applications.separation.storeys import linearized_at_roof
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.simulation.contacts import reduced_mass
from stochlin.messages import ImplausibleInput, brief
from stochlin.models.arguments import (
    Duration,
    Metres,
    Paths,
    Probability,
    Scatter,
    Seed,
    check_label,
    checked,
)
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground, scatter_of
from stochlin.models.links import Link
from stochlin.models.measures import Measure
from stochlin.models.parameters import expect
from stochlin.models.plausible import PLAUSIBLE
from stochlin.models.structures import AnyStructure
from stochlin.models.systems import Assembly, assembly_of
from stochlin.models.uncertain import applied, median_of
from stochlin.solver.simulation.prepared import FiniteMotion, PreparedStructures
from stochlin.solver.simulation.results.peaks import LINK_PEAKS
from stochlin.solver.simulation.statistics import (
    keeping_apart,
    pair_separation,
    quantiles_of,
    required_gaps,
)
from stochlin.solver.tables import labels
from stochlin.solver.tables.labels import LINK

# kinds of measures
AS_BUILT = "as built"
GIVEN_MEASURE = "given"
LEAST_MEASURE = "least"
QUANTILE = 0.95  # of the forces, strokes and energies of devices over motions
# Damping constants that are tried, over 2 m w.
TRIED_CONSTANTS = np.append(0.0, np.geomspace(1e-3, 10, 13))
# numbered as those of rules
MEASURE_VERDICTS = "answer enough not_enough within_error not_available no_verdict"
USUAL_SIMULATIONS = 60  # usual number of simulations of all searches together
SEARCH_WORK = 4  # work of a search, in simulations of all motions
MEASURE_TEXTS: dict[str, str] = {
    "kind": "as built, given, or the least that is sufficient",
    "description": "the measure with its parameters",
    "missing": "missing results of a row, and the reason",
    "link_kind": "link between both structures, or damper in one of them",
    "link_place": "floors of the link (structure.floor)",
}


@checked(uncertain=True, in_metres=True)
def mitigate(
    first: AnyStructure,
    second: AnyStructure,
    ground: Ground,
    gap: Metres,
    measures: Mapping[str, Measure],
    *,
    duration: Duration,
    envelope: Envelope | None = None,
    confidence: Probability = 0.9,
    scatter: Scatter | None = None,
    paths: Paths | None = None,
    seed: Seed = 0,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Compare measures against pounding in the same motions, and find the least sufficient.

    The rows of the table are the buildings as built and each given measure. Further rows are the
    least damping, added to both buildings or to one of them, and the least dashpot between both,
    with which the buildings do not touch with the probability ``confidence``. Nothing is searched
    if the gap is enough as built.

    Parameters
    ----------
    first, second, ground
        As in `separation`, with numbers or `Uncertain` parameters. Oscillators with a link need a
        mass.
    gap : float
        Existing gap [m], positive.
    measures : mapping of str to Measure
        Measures by name; may be empty.
    duration, envelope, confidence, scatter, paths, seed
        As in `separation`.
    progress : callable, optional
        Called with the approximate share of the work that is done.

    Returns
    -------
    xarray.Dataset
        Over ``measure``: ``added_damping_1`` and ``_2`` [-], and ``link_damping_constant`` [N s/m]
        of all links between both buildings together, NaN if some of their dashpots are not linear.

        Over ``measure``, by simulation: ``required_gap`` [m], and ``no_pounding_probability`` [-]
        with the existing gap, each with a 95 % interval ``_lower`` and ``_upper``; ``verdict`` on
        the gap. By linearization: ``rho`` [-] and ``relative_displacement_std`` [m]. The
        coordinates ``kind``, ``description`` and ``missing`` are texts. A row whose search found
        nothing is NaN.

        For measures with links or dampers, over ``measure`` and ``link``, its place in the list:
        the texts ``link_kind`` and ``link_place``, the floors as structure.floor;
        ``peak_link_force`` [N], ``peak_link_stroke`` [m] and ``link_energy`` [J], which it
        dissipates in a motion, each as ``_mean`` and 95 % ``_quantile`` over the simulated motions
        without contact. Cells beyond the links of a measure are NaN.

    Raises
    ------
    ValueError, TypeError
        If a gap, mass or measure is out of range, missing or of the wrong kind; otherwise as in
        `separation`.

    Notes
    -----
    Strengths are converted to metres as built. All results are for motions without contact: what a
    bumper changes is computed by `pound`, with its contact and with the gap less its thickness.
    Linearization is unsafe if structures yield and is given for comparison. A least measure is the
    first that is enough as the damping grows from zero.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), for links and supplemental damping.

    Examples
    --------
    >>> import stochlin as sl
    >>> one, two = (sl.Bilinear(T, 0.05, 0.05, reduction_factor=3, mass=1e6) for T in (0.6, 1.0))
    >>> measures = {"dampers": sl.Measure(0.1, 0.1), "dashpot": sl.Measure(link=sl.Link(0.0, 5e6))}
    >>> ground = sl.named_ground("firm", intensity=0.01)
    >>> table = sl.mitigate(one, two, ground, 0.08, measures, duration=10.0, paths=128)
    >>> bool((table.required_gap.isel(measure=slice(1, 3)) < table.required_gap[0]).all())
    True
    >>> table.measure.values[-1].item()
    'least dashpot between'
    """
    if not isinstance(measures, Mapping):
        raise TypeError(f"measures = {brief(measures)}; allowed: a mapping of them by name")
    motion = FiniteMotion(duration, envelope, scatter_of(ground, scatter), seed)
    simulations = len(measures) + USUAL_SIMULATIONS
    as_built = {"first": first, "second": second}
    prepared = PreparedStructures.of(as_built, ground, motion, paths, simulations)
    pair = MitigatedPair(prepared, float(gap), confidence)
    rows = [partial(pair.row, AS_BUILT, AS_BUILT, Measure())]
    for name, measure in measures.items():
        check_label("the name of a measure", name)
        expect(measure, Measure, f"measures[{brief(name)}]")
        try:
            pair.system(measure)
        except ValueError as error:
            raise ValueError(f"measures[{brief(name)}]: {error}") from error
        for text in pair.doubts(measure):
            warnings.warn(
                f"mitigate: measures[{brief(name)}]: {text}", ImplausibleInput, stacklevel=3
            )
        rows.append(partial(pair.row, name, GIVEN_MEASURE, measure))
    searches = [partial(pair.least, *search) for search in pair.searches()]
    ends = np.cumsum([1] * len(rows) + [SEARCH_WORK] * len(searches))
    tables = []
    for row, end in zip([*rows, *searches], ends, strict=True):
        tables.append(row())
        if progress is not None:
            progress(float(end / ends[-1]))
    return labels.with_run_information(
        _table(tables, confidence).assign_attrs(
            gap_m=float(gap),
            confidence=confidence,
            **labels.of_scatter(motion.scatter),
            duration_s=duration,
            paths=pair.built.sizes["path"],
            seed=seed,
        ),
        f"Measures against pounding, {prepared.usual.name} ground",
        f"mitigate(gap={gap:g}, duration={duration:g}, confidence={confidence:g}, seed={seed})",
        {**as_built, "ground": ground},
    )


def _table(rows: list[xr.Dataset], confidence: float) -> xr.Dataset:
    """The rows, one below the other; what a row does not have is NaN."""
    table = xr.concat(
        rows, "measure", data_vars="all", coords="minimal", compat="override", join="outer"
    )
    solved = table.required_gap.notnull()
    verdict = verdict_of(table.data_vars, confidence).where(solved, NOT_AVAILABLE)
    table["verdict"] = verdict.astype(np.int8)
    table["status"] = labels.status_where(solved, labels.NOT_CONVERGED)
    table = labels.label(table)
    table.verdict.attrs = {**VERDICT_ATTRS, "flag_meanings": MEASURE_VERDICTS}
    for name, text in MEASURE_TEXTS.items():
        if name in table:
            table[name] = table[name].fillna("").astype(str).assign_attrs(long_name=text)
    return table.set_coords([name for name in MEASURE_TEXTS if name in table])


@dataclass(frozen=True)
class MitigatedPair:
    """Two structures and all conditions that a measure does not change."""

    prepared: PreparedStructures
    gap: float
    confidence: float

    def changed(self, measure: Measure) -> list[Any]:
        """The structures with the added damping of the measure."""
        first, second = self.prepared.structures
        damped_1 = partial(_damped, added=float(measure.added_damping_1), number=1)
        damped_2 = partial(_damped, added=float(measure.added_damping_2), number=2)
        return [applied(damped_1, first), applied(damped_2, second)]

    def medians(self, measure: Measure) -> tuple[Any, Any]:
        """The changed structures with uncertain parameters at their medians."""
        first, second = map(median_of, self.changed(measure))
        return first, second

    def system(self, measure: Measure) -> Assembly:
        """The structures with the links of the measure, which have to fit."""
        return assembly_of(self.medians(measure), measure.links)

    @cached_property
    def built(self) -> xr.Dataset:
        """The simulated motions of the buildings as built."""
        return self.prepared.enough(self.confidence)

    def simulated(self, measure: Measure, paths: int | None = None) -> xr.Dataset:
        """The simulated motions, as many as for the buildings as built or another number."""
        return self.prepared.simulated(
            paths or self.built.sizes["path"],
            self.confidence,
            structures=self.changed(measure),
            link=measure.links,
        )

    def row(self, name: str, kind: str, measure: Measure | None, missing: str = "") -> xr.Dataset:
        """All results of a measure; none if it is None, since a search found ``missing``."""
        described = "" if measure is None else measure.describe()
        texts = {"kind": kind, "description": described, "missing": missing}
        table = xr.Dataset(texts, {"measure": name})
        if measure is None:
            return table
        motions = self.built if measure == Measure() else self.simulated(measure)
        gaps = zip(labels.VALUE_AND_ENDS, required_gaps(motions), strict=True)
        columns = {
            "added_damping_1": measure.added_damping_1,
            "added_damping_2": measure.added_damping_2,
            "link_damping_constant": _of_dashpots(measure.links),
            **{f"required_gap{end}": gap for end, gap in gaps},
            **keeping_apart(pair_separation(motions), self.gap),
            **self._linearized(measure),
        }
        devices = _devices(motions, self.system(measure)) if measure.links else xr.Dataset()
        return table.assign(columns).merge(devices)

    def _linearized(self, measure: Measure) -> dict[str, float]:
        """Correlation and standard deviation of ``u_1 - u_2`` by linearization; NaN if unsolved."""
        rho = apart = np.nan
        # There is no solution, or no stationary response: storeys without stiffness.
        with suppress(ArithmeticError, ValueError):
            rho, apart = linearized_at_roof(
                self.medians(measure), self.prepared.usual, measure.links
            )
        return {"rho": rho, "relative_displacement_std": apart}

    def searches(self) -> list[tuple[str, Callable[[float], Measure], Array, str]]:
        """Searches for the least measures: names, measures of a value, values, and what these are.

        They are for added damping, and for a dashpot if the structures have masses; there is none
        if the gap is enough as built.
        """
        if required_gaps(self.built)[0] <= self.gap:
            return []
        listed: list[tuple[str, Callable[[float], Measure], Array, str]] = []
        pair = self.medians(Measure())
        for side, shares in DAMPED_STRUCTURES.items():
            present = max(float(s.damping) for s, share in zip(pair, shares, strict=True) if share)
            tried = DAMPINGS[present + DAMPINGS < 1]
            searched = f"added damping up to {100 * tried[-1]:.3g} % of critical"
            listed.append((f"least damping, {side}", partial(_damping, shares), tried, searched))
        if (scales := self._scales_of_links()) is not None:
            tried = scales[0] * TRIED_CONSTANTS
            searched = f"a damping constant up to {1e-6 * tried[-1]:.3g} MN s/m"
            listed.append(("least dashpot between", _dashpot, tried, searched))
        return listed

    def least(
        self, name: str, build: Callable[[float], Measure], values: Array, searched: str
    ) -> xr.Dataset:
        """The row with the least measure of a search, or the reason why there is none."""

        def gaps(value: float, paths: int) -> tuple[float, float, float]:
            return required_gaps(self.simulated(build(value), paths))

        paths = self.built.sizes["path"]
        as_built = required_gaps(self.built)
        value = Required(gaps, self.gap, paths, {(0.0, paths): as_built}).least(values).value
        if np.isfinite(value):
            return self.row(name, LEAST_MEASURE, build(value))
        return self.row(name, LEAST_MEASURE, None, f"{searched} was searched, and none is enough")

    def doubts(self, measure: Measure) -> Iterator[str]:
        """Texts on links that are too weak beside the buildings to change anything."""
        if not measure.links or (scales := self._scales_of_links()) is None:
            return
        for link in measure.links:
            post, couple, _, constant, exponent = link.numbers
            linear = constant / scales[0] if exponent == 1 else (np.inf if constant else 0.0)
            share = 0.0 if link.within_one else max(linear, (post + couple) / scales[1])
            if text := PLAUSIBLE["link over buildings"].doubt(share):
                yield f"a link has {share:.2g} of 2 m w, or of m w^2, of the buildings; {text}"

    def _scales_of_links(self) -> tuple[float, float] | None:
        """``2 m w`` [N s/m] and ``m w^2`` [N/m], by the reduced mass and the mean of first modes.

        None if a structure has no mass or no floors are at the same level.
        """
        try:
            self.system(_dashpot(0.0))
        except ValueError:
            return None
        modes = [structure.first_mode().arrays() for structure in self.medians(Measure())]
        mass = float(reduced_mass(*(float(mode["mass"]) for mode in modes)))
        frequency = float(np.mean([2 * np.pi / float(mode["period"]) for mode in modes]))
        return 2 * mass * frequency, mass * frequency**2


def _damped(structure: Any, added: float, number: int) -> Any:
    """The structure, of this number, with more damping."""
    total = structure.damping + added
    if (largest := float(np.max(total))) >= 1:
        what = f"added_damping_{number} = {added:g} raises the damping to {largest:g}"
        raise ValueError(f"{what}; allowed: less than 1 in total")
    return replace(structure, damping=total)


def _damping(shares: tuple[float, float], added: float) -> Measure:
    return Measure(shares[0] * added, shares[1] * added)


def _dashpot(constant: float) -> Measure:
    return Measure(link=Link(damping_constant=constant))


def _of_dashpots(links: Sequence[Link]) -> float:
    """Damping constant of all links between both structures; NaN if a dashpot is not linear."""
    dashpots = [link for link in links if not link.within_one and link.damping_constant]
    if any(link.exponent != 1 for link in dashpots):
        return np.nan
    return sum(link.numbers[3] for link in dashpots)


def _devices(motions: xr.Dataset, system: Assembly) -> xr.Dataset:
    """Kind and place of each link, and means and 95 % quantiles of its force, stroke and energy."""
    floors = system.floors
    kinds = []
    places = []
    for placed in system.placed_links:
        other = floors[placed.other] if placed.other >= 0 else "ground"
        kinds.append("damper" if placed.link.within_one else "link")
        places.append(f"{floors[placed.floor]} to {other}")
    columns: dict[str, Any] = {"link_kind": kinds, "link_place": places}
    columns |= {
        f"{name}_quantile": quantiles_of(motions[name].values, np.array(QUANTILE))
        for name in LINK_PEAKS
    }
    means = motions[[f"{name}_mean" for name in LINK_PEAKS]]
    return means.assign({name: (LINK, row) for name, row in columns.items()})
