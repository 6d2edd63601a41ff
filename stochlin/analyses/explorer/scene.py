"""A scene: ground, two buildings, gap and motion by single numbers, from sliders or a case file."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from stochlin.analyses.cases.buildings import Building
from stochlin.analyses.cases.case import FEWEST_PATHS, Case
from stochlin.analyses.cases.site import FITTED, NONE
from stochlin.analyses.linearization.strength import reduction_factor
from stochlin.analyses.linearization.transient_systems import check_course
from stochlin.analyses.tables.checks import check_confidence, check_duration, check_whole
from stochlin.messages import brief
from stochlin.models.envelopes import ENVELOPES, AminAng, Envelope, GammaEnvelope, ShinozukaSato
from stochlin.models.grounds import GROUNDS, Ground, KanaiTajimi
from stochlin.models.grounds.named import ground_names, named_ground
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.parameters import POSITIVE, Model, Range, parameter
from stochlin.models.structures import DAMPING, HARDENING

SITES = (*ground_names(), *GROUNDS)
SHAPES = (*ENVELOPES, NONE)
MOST_PATHS = 20_000
# So that no entry asks for work of hours.
PERIOD = Range(0.02, 20.0, True, True)
FACTOR = Range(upper=100.0, include_upper=True)
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

    Of ground and envelope only the parameters of the chosen ``site`` and ``envelope`` count; the
    others wait for another choice. What no control shows is kept for the case file.
    """

    site: str = "firm"
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
    period_2: float = parameter("s", "period", PERIOD, 0.6)
    damping_2: float = parameter("1", "damping ratio", DAMPING, 0.05)
    yields_2: bool = True
    hardening_2: float = parameter("1", "hardening ratio", HARDENING, 0.05)
    reduction_factor_2: float = parameter("1", "reduction factor R", FACTOR, 4.0)
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
    paths: int = 2048
    seed: int = 0
    title: str = "Two buildings"
    names: tuple[str, str] = ("Building 1", "Building 2")
    heights: tuple[float | None, float | None] = (None, None)
    storeys: tuple[int | None, int | None] = (None, None)
    floors_align: bool = False
    zone: str | None = None
    unverified: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        for name, value, allowed in (("site", self.site, SITES), ("envelope", self.envelope, SHAPES)):
            if value not in allowed:
                raise ValueError(f"{name} = {brief(value)} is not known; allowed: {', '.join(allowed)}")
        check_count("paths", self.paths)
        check_confidence(self.confidence)
        check_course(self.duration, self.motion_envelope())
        one, two = self.structures()
        check_duration(self.duration, {"building 1": one, "building 2": two})

    def ground(self) -> Ground:
        """The ground of the site, at this intensity."""
        if self.site not in GROUNDS:
            return named_ground(self.site, self.intensity)
        kind: Any = GROUNDS[self.site]
        return kind(**self.site_parameters())

    def site_parameters(self) -> dict[str, float]:
        """What the case file says of the ground beside its name."""
        kind = GROUNDS[self.site if self.site in GROUNDS else "white_noise"]  # a name has its strength
        return {own: getattr(self, name) for name, own in names_of(kind).items()}

    def structures(self) -> tuple[Bilinear, Bilinear]:
        """Both buildings, the left one first."""
        return self.structure(1), self.structure(2)

    def structure(self, number: int, **changed: Any) -> Bilinear:
        """Building 1 or 2, with other parameters where they are given."""
        names = ["period", "damping"]
        if getattr(self, f"yields_{number}"):
            names += ["hardening", "reduction_factor"]
        return Bilinear(**{name: getattr(self, f"{name}_{number}") for name in names} | changed)

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
        }

    def for_codes(self) -> dict[str, Any]:
        """What building codes ask for beside the peaks."""
        height_1, height_2 = self.heights
        return {
            "height_1": height_1,
            "height_2": height_2,
            "floors_align": self.floors_align,
            "zone": self.zone,
        }


def check_count(name: str, value: object) -> int:
    """A number of simulated motions; raises a ValueError for another value."""
    check_whole(name, value, FEWEST_PATHS, MOST_PATHS)
    return value  # type: ignore[return-value]


def scene_of(case: Case) -> tuple[Scene, list[str]]:
    """The scene of a case file, and in sentences what of the file it cannot hold.

    A ValueError if a number lies beyond what the explorer takes.
    """
    one, other = case.oscillators
    notes = []
    site, given = case.site, _numbers(case.ground)
    if site == FITTED:
        site = next(name for name, kind in GROUNDS.items() if type(case.ground) is kind)
        notes.append(f"The ground is fitted to {next(iter(case.records))}: held by its parameters here.")
    if case.records:
        notes.append("Records are left out here, and in a case file saved from here.")
    if case.contact is not None or case.measures or any(b.structure.mass for b in (one, other)):
        notes.append(
            "Masses, contact and measures are left out here, and in a case file saved from here."
        )
    if site not in GROUNDS:
        given = {"intensity": given["intensity"]}
    names = case.ground.beside_structures()
    values: dict[str, Any] = {name: given[own] for name, own in names.items() if own in given}
    values["envelope"] = NONE
    for number, building in enumerate((one, other), start=1):
        structure = _bilinear(case, building)
        if building.strength in ("yield_displacement", "ductility"):
            notes.append(
                f"The strength of {building.name}, given by {building.strength.replace('_', ' ')}, is "
                "held as a reduction factor here: another ground or period changes its yield "
                "displacement."
            )
        if building.strength == "yield_displacement":
            factor = float(reduction_factor(structure, case.ground).reduction_factor)
            structure = dataclasses.replace(structure, yield_displacement=None, reduction_factor=factor)
        shown = _numbers(structure).items()
        values |= {f"{n}_{number}": value for n, value in shown if n not in ("peak_factor", "mass")}
        values[f"yields_{number}"] = structure.yields
    if case.envelope is not None:
        values["envelope"] = next(n for n, kind in ENVELOPES.items() if type(case.envelope) is kind)
        values |= _numbers(case.envelope)
    if case.gap is None:
        notes.append(f"The file states no existing gap: {Scene.gap:g} m is shown, as a start.")
    else:
        values["gap"] = case.gap
    kept = ("title", "confidence", "duration", "floors_align", "zone", "unverified", "paths", "seed")
    scene = Scene(
        site=site,
        names=(one.name, other.name),
        heights=(one.height, other.height),
        storeys=(one.storeys, other.storeys),
        **values,
        **{name: getattr(case, name) for name in kept},
    )
    return scene, notes


def _bilinear(case: Case, building: Building) -> Bilinear:
    if not isinstance(building.structure, Bilinear):
        raise ValueError(
            f"{case.file}: {building.name} is a {type(building.structure).__name__}; allowed in the "
            "explorer: bilinear buildings; 'stochlin gap' and 'stochlin probability' take every law"
        )
    return building.structure


def _numbers(model: Model) -> dict[str, float]:
    return {name: float(value) for name, value in model.arrays().items()}


ALLOWED: Mapping[str, dataclasses.Field[Any]] = {
    field.name: field for field in dataclasses.fields(Scene) if "allowed" in field.metadata
}
"""The numbers of a scene, with ``units``, ``long_name`` and ``allowed`` in their metadata."""
