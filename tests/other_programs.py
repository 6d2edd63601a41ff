"""Numbers of other programs beside ours: ``python -m other_programs`` prints the table.

Published numbers and inputs are those of the validation manual of code_aster, by its case numbers:
SDND101, SDND102, SDLD101 and SDLL104. Those of OpenSeesPy, CVODE and others are the frozen ones of
the verification manual, whose cases run these programs.
"""

import sys
import warnings
from collections.abc import Callable, Iterator
from functools import cache, wraps
from typing import NamedTuple, TypeVar

import numpy as np
import scipy.optimize
import xarray as xr
from answers.frozen import Case, kept_independent, verified_answers
from answers.manual import rows as manual_rows
from motions import motion

import stochlin as sl
from stochlin.kernels.probability import hazards

# --- SDND101 a: 100 kg on 1e4 N/m, thrown at 1 m/s against a stop of 1e6 N/m that it touches, no
# damping
MASS, SPRING, STOP, SPEED = 100.0, 1e4, 1e6, 1.0
# --- SDND102 a: 25 kg, 98 696 N/m, 7 %, base acceleration sin(2 pi 10 t), stop of 5.76e7 N/m
#     in space at 0.5 mm; ten impacts. The ground starts at the velocity of a steady sine.
GROUND = 20 * np.pi  # [rad/s]
TIMES = [0.05, 0.156, 0.25, 0.4, 0.5, 0.8, 0.9, 1.0]
IN_SPACE = [-3.58082, -1.22321, -1.88760, -1.89772, -0.684454, -1.11982, -1.20103, -1.07178]
# --- SDLD101 a: 100 kg, 1e6 N/m, 5 %, on a ground whose acceleration has a two-sided spectral
#     density of 1 per Hz, from 0 to 100 Hz: spectral densities of the acceleration of the mass, in
#     space and relative to the ground, and spectral moments of the first
STIFF_SPRING = 1e6
SHOWN = [5.0, 10.0, 15.0, 20.0, 25.0]  # [Hz]
BESIDE_THE_PEAK = 15.0  # [Hz]: both densities do not have the ratio of their transfer functions
DENSITIES = {
    "absolute": [1.2307, 2.7116, 47.2154, 2.8924, 0.47047],
    "relative": [0.011976, 0.42096, 36.9225, 7.1006, 2.7953],
}
MOMENTS = [505.70832, 49047.8, 5.025066e6, 5.52943e8, 7.2046e10]
IN_STEPS_OF_1_HZ = [505.875781, 49053.6076, 5.02455989e6, 5.52783522e8, 7.203315e10]
OF_MOMENTS = {
    "standard deviation [m/s2]": 22.4879595,
    "extrema [1/s]": 38.11766,
    "zero crossings [1/s]": 31.73006,
    "mean frequency [Hz]": 15.865031,
    "irregularity": 0.83242414,
}
FINE = np.linspace(0.0, 100.0, 100_001)  # [Hz]
# --- SDLL104 a: Kanai-Tajimi of 5 Hz and 0.6, S0 = 1 per Hz, two-sided, at 0, 1 .. 50 Hz, trapezium
FREQUENCIES = np.arange(51.0)  # [Hz]
STRONG = 10.0  # [s]
# --- Cases of the verification manual: their folder, variables, and the cause of differences
FROM_MANUAL = {
    "two yielding oscillators": (
        "recorded_pair_in_opensees",
        ["peak_1", "peak_2", "separation"],
        "their steps of 0.2 ms",
    ),
    "3 and 2 storeys pound": (
        "pounding_in_opensees",
        ["impact_time", "peak", "peak_alone"],
        "their steps of 20 us",
    ),
    "5 and 8 storeys pound": (
        "frames_in_opensees",
        ["impact_time", "peak", "peak_alone"],
        "their steps of 50 us",
    ),
    "laws that degrade": ("laws_in_opensees", ["force", "peak"], "their law of first order"),
    "yielding pair pounds": (
        "pounding_in_cvode",
        ["impact_time", "largest_force", "peak"],
        "our steps",
    ),
    "frame of DR-PDEE": ("frame_of_ten_storeys", ["mean"], "our steps"),
}
Result = TypeVar("Result")


class Row(NamedTuple):
    """A published number, or one by another program, beside ours."""

    case: str
    quantity: str
    published: float
    computed: float
    cause: str

    @property
    def off(self) -> float:
        """Relative difference of the computed number."""
        return self.computed / self.published - 1


def of_small_masses(build: Callable[[], Result]) -> Callable[[], Result]:
    """The function without warnings that no building has such a mass or period."""

    @wraps(build)
    def quietly() -> Result:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", sl.ImplausibleInput)
            return build()

    return quietly


@cache
@of_small_masses
def thrown() -> xr.Dataset:
    """SDND101."""
    free = sl.Bilinear(2 * np.pi * np.sqrt(MASS / SPRING), 1e-12, mass=MASS)
    still = motion(np.zeros(40_001), 1e-5)
    start = sl.Start(velocity=SPEED)
    return sl.pound([free, sl.Wall()], 0.0, sl.LinearSpring(STOP), still, start=start)


@cache
@of_small_masses
def in_space() -> xr.Dataset:
    """SDND102."""
    time = 2e-5 * np.arange(50_001)
    base = motion(np.sin(GROUND * time), 2e-5)
    beam = sl.Bilinear(2 * np.pi * np.sqrt(25 / 98_696), 0.07, mass=25.0)
    start = sl.Start(ground_velocity=-1 / GROUND)
    return sl.pound([beam, sl.Wall("space")], 5e-4, sl.LinearSpring(5.76e7), base, start=start)


def absolute(table: xr.Dataset) -> xr.DataArray:
    """Displacement of the mass in space [m]."""
    return table.displacement.isel(structure=0) - table.wall_displacement


@cache
@of_small_masses
def oscillator() -> xr.Dataset:
    """The state matrix of SDLD101, on white noise."""
    period = 2 * np.pi * np.sqrt(MASS / STIFF_SPRING)
    return sl.statespace([sl.Bilinear(period, 0.05)], sl.WhiteNoise(1 / (2 * np.pi)))


def densities(frequencies: np.ndarray) -> dict[str, np.ndarray]:
    """Spectral densities of the acceleration of SDLD101 at frequencies in Hz, per Hz.

    By the transfer functions x of the states u and v, with ``s x = A x + b`` and ``s = i w``.
    """
    space = oscillator()
    matrix, push = space.state_matrix.values, space.noise_vector.values
    rates = 2j * np.pi * frequencies[:, None, None]
    states = np.linalg.solve(rates * np.eye(2) - matrix, push[None, :, None])[..., 0]
    by_spring_and_dashpot = states @ matrix[1]
    relative = rates[:, 0, 0] * states[:, 1]
    intensity = float(space.noise_intensity)
    return {
        "absolute": intensity * np.abs(by_spring_and_dashpot) ** 2,
        "relative": intensity * np.abs(relative) ** 2,
    }


@cache
def moments_in_space() -> list[float]:
    """Spectral moments of SDLD101 up to the fourth, of frequencies in rad/s."""
    density = densities(FINE)["absolute"]
    return [2 * np.trapezoid(density * (2 * np.pi * FINE) ** k, FINE) for k in range(5)]


def of_accelerations() -> Iterator[Row]:
    """SDLD101."""
    case = "SDLD101 a"
    computed = densities(np.array(SHOWN))
    for kind, published in DENSITIES.items():
        for frequency, theirs, ours in zip(SHOWN, published, computed[kind], strict=True):
            cause = "not known" if frequency == BESIDE_THE_PEAK else "rounded"
            yield Row(case, f"{kind}, at {frequency:g} Hz", theirs, float(ours), cause)
    coarse = "their integration"
    order = moments_in_space()
    for k, (theirs, ours) in enumerate(zip(MOMENTS, order, strict=True)):
        yield Row(case, f"moment {k}", theirs, ours, coarse)
    zero_crossings = np.sqrt(order[2] / order[0]) / np.pi
    of_moments = [
        np.sqrt(order[0]),
        np.sqrt(order[4] / order[2]) / np.pi,
        zero_crossings,
        zero_crossings / 2,
        order[2] / np.sqrt(order[0] * order[4]),
    ]
    for (quantity, theirs), ours in zip(OF_MOMENTS.items(), of_moments, strict=True):
        yield Row(case, quantity, theirs, float(ours), coarse)


def of_manual() -> Iterator[Row]:
    """Of each variable of cases in the manual the number with the largest difference."""
    for name, (folder, variables, cause) in FROM_MANUAL.items():
        case = Case.named(folder)
        kept = kept_independent(case)
        program = kept["program"].split(",")[0]
        for variable in variables:
            numbers = manual_rows({variable: kept["answers"][variable]}, verified_answers(case))
            worst = max(numbers, key=lambda number: number.difference)
            yield Row(f"{program}: {name}", worst.what, worst.theirs, worst.ours, cause)


def moments() -> list[float]:
    """Spectral moments of SDLL104, of frequencies in rad/s, for S0 = 1 per Hz."""
    ground = sl.KanaiTajimi(0.2, 0.6, intensity=1 / (2 * np.pi))
    psd = 2 * np.pi * ground.psd(2 * np.pi * FREQUENCIES).values  # per Hz
    return [2 * np.trapezoid(psd * (2 * np.pi * FREQUENCIES) ** k, FREQUENCIES) for k in range(3)]


def peak_factor(share: float) -> float:
    """Level over standard deviation that this share of motions stays within, as by Vanmarcke."""
    m0, m1, m2 = moments()
    bandwidth = np.sqrt(1 - m1**2 / (m0 * m2))
    rate = np.array(m2 / m0)

    def within(level: float) -> float:
        unit = np.ones(1)
        to_both = 0.5 * bandwidth**1.2 * unit  # a clump has crossings to both sides
        _, first = hazards(level * unit, unit, 0 * unit, rate * unit, to_both)
        return float((1 - np.exp(-0.5 * level**2)) * np.exp(-2 * STRONG * first[0]))

    return scipy.optimize.brentq(lambda level: within(level) - share, 1.0, 6.0, xtol=1e-12)


@cache
def rows() -> list[Row]:
    """All numbers."""
    table = thrown()
    case = "SDND101 a"
    hit = table.isel(impact=0)
    force = table.contact_force.isel(contact=0)
    early = force.sel(time=slice(0, 0.1))
    later = force.sel(time=slice(0.1, None))
    impulse = float(early.integrate("time"))
    numbers = [
        Row(case, "largest force [N]", 9950.0, float(hit.largest_force), "rounded"),
        Row(case, "contact [s]", 0.03126, float(hit.impact_duration), "rounded"),
        Row(case, "impulse [N s]", 198.05, impulse, "not known"),
        Row(case, "first peak [s]", 0.01563, float(early.idxmax("time")), "rounded"),
        Row(case, "second peak [s]", 0.361, float(later.idxmax("time")), "rounded"),
    ]
    x = absolute(in_space())
    for time, published in zip(TIMES, IN_SPACE, strict=True):
        computed = 1e4 * float(x.sel(time=time, method="nearest"))
        cause = "their step of 0.25 ms"
        numbers.append(Row("SDND102 a", f"at {time:g} s [0.1 mm]", published, computed, cause))
    numbers += of_accelerations()
    closed = "their closed form"
    spread = float(np.sqrt(moments()[0]))
    numbers += [
        Row("SDLL104 a", "standard deviation", 5.5220842862, spread, "none"),
        Row("SDLL104 a", "median peak factor", 3.3761135643155, peak_factor(0.5), closed),
        Row("SDLL104 a", "95 % peak factor", 4.08151330093, peak_factor(0.95), closed),
    ]
    return [*numbers, *of_manual()]


def markdown() -> str:
    """The table."""
    lines = ["| case | quantity | published, or by the program | stochlin | difference | cause |"]
    lines += ["|---|---|---|---|---|---|"]
    for row in rows():
        off = f"{100 * row.off:.2g} %" if abs(row.off) > 1e-9 else "rounding"
        published, computed = (f"{number:.7g}" for number in (row.published, row.computed))
        lines.append(
            f"| {row.case} | {row.quantity} | {published} | {computed} | {off} | {row.cause} |"
        )
    return "\n".join(lines)


if __name__ == "__main__":
    sys.stdout.write(f"{markdown()}\n")
