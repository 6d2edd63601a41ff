"""Published numbers of other programs beside ours: ``python -m other_programs`` prints the table.

Numbers and inputs are those of the validation manual of code_aster, by its case numbers: SDND101,
SDND102 and SDLL104.
"""

import sys
from functools import cache
from typing import NamedTuple

import numpy as np
import scipy.optimize
import xarray as xr
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
# --- SDLL104 a: Kanai-Tajimi of 5 Hz and 0.6, S0 = 1 per Hz, two-sided, at 0, 1 .. 50 Hz, trapezium
FREQUENCIES = np.arange(51.0)  # [Hz]
STRONG = 10.0  # [s]


class Row(NamedTuple):
    """A published number beside ours."""

    case: str
    quantity: str
    published: float
    computed: float
    cause: str

    @property
    def off(self) -> float:
        """Relative difference of the computed number."""
        return self.computed / self.published - 1


@cache
def thrown() -> xr.Dataset:
    """SDND101."""
    free = sl.Bilinear(2 * np.pi * np.sqrt(MASS / SPRING), 1e-12, mass=MASS)
    still = motion(np.zeros(40_001), 1e-5)
    start = sl.Start(velocity=SPEED)
    return sl.pound([free, sl.Wall()], 0.0, sl.LinearSpring(STOP), still, start=start)


@cache
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
    closed = "their closed form"
    spread = float(np.sqrt(moments()[0]))
    numbers += [
        Row("SDLL104 a", "standard deviation", 5.5220842862, spread, "none"),
        Row("SDLL104 a", "median peak factor", 3.3761135643155, peak_factor(0.5), closed),
        Row("SDLL104 a", "95 % peak factor", 4.08151330093, peak_factor(0.95), closed),
    ]
    return numbers


def markdown() -> str:
    """The table."""
    lines = ["| case | quantity | published | stochlin | difference | cause |"]
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
