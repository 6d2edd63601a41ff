"""Random parameters and independent building blocks that several test files share.

Nothing here uses a formula of the package: matrices are written from the equations of motion,
expectations are integrated numerically.
"""

import re
import shlex
from collections.abc import Callable, Collection, Iterable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.linalg
import xarray as xr
from click.testing import CliRunner
from scipy.integrate import quad, solve_ivp
from scipy.special import ndtr

import stochlin as sl
from stochlin.views.command import main

REACH = 12.0  # standard deviations: the Gaussian density beyond is below 1e-31

# The domain in which structures and grounds of practice lie, and the one beyond it.
PRACTICE = {
    "period": (0.15, 4.0),
    "damping": (0.01, 0.1),
    "hardening": (0.02, 0.6),
    "strength_ratio": (0.4, 3.0),
    "ground_period": (0.15, 4.0),
    "ground_damping": (0.03, 0.8),
}
BEYOND = {
    # Up to a hundred ground periods; at three hundred, on Clough-Penzien ground, rho keeps 8
    # digits.
    "period": (0.05, 10.0),
    "damping": (0.005, 0.2),
    "hardening": (0.001, 1.0),
    "strength_ratio": (0.05, 4.0),
    "ground_period": (1.0, 1.0),
    "ground_damping": (0.005, 0.9),
}

# Moments (sigma_v, sigma_z, correlation), and c_eq and k_eq of the bilinear law to ten digits.
KNOWN_COEFFICIENTS = [
    ((1, 0.5, 0.3), -0.9649205716, 0.1627194350),
    ((2, 1, 0), -0.8413447461, 0.3861294105),
    ((1.5, 2, -0.4), -0.8061917271, 0.1448614462),
    ((1, 1.2, 0.6), -0.6608020945, 0.2957894622),
    ((3, 0.7, 0.8), -0.8485191123, 1.4167065906),
]


def read_text(folder: Path, text: str) -> Any:
    """The case file of this text, in this folder."""
    path = folder / "case.toml"
    path.write_text(text, encoding="utf-8")
    return sl.read_case(path)


FIRM_SITE = """\
[site]
ground = "firm"
intensity = "0.01 m^2/s^3"
[motion]
duration = "12 s"
"""  # of a case file
SMALL_GAP = """\
[separation]
existing = "4 cm"
confidence = 0.9
[simulation]
paths = 128
[contact]
model = "kelvin"
stiffness = "1000 MN/m"
restitution = 0.65
"""

# Fewer simulated motions for commands that are run as printed and do not say how many.
FEW_MOTIONS = {"charts": {"paths": 32, "simulated_points": 3, "reduction_factors": "2,4"}}

SHORT_MOTION = {'"20 s"': '"6 s"', 'rise_end = "4 s"': 'rise_end = "1 s"', '"15 s"': '"4 s"'}


def example_case() -> str:
    """A case file with the choices of every table, those that are not taken as comments."""
    return (Path(__file__).parent / "example_case.toml").read_text(encoding="utf-8")


def example_of_short_motion() -> str:
    """The example of a case file, with motions that are simulated in a third of the time."""
    text = example_case()
    for long, short in SHORT_MOTION.items():
        assert text.count(long) == 1
        text = text.replace(long, short)
    return text


def with_slow(names: Iterable[Any], long: Collection[Any]) -> list[Any]:
    """Parameters of a test, of which ``make test`` leaves out the long ones."""
    every = list(names)
    gone = [name for name in long if name not in every]
    assert not gone, f"no parameters of the test any more: {gone}"
    return [pytest.param(name, marks=pytest.mark.slow) if name in long else name for name in every]


# Tables of buildings for case files; ``{n}`` is the number of the building.
BLOCK = """[building_{n}]
name = "Block {n}"
period = "{period} s"
storeys = {storeys}
storey_height = "{height} m"
floor_mass = "300 t"
damping = "5 %"
hardening = "5 %"
base_shear_coefficient = 0.15
"""
KIOSK = """[building_{n}]
name = "Kiosk"
period = "0.4 s"
damping = "5 %"
hardening = "5 %"
reduction_factor = 3
height = "4 m"
"""


def with_buildings(*buildings: str) -> str:
    """The example of a case file with these buildings in place of its own."""
    text = example_case()
    start, end = text.index("[building_1]"), text.index("[separation]")
    return text[:start] + "\n".join(buildings) + text[end:]


def recorded_example() -> str:
    """The example of a case file with the lines of its first record, ``taft.txt``, taken in."""
    text = example_case()
    block = re.match(r"(?:#   .*\n)+", text[text.index("#   [[site.records]]") :])[0]
    return text.replace(block, block.replace("#   ", ""))


def run_as_printed(line: str, page: Iterable[str]) -> None:
    """Run a command of a page in an empty folder, after those of its lines that write its files.

    Motions are few; before ``pound`` the pages say that the lines of ``record.at2`` have to be
    taken in.
    """
    *before, last = (
        each.partition(" > ") for each in (*filter(re.compile(" > ").search, page), line)
    )
    for command, _, target in before:
        Path(target).write_text(_output(command), encoding="utf-8")
    text = Path("case.toml").read_text(encoding="utf-8") + "[simulation]\npaths = 256\n"
    if "pound" in line and "--motions" not in line:
        assert text.count("#   ") == 2
        text = text.replace("#   ", "")
    Path("case.toml").write_text(text, encoding="utf-8")
    _output(last[0])


def _output(command: str) -> str:
    program, *arguments = shlex.split(command)
    assert program == "stochlin"
    result = CliRunner().invoke(main, arguments, default_map=FEW_MOTIONS)
    assert result.exit_code == 0, result.output
    return result.output


def axis(name: str, values: Any, chunk: int | None = None) -> xr.DataArray:
    """Values over a dimension of that name, also their labels; in chunks for dask, or whole."""
    array = xr.DataArray(values, dims=name, coords={name: values})
    return array if chunk is None else array.chunk(chunk)


def assert_near(values: Any, wanted: Any, share: float) -> None:
    """No difference is more than this share of the largest number."""
    largest = np.nanmax(np.abs(np.asarray(wanted)))
    np.testing.assert_allclose(values, wanted, rtol=0, atol=share * largest)


def check_labels(table: xr.Dataset) -> None:
    """Every variable has a name and a unit, or flags and their meanings; the table its source."""
    for name, variable in table.data_vars.items():
        assert variable.attrs["long_name"], name
        if "flag_meanings" in variable.attrs:
            flags = variable.attrs["flag_values"]
            assert len(variable.attrs["flag_meanings"].split()) == len(flags), name
            assert variable.dtype == flags.dtype == np.int8, name
        else:
            assert variable.attrs["units"] or variable.dtype.kind in "Ub", name
    assert {"title", "references", "stochlin_version", "history"} <= set(table.attrs)
    assert table.attrs["stochlin_version"] == sl.__version__


def log_uniform(
    rng: np.random.Generator, limits: tuple[float, float], size: int | None = None
) -> Any:
    """Numbers whose logarithm is uniform between the logarithms of the limits."""
    return np.exp(rng.uniform(*np.log(limits), size))


def draw_structure(
    rng: np.random.Generator, domain: dict[str, tuple[float, float]], size: int | None = None
) -> dict[str, Any]:
    """Arguments of a bilinear structure; ``reduction_factor`` is 3 sigma_el/uy."""
    values = {
        key: log_uniform(rng, domain[key], size) for key in ("period", "damping", "hardening")
    }
    return values | {"reduction_factor": 3 * log_uniform(rng, domain["strength_ratio"], size)}


def draw_ground(
    rng: np.random.Generator, domain: dict[str, tuple[float, float]], size: int | None = None
) -> dict[str, Any]:
    """Arguments of a Kanai-Tajimi ground."""
    return {key: log_uniform(rng, domain[f"ground_{key}"], size) for key in ("period", "damping")}


def covariances_in_time(space: xr.Dataset, envelope: Any, times: Any, ends: Sequence[float]) -> Any:
    """Of the states of `statespace` (times, n, n), by integrating ``P' = A P + P A' + Q``.

    The soil is stationary at the beginning; integration stops at the kinks of the envelope,
    ``ends``.
    """
    matrix, noise = space.state_matrix.values, space.noise_vector.values
    soil = np.array([str(name).startswith("x") for name in space.state.values])
    strength, n = float(space.noise_intensity), len(matrix)
    start, among = np.zeros_like(matrix), np.ix_(soil, soil)
    if soil.any():
        start[among] = scipy.linalg.solve_continuous_lyapunov(
            matrix[among], -strength * np.outer(noise[soil], noise[soil])
        )

    def rate(time: float, flat: Any) -> Any:
        now, push, m = matrix.copy(), noise.copy(), float(envelope.at(np.array(time)))
        now[np.ix_(~soil, soil)] *= m
        push[~soil] *= m
        flow = now @ flat.reshape(n, n)
        return (flow + flow.T + strength * np.outer(push, push)).ravel()

    rows, state, begin = [start.ravel()], start.ravel(), 0.0
    for end in ends:
        inside = times[(times > begin) & (times <= end)]
        piece = solve_ivp(
            rate, (begin, end), state, "DOP853", np.union1d(inside, end), rtol=1e-11, atol=1e-18
        )
        rows += list(piece.y[:, : inside.size].T)
        state, begin = piece.y[:, -1], end
    return np.array(rows).reshape(-1, n, n)


def augmented_system(
    structures: Sequence[Sequence[Any]], filters: Sequence[Any] = ()
) -> tuple[list[list[Any]], list[Any]]:
    """State matrix and noise vector of structures on one ground, in numbers of any type.

    A structure is ``(stiffness, damping)`` if elastic, with the states u, u', or ``(stiffness,
    damping, coupling, c, k)`` with the states u, u', z: ``u'' = -(stiffness - coupling) u - damping
    u'
    - coupling z + f``, ``z' = -c u' - k z``. The states of the ground come last. ``filters`` are
    circular frequencies and damping ratios: none for white noise, two for Kanai-Tajimi, four for
    Clough-Penzien.
    """
    sizes = [2 if len(structure) == 2 else 3 for structure in structures]
    ground, size = sum(sizes), sum(sizes) + len(filters)
    matrix: list[list[Any]] = [[0] * size for _ in range(size)]
    forcing: list[Any] = [0] * size
    noise: list[Any] = [0] * size
    for stage, (w, xi) in enumerate(zip(filters[::2], filters[1::2], strict=True)):
        x = ground + 2 * stage
        matrix[x][x + 1] = 1
        sign = 1 if stage == 0 else -1  # f = wg^2 xg + 2 xig wg xg', then xf'' = f - wf^2 xf - ...
        forcing[x], forcing[x + 1] = sign * w**2, sign * 2 * xi * w
        if stage == 0:
            matrix[x + 1][x], matrix[x + 1][x + 1], noise[x + 1] = -(w**2), -2 * xi * w, 1
        else:
            matrix[x + 1] = list(forcing)
    u = 0
    for structure, states in zip(structures, sizes, strict=True):
        stiffness, damping, coupling, *law = [*structure, 0] if states == 2 else structure
        matrix[u][u + 1] = 1
        matrix[u + 1] = list(forcing)
        noise[u + 1] = 0 if filters else 1
        matrix[u + 1][u], matrix[u + 1][u + 1] = -(stiffness - coupling), -damping
        if states == 3:
            matrix[u + 1][u + 2] = -coupling
            matrix[u + 2][u + 1], matrix[u + 2][u + 2] = -law[0], -law[1]
        u += states
    return matrix, noise


def lyapunov(system: tuple[list[list[Any]], list[Any]], intensity: float) -> Any:
    """Covariance of the states by scipy's general solver, under white noise of two-sided PSD S0."""
    matrix, noise = (np.array(part, dtype=float) for part in system)
    return scipy.linalg.solve_continuous_lyapunov(
        matrix, -2 * np.pi * intensity * np.outer(noise, noise)
    )


def slip_moments(
    share: Callable[[float], float],
    latent: Sequence[float],
    edges: Sequence[float] = (),
    seen: Callable[[float], float] = lambda z: z,
) -> tuple[float, float]:
    """``E[w v]`` and ``E[w seen(z)]`` of an odd slip rate ``w = v share(z)`` for ``v > 0``.

    ``(v, z)`` is Gaussian. The integral over ``v`` is a truncated moment, the one over ``z`` is
    left to QUADPACK, on pieces between the edges of the law.
    """
    sv, sz, r = latent
    q = np.sqrt(1 - r * r)

    def density(x: float) -> float:
        return float(np.exp(-0.5 * x * x) / np.sqrt(2 * np.pi))

    def first(t: float) -> float:  # E[x; x > 0 | t] for x = v/sv, t = z/sz
        return r * t * ndtr(r * t / q) + q * density(r * t / q)

    def second(t: float) -> float:  # E[x^2; x > 0 | t]
        return r * t * first(t) + q * q * ndtr(r * t / q)

    cuts = np.clip([edge / sz for edge in edges], -REACH, REACH)
    borders = np.unique([-REACH, -4.0, 0.0, 4.0, REACH, *cuts])

    def integral(function: Callable[[float], float]) -> float:
        accuracy = {"epsabs": 1e-15, "epsrel": 1e-11, "limit": 200}
        return sum(quad(function, a, b, **accuracy)[0] for a, b in pairwise(borders))

    by_v = integral(lambda t: density(t) * share(sz * t) * second(t))
    by_z = integral(lambda t: density(t) * share(sz * t) * seen(sz * t) * first(t))
    return 2 * sv * sv * by_v, 2 * sv * by_z


def regressed(slip: tuple[float, float], vv: float, zz: float, vz: float) -> Any:
    """Least-squares ``(1 + c_e, k_e)``: the slip rate on ``(v, z)`` with these second moments."""
    return np.linalg.solve([[vv, vz], [vz, zz]], slip)


def beyond_yield(z: float) -> float:
    """The bilinear law: for ``v > 0`` all of the velocity is slip where ``z > 1``."""
    return float(z > 1)
