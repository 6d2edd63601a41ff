"""Scene of the explorer: parameters of ground, buildings, gap and motion, from controls or a file."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import xarray as xr

from stochlin.analyses.cases.files.schema import FEWEST_PATHS
from stochlin.analyses.cases.site import NONE, PARALLEL
from stochlin.analyses.cases.storeys import SlabOnColumn, StoreyBuilding, slabs_of_row
from stochlin.analyses.explorer.buildings import (
    DESCRIPTIONS,
    OF_FILE,
    OSCILLATOR,
    StoreysOfFile,
)
from stochlin.analyses.explorer.sites import (
    CODES,
    MEASURES,
    NAMES,
    PGA,
    S0,
    SA,
    SOILS,
    SPECTRA,
    TYPES,
    Fitted,
    G,
    MeasuredAcceleration,
    Shape,
    SiteMotions,
    SpectrumOfFile,
    kind_of,
)
from stochlin.analyses.explorer.sites import OF_FILE as OF_SPECTRUM_FILE
from stochlin.analyses.linearization.strength import reduction_factor, strength_in_metres
from stochlin.analyses.linearization.transient_systems import check_course
from stochlin.analyses.sites.spectra import USUAL_DAMPING
from stochlin.analyses.tables.checks import check_duration
from stochlin.kernels.basics.parallel import Progress
from stochlin.messages import brief
from stochlin.models.arguments import SCATTER, Whole
from stochlin.models.buildings import ShearBuilding
from stochlin.models.envelopes import ENVELOPES, AminAng, Envelope, GammaEnvelope, ShinozukaSato
from stochlin.models.grounds import GROUNDS, Ground, KanaiTajimi, ParallelGround
from stochlin.models.grounds.named import ground_names, named_ground
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.parameters import POSITIVE, Model, Range, parameter
from stochlin.models.plausible import PLAUSIBLE
from stochlin.models.rules.codes import Neighbours
from stochlin.models.structures import DAMPING, HARDENING
from stochlin.models.systems import AnyStructure

SITES = (*ground_names(), *GROUNDS, *CODES)
SHAPES = (*ENVELOPES, NONE)
# How the strength of an oscillator is given, and the number that then gives it.
STRENGTHS = {"reduction factor R": "reduction_factor", "yield displacement": "yield_displacement"}
BY_FACTOR, BY_DISPLACEMENT = STRENGTHS
# Limits that keep the computing time below hours.
MOST_PATHS, MOST_STOREYS = 20_000, 60
PERIOD = Range(0.02, 20.0, True, True)
FACTOR = Range(upper=100.0, include_upper=True)
STOREY_HEIGHT = Range(1.0, 20.0, True, True)
COEFFICIENT = Range(
    upper=PLAUSIBLE["base_shear_coefficient"].high, include_upper=True, reason="a share of the weight"
)
WHOLE = {
    "paths": Whole(FEWEST_PATHS, MOST_PATHS),
    "storey_count_1": Whole(1, MOST_STOREYS),
    "storey_count_2": Whole(1, MOST_STOREYS),
}
"""Whole numbers of a scene, with their limits."""
DURATION = Range(1.0, 300.0, True, True)
SOIL = KanaiTajimi.allowed("damping")


def _with_all_parameters(scene: type[Scene]) -> type[Scene]:
    """The class with a parameter for each parameter of grounds and envelopes that it lacks."""
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
    """Names of the parameters of a ground or envelope in a scene, with their own names as values."""
    if kind is not None and issubclass(kind, Ground):
        return kind.beside_structures()
    return {name: name for name in kind.parameter_names()} if kind else {}


@dataclass(frozen=True)
class CaseFile:
    """Original case file of a scene, with its tables and recorded motions; compared by its path."""

    file: Path
    motions: Mapping[str, xr.DataArray] = field(compare=False, repr=False)
    values: Mapping[str, Any] = field(compare=False, repr=False)


@_with_all_parameters
@dataclass(frozen=True, kw_only=True)
class Scene(Model):
    """Parameters of the controls of the explorer, in SI units.

    Only the parameters of the chosen ``site``, ``envelope`` and ``description`` of a building are used;
    the others are kept for another choice. ``ground_of_file`` belongs to the site ``"parallel"``, and
    ``spectrum_of_file`` to the site ``"spectrum of the file"``. Parameters without a control are kept
    for the case file: ``scatter``; ``storeys`` and ``heights`` of oscillators; ``floor_masses`` [kg] of
    regular buildings, which do not change any result; ``numbers`` of code rules; and ``case_file`` with
    the rest of the file.
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
    spectrum_of_file: SpectrumOfFile | None = None
    spectrum_scale: float = parameter("1", "factor on the spectrum of the file", POSITIVE, 1.0)
    spectrum_damping: float = USUAL_DAMPING
    fitted: Fitted | None = None
    measured: MeasuredAcceleration | None = None
    case_file: CaseFile | None = None
    intensity: float = parameter("m^2/s^3", "intensity S0 of the ground", POSITIVE, 0.01)
    ground_period: float = parameter("s", "ground period", PERIOD, 1.0)
    ground_damping: float = parameter("1", "ground damping ratio", SOIL, 0.3)
    high_pass_period: float = parameter("s", "high-pass period", POSITIVE, 4.0)
    high_pass_damping: float = parameter("1", "high-pass damping ratio", POSITIVE, 0.6)
    period_1: float = parameter("s", "period", PERIOD, 1.0)
    damping_1: float = parameter("1", "damping ratio", DAMPING, 0.05)
    yields_1: bool = True
    hardening_1: float = parameter("1", "hardening ratio", HARDENING, 0.05)
    strength_by_1: str = BY_FACTOR
    reduction_factor_1: float = parameter("1", "reduction factor R", FACTOR, 4.0)
    yield_displacement_1: float = parameter("m", "yield displacement", POSITIVE, 0.03)
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
    strength_by_2: str = BY_FACTOR
    reduction_factor_2: float = parameter("1", "reduction factor R", FACTOR, 4.0)
    yield_displacement_2: float = parameter("m", "yield displacement", POSITIVE, 0.03)
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
    same_property: bool = False
    same_system: bool = False
    zone: str | None = None
    numbers: tuple[tuple[str, float], ...] = ()
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
            **{f"strength_by_{n}": tuple(STRENGTHS) for n in (1, 2)},
        }
        for name, allowed in chosen.items():
            if (value := getattr(self, name)) not in allowed:
                raise ValueError(f"{name} = {brief(value)} is not known; allowed: {', '.join(allowed)}")
        for name, limits in WHOLE.items():
            limits(name, getattr(self, name))
        SCATTER("scatter", self.scatter)
        check_course(self.duration, self.motion_envelope())
        first, second = self.structures()
        check_duration(self.duration, {"building 1": first, "building 2": second})

    def ways_to_describe(self, number: int) -> tuple[str, ...]:
        """Possible descriptions of building 1 or 2; storeys of the file only if it has some."""
        return DESCRIPTIONS if self.storeys_of_file[number - 1] else DESCRIPTIONS[:-1]

    def sites(self) -> tuple[str, ...]:
        """Possible sites; those with a ground or spectrum of the file only if it has one."""
        of_file = {PARALLEL: self.ground_of_file, OF_SPECTRUM_FILE: self.spectrum_of_file}
        return (*SITES, *(name for name, part in of_file.items() if part))

    @property
    def records(self) -> Mapping[str, xr.DataArray]:
        """Recorded motions of the case file by name."""
        return self.case_file.motions if self.case_file else {}

    def ground(self) -> Ground:
        """Ground of the scene with its intensity; raises a ValueError unless it is `settled`."""
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
        """Mean acceleration or parameter of a spectrum [m/s^2], or factor on a spectrum of the file.

        It determines the intensity of the ground unless this is given itself.
        """
        by_measure = "pga" if self.measure == PGA else "sa"
        return float(getattr(self, NAMES.get(self.site, (by_measure,))[0]))

    @property
    def shape(self) -> Shape | None:
        """Shape of the spectrum to which the ground is fitted; None for other sites."""
        if self.site not in SPECTRA:
            return None
        kind = kind_of(self.site, vars(self))
        return Shape(self.site, kind, self.duration, self.motion_envelope())

    @property
    def motions(self) -> SiteMotions:
        """Motions of unit intensity, whose mean acceleration determines the intensity."""
        period = self.sa_period if self.measure == SA else None
        return SiteMotions(self._of_intensity(1.0), self.duration, self.motion_envelope(), period)

    @cached_property
    def settled(self) -> bool:
        """Whether the ground is known; otherwise `settle` determines it."""
        if self.shape is not None:
            return self.fitted is not None and self.fitted.shape == self.shape
        return self.measure == S0 or (
            self.measured is not None and self.measured.motions == self.motions
        )

    def settle(self, progress: Progress | None = None) -> Scene:
        """The scene with a known ground, fitted or scaled by simulations of a few seconds."""
        if self.settled:
            return self
        if self.shape is not None:
            return dataclasses.replace(self, fitted=self.shape.fitted(progress))
        return dataclasses.replace(self, measured=self.motions.measured(self.seed, progress))

    def site_parameters(self) -> dict[str, float]:
        """Parameters of the ground by their names in a case file."""
        kind = GROUNDS[
            self.site if self.site in GROUNDS else "white_noise"
        ]  # a named ground has the parameter intensity only
        return {own: getattr(self, name) for name, own in names_of(kind).items()}

    def structures(self) -> tuple[AnyStructure, AnyStructure]:
        """Both buildings; the first one is on the left."""
        return self.structure(1), self.structure(2)

    @property
    def has_storeys(self) -> bool:
        """Whether at least one building is described by storeys."""
        return (self.description_1, self.description_2) != (OSCILLATOR, OSCILLATOR)

    def structure(self, number: int, period: float | None = None) -> AnyStructure:
        """Building 1 or 2; a ``period`` replaces that of the scene."""
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
        """Building 1 or 2 as an oscillator; ``changed`` parameters replace those of the scene."""
        names = ["period", "damping"]
        if getattr(self, f"yields_{number}"):
            names += ["hardening", STRENGTHS[getattr(self, f"strength_by_{number}")]]
        return Bilinear(**self._of(number, *names) | changed)

    def equivalent_strength(self, number: int) -> tuple[str, float]:
        """Name and value of the parameter that gives oscillator 1 or 2 the same strength.

        It is the yield displacement if the strength is given as a reduction factor, and vice versa.
        """
        structure, ground = self.oscillator(number), self.ground()
        if structure.reduction_factor is None:
            name, value = "reduction_factor", reduction_factor(structure, ground).reduction_factor
        else:
            name = "yield_displacement"
            value = strength_in_metres(structure, ground).yield_displacement
        return f"{name}_{number}", float(value)

    def _of(self, number: int, *names: str) -> dict[str, Any]:
        return {name: getattr(self, f"{name}_{number}") for name in names}

    @property
    def slabs_on_columns(self) -> tuple[SlabOnColumn, ...]:
        """Slabs of one building at the height of columns of the other, from the ground up."""
        both = zip(self.names, self.structures(), strict=True)
        return slabs_of_row(
            [
                StoreyBuilding(name, structure, "")
                if isinstance(structure, ShearBuilding)
                else structure
                for name, structure in both
            ]
        )

    def motion_envelope(self) -> Envelope | None:
        """Envelope of the motions; None for stationary motions."""
        kind = ENVELOPES.get(self.envelope)
        return kind(**self.envelope_parameters()) if kind else None

    def envelope_parameters(self) -> dict[str, float]:
        """Parameters of the envelope by name."""
        return {name: getattr(self, name) for name in names_of(ENVELOPES.get(self.envelope))}

    def motion(self) -> dict[str, Any]:
        """Duration, envelope, confidence and scatter, as keyword arguments of the analyses."""
        return {
            "duration": self.duration,
            "envelope": self.motion_envelope(),
            "confidence": self.confidence,
            "scatter": self.scatter,
        }

    @property
    def neighbours(self) -> Neighbours:
        """What both buildings have in common; their floors align only if no slab meets a column."""
        align = self.floors_align and not self.slabs_on_columns
        return Neighbours(align, self.same_property, self.same_system)

    def for_codes(self) -> dict[str, Any]:
        """Arguments for rules of building codes; heights only of buildings without storeys."""
        heights = [
            None if isinstance(structure, ShearBuilding) else height
            for structure, height in zip(self.structures(), self.heights, strict=True)
        ]
        return {
            "height_1": heights[0],
            "height_2": heights[1],
            **vars(self.neighbours),
            "zone": self.zone,
            "numbers": dict(self.numbers),
        }


ALLOWED: Mapping[str, dataclasses.Field[Any]] = {
    field.name: field for field in dataclasses.fields(Scene) if "allowed" in field.metadata
}
"""The numbers of a scene, with ``units``, ``long_name`` and ``allowed`` in their metadata."""
