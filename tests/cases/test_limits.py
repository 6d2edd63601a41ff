"""Values that no building has are asked about alike in Python, in a case file and in its form."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from motions import motion, write_at2

import stochlin as sl
from stochlin.applications.cases.reading.case import read_case
from stochlin.applications.cases.reading.kinds import WithUnit, keys_of
from stochlin.applications.cases.reading.tables import Form
from stochlin.applications.explorer.uploads import read_upload
from stochlin.models.parameters import Model
from stochlin.models.plausible import ANY, PLAUSIBLE, Plausible

pytestmark = pytest.mark.invariant

PAIR = [sl.Bilinear(T, 0.05, mass=1e6) for T in (0.6, 1.0)]
FIRM = sl.named_ground("firm", intensity=0.01)
FEW = {"duration": 2.0, "paths": 32}
STIFF = 1e9  # N/m
OF_ONE = {"period": 0.4, "storeys": 1, "storey_height": 3.0, "mass": 1e5, "damping": 0.05}
SINE = np.sin(np.arange(200) / 5)
WIDE = sl.HazardCurve([0.1, 1.0, 3.0, 6.0, 20.0], [1.0, 0.05, 1 / 475, 1 / 2475, 1e-6])
SPECTRUM = "period,Sa [m/s^2]\n0,{0}\n0.1,{1}\n0.2,{1}\n0.4,{0}\n0.8,{0}\n"


def stiffness(mass: float, height: float, ratio: float) -> float:
    """Stiffness of a storey [N/m] by its period over that which is usual for its height."""
    return float(mass * (2 * np.pi / (0.05 * ratio * height**0.75)) ** 2)


def storey(
    mass: float = 1e5, height: float = 3.0, ratio: float = 2.0, **more: Any
) -> sl.ShearBuilding:
    return sl.ShearBuilding([mass], [stiffness(mass, height, ratio)], [height], 0.05, **more)


def hazard(design: float) -> sl.HazardCurve:
    return sl.HazardCurve([design / 2, design, 2 * design], [1 / 100, 1 / 475, 1 / 2475])


def record(folder: Path, peak: float = 3.0, dt: float = 0.02, samples: int = 200) -> Path:
    """A file of a record."""
    shape = np.sin(np.arange(samples) * np.pi / 2)
    write_at2(motion(peak * shape / np.abs(shape).max(), dt), folder / "record.at2")
    return folder / "record.at2"


def shaken(velocity: float, acceleration: float = 3.0, dt: float = 0.02) -> xr.DataArray:
    """A record with these largest values: one pulse to either side, and an impulse of the peak."""
    pulse = velocity / (50 * dt)
    values = np.zeros(200)
    values[50:100], values[100:150] = pulse, -pulse
    values[170], values[171] = acceleration, -acceleration
    return motion(values, dt)


def jerk(ratio: float) -> xr.DataArray:
    """A record by its largest velocity over its peak [s]: a square wave of so long halves."""
    dt = ratio / 100 if ratio > 0.5 else ratio / 2
    return motion(np.tile(np.repeat([1.5, -1.5], round(ratio / dt)), 4), dt)


def written(record: xr.DataArray, folder: Path) -> Path:
    """A file of a record."""
    write_at2(record, folder / "record.at2")
    return folder / "record.at2"


def spectrum(folder: Path, largest: float) -> Path:
    """A file of a spectrum."""
    (folder / "site.csv").write_text(SPECTRUM.format(0.4 * largest, largest), encoding="utf-8")
    return folder / "site.csv"


def bent(folder: Path, ratio: float) -> Path:
    """A file of a bilinear pushover curve, by its hardening ratio, which its idealization has."""
    (folder / "push.csv").write_text(
        f"roof [m],base shear [N]\n0,0\n0.025,5e5\n0.05,1e6\n0.2,{1e6 * (1 + 3 * ratio)!r}\n",
        encoding="utf-8",
    )
    return folder / "push.csv"


def kinked(ratio: float) -> tuple[list[float], list[float]]:
    """Intensities and frequencies of a hazard, by the slope of a part over those beside it."""
    steps = np.cumsum([0.0, 2.0, 2.0 * ratio, 2.0])
    return [0.5, 1.0, 2.0, 4.0], [float(0.02 * 2.0**-step) for step in steps]


def storeys(drifts: list[float]) -> sl.ShearBuilding:
    return sl.ShearBuilding([1e5] * 2, [1e8] * 2, [3.0] * 2, 0.05, 0.05, yield_drifts=drifts)


def cut_off(folder: Path, ratio: float) -> Path:
    """A file of a record of 6 s, by its last second over its peak."""
    samples = np.tile([2.0, 0.0, -2.0, 0.0], 75)
    samples[-50:] *= ratio
    return written(motion(samples), folder)


def lone_peak(folder: Path, ratio: float) -> Path:
    """A file of a record, by its peak over all other samples."""
    samples = np.tile([2.0, 0.0, -2.0, 0.0], 50)
    samples[100] *= ratio
    return written(motion(samples), folder)


def spectrum_through(folder: Path, rows: list[tuple[float, float]]) -> Path:
    """A file of a spectrum through these periods and ordinates."""
    text = "\n".join(f"{period!r},{ordinate!r}" for period, ordinate in rows)
    (folder / "site.csv").write_text(f"period,Sa [m/s^2]\n{text}\n", encoding="utf-8")
    return folder / "site.csv"


def plateau(folder: Path, end: float) -> Path:
    """A file of a spectrum, by the period at which its plateau ends."""
    rows = [(0.0, 2.0), (0.1, 5.0), (end, 5.0), (2 * end, 2.5), (4 * end, 1.25)]
    return spectrum_through(folder, rows)


def jumping_spectrum(folder: Path, jump: float) -> Path:
    """A spectrum's file, by how much an ordinate is less than that before and the periods allow."""
    rows = [(0.0, 2.0), (0.2, 5.0), (0.4, 5.0), (0.5, 5.0 / jump / 1.25**2), (0.6, 1.0)]
    return spectrum_through(folder, rows)


def far_spectrum(folder: Path, displacement: float) -> Path:
    """A file of a spectrum, by its displacement at 10 s."""
    rows = [
        (0.0, 3.0),
        (0.5, 6.0),
        (1.0, 6.0),
        (2.0, 4.0),
        (10.0, displacement * (2 * np.pi / 10) ** 2),
    ]
    return spectrum_through(folder, rows)


def pushover(folder: Path, displacement: float = 0.2, force: float = 1e6) -> Path:
    """A file of a pushover curve, by its largest displacement and base shear."""
    rows = [(0.0, 0.0), (0.2, 0.6), (0.5, 0.9), (1.0, 1.0)]
    text = "\n".join(f"{u * displacement!r},{v * force!r}" for u, v in rows)
    (folder / "push.csv").write_text(f"roof [m],base shear [N]\n{text}\n", encoding="utf-8")
    return folder / "push.csv"


def drifts(x: float) -> object:
    """A building beside a wall in space, from which the ground moves away so far in 2 s."""
    row, concrete = [sl.Wall("space"), PAIR[0]], sl.Kelvin(STIFF, restitution=0.65)
    return sl.pound(row, 0.5, concrete, motion(np.full(101, x / 2)))


def pressed(depth: float) -> object:
    """Two buildings whose contact is pressed together so much: all is linear, and without a gap."""
    shaken = motion(SINE)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sl.ImplausibleInput)
        deepest = float(
            sl.pound(PAIR, 0.0, sl.LinearSpring(STIFF), shaken).deepest_compression.max()
        )
    return sl.pound(PAIR, 0.0, sl.LinearSpring(STIFF), motion(depth / deepest * shaken))


def modes(folder: Path, lowest: float) -> Path:
    """A file of a mode, by its displacement at the lower one of two floors."""
    rows = f"mode,,1\nperiod [s],,0.4\nlevel [m],mass [t],shape\n3,200,{lowest!r}\n6,200,1\n"
    (folder / "modes.csv").write_text(rows, encoding="utf-8")
    return folder / "modes.csv"


def mitigated(share: float) -> object:
    """A dashpot between two buildings by its constant over ``2 m w``, which their gap needs not."""
    mean = (2 * np.pi / 0.6 + 2 * np.pi / 1.0) / 2
    link = sl.Link(damping_constant=share * 2 * 5e5 * mean)
    return sl.mitigate(*PAIR, FIRM, 0.8, {"dashpot": sl.Measure(link=link)}, duration=2.0, paths=32)


# A call with a value in SI, and a folder for files.
PYTHON: dict[str, Callable[[float, Path], object]] = {
    "period": lambda x, _: sl.Bilinear(x, 0.05),
    "damping": lambda x, _: sl.Bilinear(1.0, x),
    "hardening": lambda x, _: sl.Bilinear(1.0, 0.05, x, 0.05),
    "deflection over behaviour": lambda x, _: sl.code_gaps(
        0.1, 0.1, behaviour_1=2.0, deflection_1=2 * x
    ),
    "yield drift upwards": lambda x, _: storeys([0.005, 0.005 * x]),
    "mean height of three storeys": lambda x, _: sl.code_gaps(
        0.1, 0.1, height_1=3 * x, storeys_1=3
    ),
    "pga of 10 years": lambda x, _: sl.HazardCurve([0.5 * x, x, 6.0], [0.2, 0.1, 1 / 475]),
    "contact stiffness": lambda x, _: sl.LinearSpring(x),
    "last second over the peak": lambda x, folder: sl.read_record(cut_off(folder, x)),
    "stiffness over its neighbours": lambda x, _: sl.ShearBuilding(
        [1e5] * 3, [1e8, x * 1e8, 1e8], [3.0] * 3, 0.05
    ),
    "largest z": lambda x, _: sl.BoucWen(1.0, 0.05, 0.05, 0.05, beta=0.5 / x, gamma=0.5 / x),
    "hardening of a pushover": lambda x, folder: sl.bilinear_of(
        sl.read_pushover(bent(folder, x)), target_displacement=0.2
    ),
    "kink of a hazard": lambda x, _: sl.HazardCurve(*kinked(x)),
    "decay": lambda x, _: sl.AminAng(2.0, 12.0, x),
    "damping of a contact": lambda x, _: sl.Kelvin(STIFF, damping_ratio=x),
    "high pass over ground": lambda x, _: sl.CloughPenzien(1.0, 0.6, x, 0.6),
    "return_period": lambda x, _: sl.PowerLawHazard(0.05, 3.0).intensity(x),
    "years of a risk": lambda x, _: sl.required_gap(
        *PAIR, FIRM, WIDE, risk=f"10 % in {x!r} years", **FEW
    ),
    "rarest of a hazard": lambda x, _: sl.HazardCurve([0.5, 1.5], [0.05, 1 / x]),
    "link over buildings": lambda x, _: mitigated(x),
    "damper over critical": lambda x, _: storey(
        dampers=x * 2 * np.sqrt(1e5 * stiffness(1e5, 3.0, 2.0))
    ),
    "peak over other samples": lambda x, folder: sl.read_record(lone_peak(folder, x)),
    "end of the plateau": lambda x, folder: sl.read_spectrum(plateau(folder, x), elastic=True),
    "ground_damping": lambda x, _: sl.KanaiTajimi(0.6, x),
    "ground_period": lambda x, _: sl.KanaiTajimi(x, 0.6),
    "years": lambda x, _: sl.pounding_risk(*PAIR, FIRM, 0.1, WIDE, years=x, **FEW),
    "acceleration at yield": lambda x, _: sl.Bilinear(1.0, 0.05, 0.05, x / (2 * np.pi) ** 2),
    "mass": lambda x, _: sl.Bilinear(1.0, 0.05, mass=x),
    "masses": lambda x, _: storey(mass=x),
    "heights": lambda x, _: storey(height=x),
    "storey_height": lambda x, _: sl.ShearBuilding.regular(**OF_ONE | {"storey_height": x}),
    "gap": lambda x, _: sl.existing_gap(*PAIR, FIRM, gap=x, **FEW),
    "gaps": lambda x, _: sl.pound(
        [*PAIR, PAIR[0]], [0.3, x], sl.LinearSpring(STIFF), motion(1e-6 * SINE)
    ),
    "behaviour": lambda x, _: sl.code_gaps(0.1, 0.1, behaviour_1=x, behaviour_2=3.0),
    "deflection": lambda x, _: sl.code_gaps(0.1, 0.1, deflection_1=3.0, deflection_2=x),
    "height": lambda x, _: sl.code_gaps(0.1, 0.1, height_1=x, height_2=30.0),
    "displacements": lambda x, _: sl.code_gaps(x, 0.1),
    "peak": lambda x, _: sl.critical_gap(0.1, x, 0.3),
    "yield_displacement": lambda x, _: sl.Bilinear(1.0, 0.05, 0.05, x),
    "yield_displacements": lambda x, _: sl.ModalBuilding(
        [0.4], [[0.6, 1.0]], [2e5, 1e5], [3.0, 3.0], 0.05, 0.05, x
    ),
    "reduction_factor": lambda x, _: sl.Bilinear(1.0, 0.05, 0.05, reduction_factor=x),
    "base_shear_coefficient": lambda x, _: sl.ShearBuilding.regular(
        **OF_ONE, hardening=0.05, base_shear_coefficient=x
    ),
    "intensity": lambda x, _: sl.simulated_motions(
        sl.named_ground("firm", intensity=x), 2.0, paths=2
    ),
    "duration": lambda x, _: sl.peak_response(PAIR[0], FIRM, x),
    "pga": lambda x, _: sl.scale_ground(FIRM, 2.0, pga=x, paths=64),
    "design_pga": lambda x, _: sl.code_gaps(0.1, 0.1, design_pga=x),
    "ag": lambda x, _: sl.eurocode_8(x, "C"),
    "sds": lambda x, _: sl.asce_7(x, 0.4 * x, 8.0),
    "sd1": lambda x, _: sl.asce_7(max(0.2 * 9.81, min(x, 30.0)), x, 8.0),
    "sd1 over sds": lambda x, _: sl.asce_7(5.0, 5.0 * x, 8.0),
    "sa": lambda x, _: sl.scale_ground(FIRM, 2.0, sa=x, period=0.5, paths=64),
    "confidence": lambda x, _: sl.separation(*PAIR, FIRM, confidence=x, **FEW),
    "risk": lambda x, _: sl.required_gap(*PAIR, FIRM, WIDE, risk=x, **FEW),
    "mean storey height": lambda x, _: sl.code_gaps(0.1, 0.1, height_1=2 * x, storeys_1=2),
    "period over 0.05 h^0.75": lambda x, _: storey(ratio=x),
    "stiffness upwards": lambda x, _: sl.ShearBuilding(
        [1e5] * 3, [1e8, 1e8, x * 1e8], [3.0] * 3, 0.05
    ),
    "mass upwards": lambda x, _: sl.ShearBuilding([1e5, x * 1e5], [1e8] * 2, [3.0] * 2, 0.05),
    "height upwards": lambda x, _: sl.ShearBuilding([1e5] * 2, [1e8] * 2, [3.0, x * 3.0], 0.05),
    "mode downwards": lambda x, _: sl.ModalBuilding([0.4], [[x, 1.0]], [2e5] * 2, [3.0] * 2, 0.05),
    "yield drift": lambda x, _: storey(hardening=0.05, yield_drifts=3 * x),
    "pga of 475 years": lambda x, _: hazard(x),
    "displacement at the start": lambda x, _: sl.Start([0.0, -x]),
    "velocity at the start": lambda x, _: sl.Start(ground_velocity=x),
    "displacement of the ground": lambda x, _: drifts(x),
    "penetration": lambda x, _: pressed(x),
    "peak of a record": lambda x, folder: sl.read_record(record(folder, peak=x)),
    "velocity of a record": lambda x, _: sl.recorded_gap(*PAIR, shaken(x, acceleration=4.0)),
    "velocity over acceleration of a record": lambda x, _: sl.recorded_gap(*PAIR, jerk(x)),
    "gap of a result": lambda x, _: sl.critical_gap(x / 2, x / 2, -1.0),
    "peak_factor": lambda x, _: sl.Bilinear(1.0, 0.05, peak_factor=x),
    "scatter": lambda x, _: sl.separation(*PAIR, FIRM, scatter=x, **FEW),
    "importance": lambda x, _: sl.code_gaps(
        0.1, 0.1, behaviour_1=3.0, behaviour_2=3.0, importance_1=x, importance_2=1.0
    ),
    "tl": lambda x, _: sl.asce_7(10.0, 5.0, x),
    "damping_constant": lambda x, _: sl.Link(damping_constant=x),
    "dampers": lambda x, _: storey(dampers=x),
    "pga of 2 years": lambda x, _: sl.HazardCurve([0.5 * x, x, 5.0], [1.0, 0.5, 1 / 475]),
    "time step of a record": lambda x, folder: sl.read_record(record(folder, dt=x)),
    "largest ordinate": lambda x, folder: sl.read_spectrum(spectrum(folder, x), elastic=True),
    "next ordinate": lambda x, folder: sl.read_spectrum(jumping_spectrum(folder, x), elastic=True),
    "spectral displacement": lambda x, folder: sl.read_spectrum(
        far_spectrum(folder, x), elastic=True, between="linear"
    ),
    "displacement of a pushover": lambda x, folder: sl.read_pushover(pushover(folder, x)),
    "force of a pushover": lambda x, folder: sl.read_pushover(pushover(folder, force=x)),
    "divided_by": lambda x, folder: sl.read_spectrum(spectrum(folder, 1.0), divided_by=x),
    "scale of a record": lambda x, _: sl.scale_records(
        {"a": motion(SINE)}, pga=x * abs(SINE).max()
    ),
}

FIRM_SITE = 'ground = "firm"\nintensity = "0.01 m^2/s^3"'
OSCILLATOR = 'period = "1 s"\ndamping = 0.05\n'
BY_STOREYS = 'damping = 0.05\nstorey_height = "3 m"\n'
YIELDS = "hardening = 0.05\n"
OF_CODES = 'displacements = "0.1 m"\nbehaviour_factor = 3\n'
KANAI_TAJIMI = 'ground = "kanai_tajimi"\nperiod = "0.6 s"\nintensity = "0.01 m^2/s^3"\n'
OF_HAZARD = '[site.hazard]\nmeasure = "pga"\n'
OF_TWO = """\
damping = 0.05
masses = ["1e5 kg", "1e5 kg"]
heights = ["3 m", "3 m"]
stiffnesses = ["1e8 N/m", "1e8 N/m"]
"""
REGULAR = 'period = "0.4 s"\nstoreys = 1\nfloor_mass = "1e5 kg"\ndamping = 0.05\n'


def oscillator(lines: str) -> dict[str, str]:
    return {"building_1": f"{lines}\nelastic = true"}


def stiffness_of(mass: float = 1e5, height: float = 3.0, ratio: float = 2.0) -> str:
    return f'stiffnesses = ["{stiffness(mass, height, ratio)!r} N/m"]'


# The tables of a case file with a value in SI.
FILES: dict[str, Callable[[float, Path], dict[str, str]]] = {
    "period": lambda x, _: {
        **oscillator(f'period = "{x!r} s"\ndamping = 0.05'),
        "motion": 'duration = "100 s"',
    },
    "damping": lambda x, _: oscillator(f'period = "1 s"\ndamping = {x!r}'),
    "hardening": lambda x, _: {
        "building_1": f'{OSCILLATOR}hardening = {x!r}\nyield_displacement = "5 cm"'
    },
    "deflection over behaviour": lambda x, _: {
        **oscillator(f"{OSCILLATOR}{OF_CODES}displacement_factor = {3 * x!r}"),
        "separation": 'confidence = 0.9\ncodes = ["asce_7"]',
    },
    "yield drift upwards": lambda x, _: {
        "building_1": f'{OF_TWO}{YIELDS}yield_drifts = ["5 mm", "{5 * x!r} mm"]'
    },
    "mean height of three storeys": lambda x, _: oscillator(
        f'{OSCILLATOR}height = "{3 * x!r} m"\nstoreys = 3'
    ),
    "pga of 10 years": lambda x, _: {
        "site": f'{FIRM_SITE}\n[site.hazard]\nmeasure = "pga"\nfrequencies = [0.2, 0.1, 0.002]\n'
        f'intensities = ["{0.5 * x!r} m/s^2", "{x!r} m/s^2", "6 m/s^2"]'
    },
    "stiffness over its neighbours": lambda x, _: oscillator(
        'damping = 0.05\nstorey_height = "3 m"\nmasses = ["1e5 kg", "1e5 kg", "1e5 kg"]\n'
        f'stiffnesses = ["1e8 N/m", "{x * 1e8!r} N/m", "1e8 N/m"]'
    ),
    "largest z": lambda x, _: {
        "building_1": f"{OSCILLATOR}{YIELDS}yield_displacement = "
        f'"5 cm"\nlaw = "bouc_wen"\nbeta = {0.5 / x!r}\ngamma = {0.5 / x!r}'
    },
    "hardening of a pushover": lambda x, folder: with_pushover(bent(folder, x)),
    "kink of a hazard": lambda x, _: {
        "site": f'{FIRM_SITE}\n[site.hazard]\nmeasure = "pga"\nfrequencies = {kinked(x)[1]}\n'
        f"intensities = {[f'{each!r} m/s^2' for each in kinked(x)[0]]}"
    },
    "last second over the peak": lambda x, folder: with_record(cut_off(folder, x)),
    "contact stiffness": lambda x, _: {
        "contact": f'model = "linear_spring"\nstiffness = "{x!r} N/m"'
    },
    "damper over critical": lambda x, _: oscillator(
        f'{BY_STOREYS}masses = ["1e5 kg"]\n{stiffness_of()}\n'
        f'dampers = "{float(x * 2 * np.sqrt(1e5 * stiffness(1e5, 3.0, 2.0)))!r} N s/m"'
    ),
    "peak over other samples": lambda x, folder: with_record(lone_peak(folder, x)),
    "end of the plateau": lambda x, folder: {
        "site": f'spectrum = "{plateau(folder, x).name}"\nelastic = true'
    },
    "ground_damping": lambda x, _: {"site": f"{KANAI_TAJIMI}damping = {x!r}"},
    "ground_period": lambda x, _: {
        "site": f"{KANAI_TAJIMI.replace('0.6 s', f'{x!r} s')}damping = 0.6"
    },
    "acceleration at yield": lambda x, _: {
        "building_1": f'{OSCILLATOR}{YIELDS}yield_displacement = "{x / (2 * np.pi) ** 2!r} m"'
    },
    "mass": lambda x, _: oscillator(f'{OSCILLATOR}mass = "{x!r} kg"'),
    "masses": lambda x, _: oscillator(f'{BY_STOREYS}masses = ["{x!r} kg"]\n{stiffness_of(mass=x)}'),
    "heights": lambda x, _: oscillator(
        f'damping = 0.05\nheights = ["{x!r} m"]\nmasses = ["1e5 kg"]\n{stiffness_of(height=x)}'
    ),
    "storey_height": lambda x, _: oscillator(f'{REGULAR}storey_height = "{x!r} m"'),
    "gap": lambda x, _: {"separation": f'confidence = 0.9\nexisting = "{x!r} m"'},
    "behaviour": lambda x, _: {
        **oscillator(f'{OSCILLATOR}displacements = "0.1 m"\nbehaviour_factor = {x!r}'),
        "separation": 'confidence = 0.9\ncodes = ["eurocode_8"]',
    },
    "deflection": lambda x, _: {
        **oscillator(f'{OSCILLATOR}displacements = "0.1 m"\ndisplacement_factor = {x!r}'),
        "separation": 'confidence = 0.9\ncodes = ["asce_7"]',
    },
    "height": lambda x, _: oscillator(f'{OSCILLATOR}height = "{x!r} m"'),
    "displacements": lambda x, _: {
        **oscillator(f'{OSCILLATOR}displacements = "{x!r} m"\nbehaviour_factor = 3'),
        "separation": 'confidence = 0.9\ncodes = ["eurocode_8"]',
    },
    "yield_displacement": lambda x, _: {
        "building_1": f'{OSCILLATOR}{YIELDS}yield_displacement = "{x!r} m"'
    },
    "yield_displacements": lambda x, folder: {
        "building_1": f'modes = "{modes(folder, 0.6).name}"\ndamping = 0.05\n{YIELDS}'
        f'yield_displacements = "{x!r} m"'
    },
    "reduction_factor": lambda x, _: {
        "building_1": f"{OSCILLATOR}{YIELDS}reduction_factor = {x!r}"
    },
    "base_shear_coefficient": lambda x, _: {
        "building_1": f'{REGULAR}{YIELDS}storey_height = "3 m"\nbase_shear_coefficient = {x!r}'
    },
    "intensity": lambda x, _: {"site": f'ground = "firm"\nintensity = "{x!r} m^2/s^3"'},
    "duration": lambda x, _: {"motion": f'duration = "{x!r} s"'},
    "pga": lambda x, _: {"site": f'ground = "firm"\npga = "{x!r} m/s^2"'},
    "design_pga": lambda x, _: {"separation": f'confidence = 0.9\ndesign_pga = "{x!r} m/s^2"'},
    "ag": lambda x, _: {"site": f'spectrum = "eurocode_8"\nag = "{x!r} m/s^2"\nsoil = "C"'},
    "sds": lambda x, _: {
        "site": f'spectrum = "asce_7"\nsds = "{x!r} m/s^2"\nsd1 = "{0.4 * x!r} m/s^2"\ntl = "8 s"'
    },
    "sd1": lambda x, _: {
        "site": f'spectrum = "asce_7"\nsds = "{max(2.0, min(x, 30.0))!r} m/s^2"\n'
        f'sd1 = "{x!r} m/s^2"\ntl = "8 s"'
    },
    "sd1 over sds": lambda x, _: {
        "site": f'spectrum = "asce_7"\nsds = "5 m/s^2"\nsd1 = "{5 * x!r} m/s^2"\ntl = "8 s"'
    },
    "sa": lambda x, _: {"site": f'ground = "firm"\nsa = "{x!r} m/s^2"\nsa_period = "0.5 s"'},
    "confidence": lambda x, _: {"separation": f"confidence = {x!r}"},
    "risk": lambda x, _: {
        "site": f'{FIRM_SITE}\n[site.hazard]\nmeasure = "pga"\nk0 = 0.02\nk = 2.5\nunits = "m/s^2"',
        "separation": f"confidence = 0.9\nrisk = {x!r}",
    },
    "decay": lambda x, _: {
        "motion": 'duration = "20 s"\nenvelope = "amin_ang"\n'
        'rise_end = "2 s"\nstrong_end = "12 s"\n'
        f'decay = "{x!r} 1/s"'
    },
    "damping of a contact": lambda x, _: {
        "contact": f'model = "kelvin"\nstiffness = "1e9 N/m"\ndamping_ratio = {x!r}'
    },
    "high pass over ground": lambda x, _: {
        "site": KANAI_TAJIMI.replace("kanai_tajimi", "clough_penzien").replace("0.6 s", "1 s")
        + f'damping = 0.6\nhigh_pass_period = "{x!r} s"\nhigh_pass_damping = 0.6'
    },
    "displacement upwards": lambda x, _: {
        **oscillator(f'{OF_TWO}displacements = ["5 cm", "{5 * x!r} cm"]\nbehaviour_factor = 3'),
        "separation": 'confidence = 0.9\ncodes = ["eurocode_8"]',
    },
    "return_period": lambda x, _: {
        "site": f'ground = "firm"\nreturn_period = "{x!r} yr"\n{OF_HAZARD}k0 = 0.05\nk = 3\n'
        'units = "m/s^2"'
    },
    "years of a risk": lambda x, _: {
        "site": f'{FIRM_SITE}\n{OF_HAZARD}k0 = 0.02\nk = 2.5\nunits = "m/s^2"',
        "separation": f'confidence = 0.9\nrisk = "10 % in {x!r} years"',
    },
    "rarest of a hazard": lambda x, _: {
        "site": f'{FIRM_SITE}\n{OF_HAZARD}intensities = ["0.5 m/s^2", "1.5 m/s^2"]\n'
        f'return_periods = ["20 yr", "{x!r} yr"]'
    },
    "mean storey height": lambda x, _: oscillator(
        f'{OSCILLATOR}height = "{2 * x!r} m"\nstoreys = 2'
    ),
    "period over 0.05 h^0.75": lambda x, _: oscillator(
        f'damping = 0.05\nheight = "16 m"\nperiod = "{0.05 * 8 * x!r} s"'
    ),
    "stiffness upwards": lambda x, _: oscillator(
        f'{BY_STOREYS}masses = ["1e5 kg", "1e5 kg", "1e5 kg"]\n'
        f'stiffnesses = ["1e8 N/m", "1e8 N/m", "{1e8 * x!r} N/m"]'
    ),
    "mass upwards": lambda x, _: oscillator(
        f'{BY_STOREYS}masses = ["1e5 kg", "{1e5 * x!r} kg"]\nstoreys = 2\n'
        f'stiffnesses = ["1e8 N/m", "1e8 N/m"]'
    ),
    "height upwards": lambda x, _: oscillator(
        f'damping = 0.05\nmasses = ["1e5 kg", "1e5 kg"]\nheights = ["3 m", "{3 * x!r} m"]\n'
        f'stiffnesses = ["1e8 N/m", "1e8 N/m"]'
    ),
    "mode downwards": lambda x, folder: oscillator(
        f'damping = 0.05\nmodes = "{modes(folder, x).name}"'
    ),
    "yield drift": lambda x, _: {
        "building_1": f'{BY_STOREYS}{YIELDS}masses = ["1e5 kg"]\n{stiffness_of()}\n'
        f'yield_drifts = "{3 * x!r} m"'
    },
    "pga of 475 years": lambda x, _: {
        "site": f'{FIRM_SITE}\n[site.hazard]\nmeasure = "pga"\n'
        'return_periods = ["475 yr", "2475 yr"]\n'
        f'intensities = ["{x!r} m/s^2", "{2 * x!r} m/s^2"]'
    },
    "peak of a record": lambda x, folder: with_record(record(folder, peak=x)),
    "velocity of a record": lambda x, folder: with_record(written(shaken(x, 4.0), folder)),
    "velocity over acceleration of a record": lambda x, folder: with_record(
        written(jerk(x), folder)
    ),
    "peak over that of the site": lambda x, folder: {
        "site": f'ground = "firm"\npga = "2 m/s^2"\n[[site.records]]\n'
        f'path = "{record(folder, peak=2 * x).name}"'
    },
    "scatter": lambda x, _: {"motion": f'duration = "20 s"\nscatter = {x!r}'},
    "importance_factor": lambda x, _: {
        **oscillator(f"{OSCILLATOR}{OF_CODES}importance_factor = {x!r}"),
        "separation": 'confidence = 0.9\ncodes = ["eurocode_8"]',
    },
    "tl": lambda x, _: {
        "site": f'spectrum = "asce_7"\nsds = "10 m/s^2"\nsd1 = "5 m/s^2"\ntl = "{x!r} s"'
    },
    "dampers": lambda x, _: oscillator(
        f'{BY_STOREYS}masses = ["1e5 kg"]\n{stiffness_of()}\ndampers = "{x!r} N s/m"'
    ),
    "pga of 2 years": lambda x, _: {
        "site": f'{FIRM_SITE}\n[site.hazard]\nmeasure = "pga"\nfrequencies = [1.0, 0.5, 0.002]\n'
        f'intensities = ["{0.5 * x!r} m/s^2", "{x!r} m/s^2", "5 m/s^2"]'
    },
    "time step of a record": lambda x, folder: with_record(record(folder, dt=x)),
    "largest ordinate": lambda x, folder: {
        "site": f'spectrum = "{spectrum(folder, x).name}"\nelastic = true'
    },
    "next ordinate": lambda x, folder: {
        "site": f'spectrum = "{jumping_spectrum(folder, x).name}"\nelastic = true'
    },
    "spectral displacement": lambda x, folder: {
        "site": f'spectrum = "{far_spectrum(folder, x).name}"\nelastic = true\nbetween = "linear"'
    },
    "displacement of a pushover": lambda x, folder: with_pushover(pushover(folder, x)),
    "force of a pushover": lambda x, folder: with_pushover(pushover(folder, force=x)),
    "divided_by": lambda x, folder: {
        "site": f'spectrum = "{spectrum(folder, 1.0).name}"\ndivided_by = {x!r}'
    },
    "scale of a record": lambda x, folder: with_record(record(folder), f"scale = {x!r}"),
}
# In a case file a gap is `existing`, displacements are those of a design, and years are 50; forces
# in contacts and walls are those of `stochlin pound`; motions begin from rest.
OF_PYTHON = {
    *("gap of a result", "gaps", "peak", "peak_factor", "penetration", "years"),
    *("damping_constant", "importance", "link over buildings"),
    *("displacement at the start", "velocity at the start", "displacement of the ground"),
}
OF_FILES = {"peak over that of the site", "importance_factor", "displacement upwards"}
# to which the explorer fits a ground
FITTED = {
    "pga",
    "sa",
    "ag",
    "sds",
    "sd1",
    "tl",
    "peak over that of the site",
    "largest ordinate",
    "next ordinate",
    "end of the plateau",
    "sd1 over sds",
    "spectral displacement",
    "divided_by",
}


def with_pushover(path: Path) -> dict[str, str]:
    return {"building_1": f'{REGULAR}storey_height = "3 m"\npushover = "{path.name}"'}


def with_record(path: Path, more: str = "") -> dict[str, str]:
    return {"site": f'{FIRM_SITE}\n[[site.records]]\npath = "{path.name}"\n{more}'}


def asked_in_python(name: str, value: float, folder: Path) -> list[str]:
    """The warnings of a call."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", sl.DoubtfulInput)
        PYTHON[name](value, folder)
    return [str(each.message) for each in caught]


def asked_in_a_file(name: str, value: float, folder: Path) -> list[str]:
    """The warnings of a case file, which are those of its form in the explorer."""
    return asked_of(FILES[name](value, folder), folder, in_form=name not in FITTED)


def asked_of(own: dict[str, str], folder: Path, in_form: bool = True) -> list[str]:
    """The warnings of a case file with these tables in place of the usual ones."""
    usual = {"site": FIRM_SITE, "motion": 'duration = "20 s"', "separation": "confidence = 0.9"}
    usual |= {f"building_{n}": f"{OSCILLATOR}elastic = true" for n in (1, 2)}
    tables = usual | own
    if "codes" in tables["separation"]:
        tables["building_2"] += f"\n{OF_CODES}displacement_factor = 3"
    text = "".join(f"[{table}]\n{lines}\n" for table, lines in tables.items())
    (folder / "case.toml").write_text(text, encoding="utf-8")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", sl.DoubtfulInput)
        read_case(folder / "case.toml")
    asked = [str(each.message) for each in caught]
    assert all(message.startswith("case.toml, line ") for message in asked)
    if in_form:
        _, of_form = read_upload(str(folder), "case.toml", text)
        assert of_form == [*dict.fromkeys(asked)]
    return asked


WAYS = {"python": (asked_in_python, PYTHON), "file": (asked_in_a_file, FILES)}


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("name", PLAUSIBLE)
def test_a_value_beyond_its_limits_is_asked_about_and_one_within_is_not(name, way, tmp_path):
    asked, known = WAYS[way]
    if (name in OF_PYTHON and way == "file") or (name in OF_FILES and way == "python"):
        assert name not in known
        return
    limits = PLAUSIBLE[name]
    said = f"usual are {limits.usual}"
    for limit, outwards in ((limits.low, -1), (limits.high, 1)):
        if 0 < limit < float("inf"):
            within, beyond = limit * (1 - 1e-6 * outwards), limit * (1 + 1e-6 * outwards)
            assert not [text for text in asked(name, within, tmp_path) if said in text]
            [text] = [text for text in asked(name, beyond, tmp_path) if said in text]
            assert limits.doubt(beyond) in text


def test_a_contact_of_concrete_is_not_asked_about_and_one_in_another_unit_is():
    """The largest compression in 64 motions, on which the limit rests; kN/m for N/m is 1/1000."""
    pair = [sl.Bilinear(T, 0.05, mass=m) for T, m in ((1.2, 2e5), (0.6, 3e5))]
    motions = sl.simulated_motions(FIRM, 20.0, paths=64)
    table = sl.pound(pair, 0.02, sl.Kelvin(STIFF, restitution=0.65), motions)
    assert float(table.deepest_compression.max()) == pytest.approx(0.012, rel=0.05)
    with pytest.warns(sl.ImplausibleInput, match="is the stiffness right"):
        sl.pound(pair, 0.02, sl.Kelvin(STIFF / 1000, restitution=0.65), motions)


def test_the_documentation_has_every_limit():
    """By name, in SI units, with a hyphen where there is none."""
    named: dict[Plausible, list[str]] = {}
    for name, limits in PLAUSIBLE.items():
        named.setdefault(limits, []).append(name)
    text = (Path(__file__).parents[2] / "docs/conventions.md").read_text(encoding="utf-8")
    rows = [line for line in text.splitlines() if line.endswith(" |") and line.count("|") == 4]
    for limits, names in named.items():
        low, high = (
            f"{limit:.3g}" if 0 < limit < float("inf") else "-"
            for limit in (limits.low, limits.high)
        )
        assert f"| {', '.join(names)} | {low} | {high} |" in rows


def below(kind: type) -> Iterator[Any]:
    """All subclasses of a class."""
    for each in kind.__subclasses__():
        yield each
        yield from below(each)


def test_limits_have_a_source_and_hold_for_numbers_of_one_unit():
    """Of all models; what a model declares on its own is of the table, or has no limits."""
    units: dict[Plausible, set[str]] = {}
    for model in below(Model):
        for name, limits in model.limits().items():
            assert limits in (ANY, *PLAUSIBLE.values())
            if limits != ANY and name in model.parameter_names():
                units.setdefault(limits, set()).add(model.units(name))
    assert all(len(each) == 1 for each in units.values())
    assert all(
        limits.source and limits.usual and limits.low < limits.high for limits in PLAUSIBLE.values()
    )


def test_keys_have_the_limits_of_their_names():
    """Of the keys of every form; the damping of a ground is that of its model."""
    seen = set()
    for form in below(Form):
        for name, known in keys_of(form).items():
            kind = getattr(known.kind, "kind", known.kind)  # of a list its numbers
            if isinstance(kind, WithUnit) and name in PLAUSIBLE:
                assert kind.plausible == PLAUSIBLE[name]
                seen.add(name)
    assert {"period", "damping", "masses", "pga", "duration", "confidence"} <= seen


def test_a_record_under_two_names_is_asked_about(tmp_path):
    for name in ("one", "two"):
        write_at2(shaken(0.3), tmp_path / f"{name}.at2")
    lines = "".join(f'[[site.records]]\npath = "{name}.at2"\n' for name in ("one", "two"))
    asked = asked_of({"site": f"{FIRM_SITE}\n{lines}"}, tmp_path)
    assert any("one.at2 and two.at2 are the same motion; is it to count" in text for text in asked)


@pytest.mark.parametrize(
    ("lines", "asked"),
    [
        ('period = "1 s"\ndamping = "0.15 to 0.22"', False),
        ('period = "1 s"\ndamping = "0.15 to 0.3"', True),
        ('period = "59 s +- 50 %"\ndamping = 0.05', False),
    ],
)
def test_of_an_uncertain_value_the_median_counts(lines, asked, tmp_path):
    long = {"motion": 'duration = "100 s"'}
    assert bool(asked_of(oscillator(lines) | long, tmp_path)) == asked


@pytest.mark.parametrize(
    ("other", "asked"),
    [(PAIR[0], True), (sl.Bilinear(0.6, 0.05, mass=3e6), True), (PAIR[1], False)],
)
def test_buildings_that_move_as_one_are_asked_about(other, asked, tmp_path):
    """The mass alone moves no oscillator otherwise; the same building twice is a copy."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", sl.DoubtfulInput)
        sl.separation(PAIR[0], other, FIRM, **FEW)
    assert any("are the same building" in str(each.message) for each in caught) == asked
    lines = {
        f"building_{n}": f'{OSCILLATOR.replace("1 s", f"{each.period} s")}mass = "{each.mass} kg"'
        for n, each in enumerate((PAIR[0], other), start=1)
    }
    texts = asked_of({name: f"{text}\nelastic = true" for name, text in lines.items()}, tmp_path)
    assert any("is the same as that before" in text for text in texts) == asked


def test_a_motion_that_ends_in_its_strong_part_is_asked_about():
    """Until its strong part is over, and before it begins."""
    for duration, asked in ((3.0, "before its"), (14.0, "in its"), (15.5, "")):
        text = sl.AminAng(4.0, 15.0, 0.35).doubt(duration)
        assert bool(text) == bool(asked)
        assert asked in text
