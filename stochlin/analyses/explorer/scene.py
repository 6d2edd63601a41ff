"""A scene: ground, two buildings, gap and motion by single numbers, from sliders or a case file."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from stochlin.analyses.cases.buildings import Building
from stochlin.analyses.cases.case import FEWEST_PATHS, Case
from stochlin.analyses.cases.site import FITTED, NONE, PARALLEL
from stochlin.analyses.cases.storeys import SlabOnColumn, StoreyBuilding, slabs_of_row
from stochlin.analyses.explorer.buildings import (
    DESCRIPTIONS,
    OF_FILE,
    OSCILLATOR,
    REGULAR,
    StoreysOfFile,
)
from stochlin.analyses.explorer.sites import (
    ASCE_7,
    CODES,
    EUROCODE_8,
    MEASURES,
    PGA,
    S0,
    SA,
    SOILS,
    TYPES,
    Fitted,
    G,
    Measured,
    Motions,
    RecordsOfFile,
    Shape,
    code_of,
    kind_of,
)
from stochlin.analyses.linearization.strength import reduction_factor
from stochlin.analyses.linearization.transient_systems import check_course
from stochlin.analyses.tables.checks import check_confidence, check_duration, check_scatter, check_whole
from stochlin.kernels.basics.parallel import Progress
from stochlin.messages import brief
from stochlin.models.buildings import PLAUSIBLE_COEFFICIENT, ShearBuilding
from stochlin.models.envelopes import ENVELOPES, AminAng, Envelope, GammaEnvelope, ShinozukaSato
from stochlin.models.grounds import GROUNDS, Ground, KanaiTajimi, ParallelGround
from stochlin.models.grounds.named import ground_names, named_ground
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.parameters import POSITIVE, Model, Range, parameter
from stochlin.models.structures import DAMPING, HARDENING
from stochlin.models.systems import AnyStructure

MEDIAN = "gaps by rules without simulation are those of the median strength"
SITES = (*ground_names(), *GROUNDS, *CODES)
SHAPES = (*ENVELOPES, NONE)
# So that no entry asks for work of hours.
MOST_PATHS, MOST_STOREYS = 20_000, 60
PERIOD = Range(0.02, 20.0, True, True)
FACTOR = Range(upper=100.0, include_upper=True)
STOREY_HEIGHT = Range(1.0, 20.0, True, True)
COEFFICIENT = Range(upper=PLAUSIBLE_COEFFICIENT, include_upper=True, reason="a share of the weight")
WHOLE = {
    "paths": (FEWEST_PATHS, MOST_PATHS),
    "storey_count_1": (1, MOST_STOREYS),
    "storey_count_2": (1, MOST_STOREYS),
}
"""Whole numbers of a scene, with the least and the largest."""
DURATION = Range(1.0, 300.0, True, True)
SOIL = KanaiTajimi.allowed("damping")


def _with_all_parameters(scene: type[Scene]) -> type[Scene]:
    """A number for every parameter of grounds and envelopes that the scene has none for."""
    known, missing = {field.name for field in dataclasses.fields(scene)}, {}
    for kind in (*GROUNDS.values(), *ENVELOPES.values()):
        for name, own in names_of(kind).items():
            field = kind.__dataclass_fields__[own]
            if name not in known and name not in missing:
                allowed = kind.allowed(own)
                start = allowed.middle if field.default in (None, dataclasses.MISSING) else field.default
                about = field.metadata["units"], field.metadata["long_name"]
                missing[name] = (name, float, parameter(*about, allowed, start))
    module = {"__module__": scene.__module__, "__doc__": scene.__doc__}
    return dataclasses.make_dataclass(
        scene.__name__, missing.values(), bases=(scene,), namespace=module, frozen=True, kw_only=True
    )


def names_of(kind: type[Model] | None) -> dict[str, str]:
    """A scene's names of the parameters of a ground or envelope, and their own."""
    if kind is not None and issubclass(kind, Ground):
        return kind.beside_structures()
    return {name: name for name in kind.parameter_names()} if kind else {}


@_with_all_parameters
@dataclass(frozen=True, kw_only=True)
class Scene(Model):
    """Ground, two buildings, gap and motion: what the explorer's controls hold, in SI.

    Of ground, envelope and a building only the parameters of the chosen ``site``, ``envelope`` and
    ``description`` count; the others wait for another choice. ``ground_of_file`` is that of the site
    ``"parallel"``. What no control shows is kept for the case file: ``scatter``; ``storeys`` and
    ``heights`` of oscillators; ``floor_masses`` [kg] of regular buildings, on which nothing that is
    shown depends.
    """

    site: str = "firm"
    ground_of_file: ParallelGround | None = None
    measure: str = S0
    pga: float = parameter("m/s^2", "mean peak ground acceleration", POSITIVE, 0.3 * G)
    sa: float = parameter("m/s^2", "mean spectral acceleration", POSITIVE, 0.6 * G)
    sa_period: float = parameter("s", "period of the spectral acceleration", PERIOD, 1.0)
    ag: float = parameter("m/s^2", "acceleration ag on ground type A", POSITIVE, 0.25 * G)
    soil: str = "C"
    spectrum_type: str = "1"
    sds: float = parameter("m/s^2", "SDS", POSITIVE, G)
    sd1: float = parameter("m/s^2", "SD1", POSITIVE, 0.6 * G)
    tl: float = parameter("s", "TL", POSITIVE, 8.0)
    fitted: Fitted | None = None
    measured: Measured | None = None
    records: RecordsOfFile | None = None
    intensity: float = parameter("m^2/s^3", "intensity S0 of the ground", POSITIVE, 0.01)
    ground_period: float = parameter("s", "ground period", PERIOD, 1.0)
    ground_damping: float = parameter("1", "ground damping ratio", SOIL, 0.3)
    high_pass_period: float = parameter("s", "high-pass period", POSITIVE, 4.0)
    high_pass_damping: float = parameter("1", "high-pass damping ratio", POSITIVE, 0.6)
    period_1: float = parameter("s", "period", PERIOD, 1.0)
    damping_1: float = parameter("1", "damping ratio", DAMPING, 0.05)
    yields_1: bool = True
    hardening_1: float = parameter("1", "hardening ratio", HARDENING, 0.05)
    reduction_factor_1: float = parameter("1", "reduction factor R", FACTOR, 4.0)
    description_1: str = OSCILLATOR
    storey_count_1: int = 8
    storey_height_1: float = parameter("m", "storey height", STOREY_HEIGHT, 3.0)
    base_shear_coefficient_1: float = parameter(
        "1", "base shear at yield relative to the weight", COEFFICIENT, 0.15
    )
    strength_factor_1: float = parameter(
        "1", "storey shears at yield relative to those of the file", FACTOR, 1.0
    )
    period_2: float = parameter("s", "period", PERIOD, 0.6)
    damping_2: float = parameter("1", "damping ratio", DAMPING, 0.05)
    yields_2: bool = True
    hardening_2: float = parameter("1", "hardening ratio", HARDENING, 0.05)
    reduction_factor_2: float = parameter("1", "reduction factor R", FACTOR, 4.0)
    description_2: str = OSCILLATOR
    storey_count_2: int = 5
    storey_height_2: float = parameter("m", "storey height", STOREY_HEIGHT, 3.0)
    base_shear_coefficient_2: float = parameter(
        "1", "base shear at yield relative to the weight", COEFFICIENT, 0.15
    )
    strength_factor_2: float = parameter(
        "1", "storey shears at yield relative to those of the file", FACTOR, 1.0
    )
    gap: float = parameter("m", "existing gap", POSITIVE, 0.05)
    confidence: float = parameter("1", "confidence of no pounding", Range(upper=1.0), 0.9)
    duration: float = parameter("s", "duration", DURATION, 20.0)
    envelope: str = "amin_ang"
    rise_end: float = parameter("s", "end of the rise", AminAng.allowed("rise_end"), 4.0)
    strong_end: float = parameter("s", "end of strong shaking", AminAng.allowed("strong_end"), 15.0)
    decay: float = parameter("1/s", "rate of decay", AminAng.allowed("decay"), 0.35)
    slow: float = parameter("1/s", "slow rate", ShinozukaSato.allowed("slow"), 0.1)
    fast: float = parameter("1/s", "fast rate", ShinozukaSato.allowed("fast"), 1.0)
    power: float = parameter("1", "power of the rise", GammaEnvelope.allowed("power"), 2.0)
    scatter: float = 0.0
    paths: int = 2048
    seed: int = 0
    title: str = "Two buildings"
    names: tuple[str, str] = ("Building 1", "Building 2")
    heights: tuple[float | None, float | None] = (None, None)
    storeys: tuple[int | None, int | None] = (None, None)
    floor_masses: tuple[float, float] = (4e5, 4e5)
    storeys_of_file: tuple[StoreysOfFile | None, StoreysOfFile | None] = (None, None)
    floors_align: bool = False
    zone: str | None = None
    unverified: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        chosen = {
            "site": self.sites(),
            "measure": MEASURES,
            "soil": SOILS,
            "spectrum_type": TYPES,
            "envelope": SHAPES,
            **{f"description_{n}": self.ways_to_describe(n) for n in (1, 2)},
        }
        for name, allowed in chosen.items():
            if (value := getattr(self, name)) not in allowed:
                raise ValueError(f"{name} = {brief(value)} is not known; allowed: {', '.join(allowed)}")
        for name, (lowest, highest) in WHOLE.items():
            check_whole(name, getattr(self, name), lowest, highest)
        check_confidence(self.confidence)
        check_scatter(self.scatter)
        check_course(self.duration, self.motion_envelope())
        one, two = self.structures()
        check_duration(self.duration, {"building 1": one, "building 2": two})

    def ways_to_describe(self, number: int) -> tuple[str, ...]:
        """The ways to describe building 1 or 2; the file's storeys are one where there are some."""
        return DESCRIPTIONS if self.storeys_of_file[number - 1] else DESCRIPTIONS[:-1]

    def sites(self) -> tuple[str, ...]:
        """The kinds of ground; filters in parallel are one where the file gives some."""
        return (*SITES, PARALLEL) if self.ground_of_file else SITES

    def ground(self) -> Ground:
        """The ground of the site, as strong as is asked; a ValueError unless it is settled."""
        return self._ground

    @cached_property
    def _ground(self) -> Ground:
        if not self.settled:
            raise ValueError("the ground for these values is not known yet; wait for its simulation")
        if self.fitted is not None and self.shape is not None:
            times = (self.strength / self.fitted.strength) ** 2
            ground: Any = self.fitted.ground
            return dataclasses.replace(ground, intensity=times * ground.arrays()["intensity"].item())
        if self.measure != S0 and self.measured is not None:
            return self._of_intensity((self.strength / self.measured.acceleration) ** 2)
        return self._of_intensity(self.intensity)

    def _of_intensity(self, intensity: float) -> Ground:
        if self.site == PARALLEL and self.ground_of_file:
            return dataclasses.replace(self.ground_of_file, intensity=intensity)
        if self.site not in GROUNDS:
            return named_ground(self.site, intensity)
        kind: Any = GROUNDS[self.site]
        return kind(**self.site_parameters() | {"intensity": intensity})

    @property
    def strength(self) -> float:
        """What says how strong motions are [m/s^2], where that is no intensity."""
        by_measure = "pga" if self.measure == PGA else "sa"
        return float(getattr(self, {EUROCODE_8: "ag", ASCE_7: "sds"}.get(self.site, by_measure)))

    @property
    def shape(self) -> Shape | None:
        """The code's spectrum that motions are to have, if they are."""
        if self.site not in CODES:
            return None
        kind = kind_of(self.site, vars(self))
        return Shape(self.site, kind, self.duration, self.motion_envelope())

    @property
    def _motions(self) -> Motions:
        """Those of which is asked how strong they are."""
        period = self.sa_period if self.measure == SA else None
        return Motions(self._of_intensity(1.0), self.duration, self.motion_envelope(), period)

    @cached_property
    def settled(self) -> bool:
        """Whether the ground is known; if not, `settle` seeks it."""
        if self.shape is not None:
            return self.fitted is not None and self.fitted.shape == self.shape
        return self.measure == S0 or (
            self.measured is not None and self.measured.motions == self._motions
        )

    def settle(self, progress: Progress | None = None) -> Scene:
        """The same scene with its ground: fitted, or measured, by simulation in a few seconds."""
        if self.settled:
            return self
        if self.shape is not None:
            return dataclasses.replace(self, fitted=self.shape.fitted(progress))
        return dataclasses.replace(self, measured=self._motions.measured(self.seed, progress))

    def site_parameters(self) -> dict[str, float]:
        """What the case file says of the ground beside its name."""
        kind = GROUNDS[self.site if self.site in GROUNDS else "white_noise"]  # a name has its strength
        return {own: getattr(self, name) for name, own in names_of(kind).items()}

    def structures(self) -> tuple[AnyStructure, AnyStructure]:
        """Both buildings, the left one first."""
        return self.structure(1), self.structure(2)

    @property
    def has_storeys(self) -> bool:
        """Whether one of both is described by them."""
        return (self.description_1, self.description_2) != (OSCILLATOR, OSCILLATOR)

    def structure(self, number: int, period: float | None = None) -> AnyStructure:
        """Building 1 or 2, with another period if one is given."""
        described = getattr(self, f"description_{number}")
        if described == OSCILLATOR:
            return self.oscillator(number, **({} if period is None else {"period": period}))
        own = self._of(number, "period", "damping", "hardening", "base_shear_coefficient")
        period = own["period"] if period is None else period
        hardening = own["hardening"] if getattr(self, f"yields_{number}") else None
        storeys = self.storeys_of_file[number - 1]
        if described == OF_FILE and storeys is not None:
            factor = getattr(self, f"strength_factor_{number}")
            return storeys.building(period, own["damping"], hardening, factor)
        return ShearBuilding.regular(
            period=period,
            storeys=getattr(self, f"storey_count_{number}"),
            storey_height=getattr(self, f"storey_height_{number}"),
            mass=self.floor_masses[number - 1],
            damping=own["damping"],
            hardening=hardening,
            base_shear_coefficient=own["base_shear_coefficient"] if hardening else None,
        )

    def oscillator(self, number: int, **changed: Any) -> Bilinear:
        """Building 1 or 2, which is one, with other parameters where they are given."""
        names = ["period", "damping"]
        if getattr(self, f"yields_{number}"):
            names += ["hardening", "reduction_factor"]
        return Bilinear(**self._of(number, *names) | changed)

    def _of(self, number: int, *names: str) -> dict[str, Any]:
        return {name: getattr(self, f"{name}_{number}") for name in names}

    @property
    def slabs_on_columns(self) -> tuple[SlabOnColumn, ...]:
        """Where a floor of one building meets the other between two floors, from the ground up."""
        both = zip(self.names, self.structures(), strict=True)
        return slabs_of_row(
            [
                StoreyBuilding(name, one, "") if isinstance(one, ShearBuilding) else one
                for name, one in both
            ]
        )

    def motion_envelope(self) -> Envelope | None:
        """The envelope, None where shaking has none."""
        kind = ENVELOPES.get(self.envelope)
        return kind(**self.envelope_parameters()) if kind else None

    def envelope_parameters(self) -> dict[str, float]:
        """What the case file says of the envelope beside its name."""
        return {name: getattr(self, name) for name in names_of(ENVELOPES.get(self.envelope))}

    def motion(self) -> dict[str, Any]:
        """Duration, envelope and confidence, as the verbs take them."""
        return {
            "duration": self.duration,
            "envelope": self.motion_envelope(),
            "confidence": self.confidence,
            "scatter": self.scatter,
        }

    def for_codes(self) -> dict[str, Any]:
        """What building codes ask for beside the peaks; storeys say their heights themselves."""
        heights = [
            None if isinstance(structure, ShearBuilding) else height
            for structure, height in zip(self.structures(), self.heights, strict=True)
        ]
        return {
            "height_1": heights[0],
            "height_2": heights[1],
            "floors_align": self.floors_align and not self.slabs_on_columns,
            "zone": self.zone,
        }


def scene_of(case: Case) -> tuple[Scene, list[str]]:
    """The scene of a case file, and in sentences what of the file it cannot hold.

    A ValueError if a number lies beyond what the explorer takes.
    """
    notes, of_code = [], code_of(case)
    site, given = case.site, _numbers(case.ground)
    if site == FITTED:
        site = _kind_of(case)
        notes.append(
            f"The ground is fitted to {next(iter(case.records))}. The page keeps the fitted parameters."
        )
    elif case.spectrum is not None and not of_code:
        notes.append(
            f"The motions of the ground have the spectrum {site}. The page keeps the "
            "parameters of the ground."
        )
        site = _kind_of(case)
    if case.records:
        notes.append(
            "The gaps of the records are shown beside those of the rules; a case file saved "
            "here contains no records."
        )
    if lost := _left_out(case):
        notes.append(f"{lost} left out here, and in a case file saved here.")
    if site not in GROUNDS:
        given = {"intensity": given["intensity"]}
    names = case.ground.beside_structures()
    values: dict[str, Any] = {name: given[own] for name, own in names.items() if own in given}
    values["ground_of_file"] = case.ground if site == PARALLEL else None
    values |= {"site": site} | of_code
    values["envelope"] = NONE
    masses, storeys = list(Scene.floor_masses), list[StoreysOfFile | None](Scene.storeys_of_file)
    for number, building in enumerate(case.pair, start=1):
        if isinstance(building, Building):
            shown, told = _shown_oscillator(case, building)
            notes += told
        else:
            _check_storeys(case, building)
            masses[number - 1] = float(building.structure.arrays()["masses"].mean())
            shown = _shown_storeys(building)
            if shown["description"] == OF_FILE:
                storeys[number - 1] = StoreysOfFile.of(building.structure)
        values |= {f"{name}_{number}": value for name, value in shown.items()}
        values[f"yields_{number}"] = building.structure.yields
    if case.envelope is not None:
        values["envelope"] = next(n for n, kind in ENVELOPES.items() if type(case.envelope) is kind)
        values |= _numbers(case.envelope)
    if case.gap is None:
        notes.append(f"The file has no existing gap: the page starts from {Scene.gap:g} m.")
    else:
        values["gap"] = case.gap
    notes += [f"Motions scatter by {case.scatter:g}, as in the file; {MEDIAN}."] if case.scatter else []
    values["records"] = RecordsOfFile(case.inputs[0], case.records) if case.records else None
    kept = (
        *("title", "confidence", "duration", "scatter", "floors_align", "zone", "unverified"),
        *("paths", "seed"),
    )
    scene = Scene(
        names=(case.first.name, case.second.name),
        heights=(case.first.height, case.second.height),
        storeys=(case.first.storeys, case.second.storeys),
        floor_masses=(masses[0], masses[1]),
        storeys_of_file=(storeys[0], storeys[1]),
        **values,
        **{name: getattr(case, name) for name in (*kept, "paths", "seed")},
    )
    return scene, notes


def _kind_of(case: Case) -> str:
    return next((name for name, kind in GROUNDS.items() if type(case.ground) is kind), PARALLEL)


def _left_out(case: Case) -> str:
    """What of the file pounding alone asks for, as the beginning of a sentence."""
    weighed = any(isinstance(one, Building) and one.weighed for one in case.pair)
    there = {"masses": weighed, "contact": case.contact is not None, "measures": case.measures}
    parts = [name for name, given in there.items() if given]
    if not parts:
        return ""
    *others, last = parts
    listed = f"{', '.join(others)} and {last}" if others else last
    return f"{listed.capitalize()} {'is' if parts == ['contact'] else 'are'}"


def _shown_oscillator(case: Case, building: Building) -> tuple[dict[str, Any], list[str]]:
    """Its numbers, and what they do not hold of it."""
    structure, notes = _bilinear(case, building), []
    if building.strength in ("yield_displacement", "ductility"):
        notes.append(
            f"The strength of {building.name}, given by {building.strength.replace('_', ' ')}, is kept "
            "as a reduction factor here: another ground or period changes its yield displacement."
        )
    if building.strength == "yield_displacement":
        factor = float(reduction_factor(structure, case.ground).reduction_factor)
        structure = dataclasses.replace(structure, yield_displacement=None, reduction_factor=factor)
    shown: dict[str, Any] = _numbers(structure)
    shown = {name: value for name, value in shown.items() if name not in ("peak_factor", "mass")}
    if building.storeys and building.storeys <= MOST_STOREYS:  # to start from, described by them
        shown["storey_count"] = building.storeys
        if building.storey_height and STOREY_HEIGHT.contains(building.storey_height):
            shown["storey_height"] = building.storey_height
    return shown, notes


def _shown_storeys(building: StoreyBuilding) -> dict[str, Any]:
    """Its numbers: those of a regular one, if they say all, or what changes the storeys of the file."""
    structure, told = building.structure, building.regular
    shown: dict[str, Any] = {"storey_count": structure.storeys, "damping": structure.damping}
    if structure.yields:
        shown["hardening"] = structure.hardening
    if told is not None and _plainly_regular(told):
        names = ("period", "storey_height", "base_shear_coefficient")
        return shown | {"description": REGULAR} | {name: told[name] for name in names if name in told}
    return shown | {"description": OF_FILE, "period": StoreysOfFile.of(structure).period}


def _plainly_regular(told: Mapping[str, Any]) -> bool:
    return (
        np.ndim(told["storey_height"]) == 0
        and told["law"] == "bilinear"
        and not told["p_delta"]
        and not np.any(told.get("dampers", 0.0))
        and bool(COEFFICIENT.contains(told.get("base_shear_coefficient", PLAUSIBLE_COEFFICIENT)))
    )


def _check_storeys(case: Case, building: StoreyBuilding) -> None:
    if building.storeys > MOST_STOREYS:
        raise ValueError(
            f"{case.file}: {building.name} has {building.storeys} storeys; allowed in the explorer: 1 "
            f"to {MOST_STOREYS}; 'stochlin gap' and 'stochlin probability' accept more"
        )


def _bilinear(case: Case, building: Building) -> Bilinear:
    if not isinstance(building.structure, Bilinear):
        raise ValueError(
            f"{case.file}: {building.name} is a {type(building.structure).__name__}; allowed in the "
            "explorer: bilinear buildings; 'stochlin gap' and 'stochlin probability' accept every law"
        )
    return building.structure


def _numbers(model: Model) -> dict[str, float]:
    return {name: float(value) for name, value in model.arrays().items()}


ALLOWED: Mapping[str, dataclasses.Field[Any]] = {
    field.name: field for field in dataclasses.fields(Scene) if "allowed" in field.metadata
}
"""The numbers of a scene, with ``units``, ``long_name`` and ``allowed`` in their metadata."""
