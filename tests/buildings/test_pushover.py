"""Pushover curves: read from files, idealized against hand solutions, taken over by buildings."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

import stochlin as sl
from stochlin.messages import DoubtfulInput

pytestmark = pytest.mark.invariant

NAME = "displacement"


def curve(displacement: Any, force: Any, units: tuple[str, str] = ("m", "N")) -> xr.DataArray:
    along = xr.DataArray(np.asarray(displacement, float), dims=NAME, attrs={"units": units[0]})
    force = np.asarray(force, float)
    return xr.DataArray(force, dims=NAME, coords={NAME: along}, attrs={"units": units[1]})


def numbers(ideal: xr.Dataset) -> list[float]:
    names = ("yield_force", "yield_displacement", "hardening")
    return [float(ideal[name]) for name in names]


# --- Idealizations
# ------------------------------------------------------------------------------------

TRILINEAR = curve([0, 1, 3, 6], [0, 100, 140, 150])
SOFT = curve([0, 1, 4, 10], [0, 60, 150, 180])  # 0.6 of its yield force is on its second line


@pytest.mark.parametrize(
    ("pushed", "force", "displacement", "slope"),
    [
        # 6 V + 150 (6 - V/100) = 2 * 725; the first line is that of the curve.
        (TRILINEAR, 1100 / 9, 11 / 9, (150 - 1100 / 9) / (6 - 11 / 9)),
        # u(0.6 V) = 0.02 V - 1, so that uy = V/30 - 5/3, and 10 V + 180 (10 - uy) = 2 * 1335.
        (SOFT, 142.5, 142.5 / 30 - 5 / 3, 37.5 / (10 - 142.5 / 30 + 5 / 3)),
    ],
)
def test_asce_41_by_hand(
    pushed: xr.DataArray, force: float, displacement: float, slope: float
) -> None:
    ideal = sl.bilinear_of(pushed)
    wanted = [force, displacement, slope / (force / displacement)]
    np.testing.assert_allclose(numbers(ideal), wanted, rtol=1e-8)
    assert ideal.effective_stiffness == pytest.approx(force / displacement, rel=1e-8)
    assert ideal.initial_stiffness == float(pushed[1] / pushed[NAME][1])
    np.testing.assert_allclose(ideal.idealized_displacement[1:], [displacement, pushed[NAME][-1]])


@pytest.mark.filterwarnings("ignore:.*does the curve end before")
@given(
    st.lists(st.floats(0.05, 0.9), min_size=2, max_size=6), st.floats(1e-4, 1e3), st.floats(1, 1e9)
)
def test_of_a_curve_that_flattens_all_conditions_hold(
    shares: list[float], width: float, stiffness: float
) -> None:
    """Each line has a share of the slope of the one before it; units do not matter."""
    slopes = stiffness * np.cumprod([1.0, *shares])
    u = width * np.arange(slopes.size + 1)
    v = np.append(0.0, np.cumsum(slopes * width))
    ideal = sl.bilinear_of(curve(u, v), hardening=0.1)
    corners = ideal.idealized_displacement.values, ideal.idealized_base_shear.values
    assert np.trapezoid(corners[1], corners[0]) == pytest.approx(np.trapezoid(v, u), rel=1e-6)
    force, displacement = float(ideal.yield_force), float(ideal.yield_displacement)
    assert np.interp(0.6 * displacement, u, v) == pytest.approx(0.6 * force, rel=1e-6)
    assert 0 < force < v[-1]
    assert corners[1][-1] == v[-1]


def test_a_flat_end_has_the_least_hardening() -> None:
    """Two lines with 1 and 0.001 of the stiffness are their own idealization."""
    flat = curve([0, 1, 2, 3, 6], [0, 100, 100.1, 100.2, 100.5])
    with pytest.warns(DoubtfulInput, match=r"hardening ratio is 0\.001; 0\.01 is taken"):
        ideal = sl.bilinear_of(flat)
    np.testing.assert_allclose(numbers(ideal), [100, 1, 0.01], rtol=1e-6)


def test_what_comes_after_the_peak_or_the_target_does_not_count() -> None:
    softening = curve([0, 1, 3, 6, 8, 9], [0, 100, 140, 150, 120, 60])
    for target in (None, 7.0):
        ideal = sl.bilinear_of(softening, target_displacement=target)
        assert numbers(ideal) == numbers(sl.bilinear_of(TRILINEAR))
    cut = sl.bilinear_of(softening, target_displacement=4.5)
    np.testing.assert_allclose(
        numbers(cut), numbers(sl.bilinear_of(curve([0, 1, 3, 4.5], [0, 100, 140, 145])))
    )


NO_CURVES: dict[str, Any] = {
    "has 3 points; allowed: 4 or more": curve([0, 1, 2], [0, 1, 1.2]),
    r"point 3: the displacement goes from 1 to 0\.9 m; allowed: increasing displacements": curve(
        [0, 1, 0.9, 2], [0, 1, 1.2, 1.3]
    ),
    "point 3: the base shear falls from the start, from 3 to 2 N": curve(
        [0, 1, 2, 3], [0, 3, 2, 1]
    ),
    r"point 1: the curve begins at 0\.1 m and 0 N; allowed: 0": curve(
        [0.1, 1, 2, 3], [0, 2, 3, 3.3]
    ),
    "point 2: the base shear is -1 N": curve([0, 1, 2, 3], [0, -1, 2, 3]),
    "does not bend up to 3 m, so that it has no yield point": curve([0, 1, 2, 3], [0, 1, 2, 3]),
    r"no two lines have its area and cross it at 0\.6": curve(
        [0, 1, 1.01, 2, 3, 4], [0, 60, 98, 99, 99.5, 100]
    ),
    "has float64 values in 'mm'; allowed: finite numbers with the attribute units = 'm'": curve(
        [0, 1, 2, 3], [0, 2, 3, 3.3], ("mm", "kN")
    ),
    r"pushover = \[0, 1, 2\]; allowed: what read_pushover returns": [0, 1, 2],
}
NO_ARGUMENTS: dict[str, dict[str, Any]] = {
    "target_displacement = 7 m is beyond the curve": {"target_displacement": 7.0},
}


@pytest.mark.parametrize("message", [*NO_CURVES, *NO_ARGUMENTS])
def test_what_is_no_curve_or_argument_is_refused(message: str) -> None:
    with pytest.raises((ValueError, TypeError), match=message):
        sl.bilinear_of(NO_CURVES.get(message, TRILINEAR), **NO_ARGUMENTS.get(message, {}))


# --- Files
# --------------------------------------------------------------------------------------------

PUSH = "roof [mm],shear [kN]\n0,0\n10,500\n30,700\n60,750\n"
FILES: dict[str, str | tuple[str, dict[str, Any]]] = {
    "units in titles": "Roof displacement [mm],Base shear (kN)\n0,0\n10,500\n30,700\n60,750\n",
    "line of units": "TABLE:  Base Shear vs Monitored Displacement\n"
    "Step,Monitored Displ,Base Force,A-B,B-C\n,mm,kN,,\n"
    "0,0,0,12,0\n1,10,500,12,0\n2,30,700,10,2\n3,60,750,8,4\n",
    "decimal commas": "Displ [cm];Shear [MN]\n0;0\n1;0,5\n3;0,7\n6;0,75\n",
    "spaces, reactions": (
        "# roof, base\n0.0 0.0\n0.01 -500.\n0.03 -700.\n0.06 -7.5e2\n",
        {"length_units": "m", "force_units": "kN", "displacement_column": 1, "force_column": 2},
    ),
    "without its origin, pushed to the left, titles in a comment": (
        "# shear [kN],roof [mm]\n500,-10\n700,-30\n750,-60\n"
    ),
    "signs in titles": (
        "No. #,roof (1 % of h) [mm],shear [kN]\n1,0,0\n2,10,500\n3,30,700\n4,60,750\n"
    ),
    "hinges fail at one displacement": f"{PUSH}60,400\n70,300\n",
    "the roof comes back after the peak": f"{PUSH}58.5,400\n70,-10\n",
    "a step is repeated": PUSH.replace("30,700\n", "30,700\n30,700\n"),
    "off zero by the permanent loads": PUSH.replace("0,0\n", "-.005,0.4\n", 1),
}


@pytest.mark.parametrize("case", FILES)
def test_a_curve_is_read_in_si(case: str, tmp_path: Path) -> None:
    text, options = row if isinstance(row := FILES[case], tuple) else (row, {})
    path = tmp_path / "push.csv"
    path.write_text(text, encoding="utf-8")
    read = sl.read_pushover(path, **options)
    np.testing.assert_allclose(read[NAME], [0, 0.01, 0.03, 0.06], rtol=1e-7)
    np.testing.assert_allclose(read, [0, 5e5, 7e5, 7.5e5], rtol=1e-7)
    assert (read.attrs["units"], read[NAME].attrs["units"]) == ("N", "m")
    assert (read.name, read.attrs["source"]) == ("base_shear", "push.csv")
    sl.bilinear_of(read)


HEAD = "roof [mm],shear [kN]\n"
UNREADABLE: dict[str, str | tuple[str, dict[str, Any]]] = {
    r"does not say the unit of the force; give force_units=": (
        "roof [mm],shear\n0,0\n1,2\n2,3\n3,3.1\n"
    ),
    r"length_units = 'cm' contradicts push\.csv, line 1, column 1, which states 'mm'": (
        f"{HEAD}0,0\n1,2\n2,3\n3,3.1\n",
        {"length_units": "cm"},
    ),
    (
        r"push\.csv, line 1: .*, 2 'shear x': a force, 3 'shear y': a force; "
        r"give force_column= .* from 1"
    ): (
        "roof,shear x,shear y\n0,0,0\n1,2,2\n2,3,3\n3,4,4\n",
        {"length_units": "m", "force_units": "N"},
    ),
    "1 'roof shear', 2 'x'; give displacement_column= .* and force_column=": (
        "roof shear,x\n0,0\n1,2\n"
    ),
    r"push\.csv, line 4, column 2: 'collapse' is not a force": f"{HEAD}0,0\n1,2\n2,collapse\n3,3\n",
    "line 5, column 1: a second load case": (
        f"Case,{HEAD}X,0,0\nX,10,500\nX,30,700\nY,0,0\nY,9,10\n"
    ),
    r"line 6: a second push begins; allowed: one": f"{PUSH}0,0\n10,400\n",
    r"line 3, column 1: '1,2' is not a displacement": f'{HEAD}0,0\n"1,2\n2,3\n',
    "lines, one with 3001 columns; allowed: less": f"{HEAD}{3000 * ','}5\n" + 3000 * "1,2\n",
}


@pytest.mark.parametrize("message", UNREADABLE)
def test_what_is_wrong_with_a_file_is_said(message: str, tmp_path: Path) -> None:
    text, options = row if isinstance(row := UNREADABLE[message], tuple) else (row, {})
    path = tmp_path / "push.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises((ValueError, TypeError), match=message):
        sl.read_pushover(path, **options)


@pytest.mark.parametrize(
    "titles", ["storey drift,base shear", "roof,Story Shear", "roof,storey_force"]
)
def test_what_is_of_a_storey_is_not_taken_by_itself(titles: str, tmp_path: Path) -> None:
    path = tmp_path / "push.csv"
    first, second = titles.split(",")
    rows = "\n0,0\n20,900\n50,1300\n120,1500\n"
    path.write_text(f"{first} [mm],{second} [kN]{rows}", encoding="utf-8")
    with pytest.raises(ValueError, match=r"give (displacement|force)_column="):
        sl.read_pushover(path)
    assert float(sl.read_pushover(path, displacement_column=1, force_column=2).max()) == 1.5e6


# --- Buildings
# ----------------------------------------------------------------------------------------

MASSES, STIFFNESSES = np.array([3e5, 2.5e5, 2.5e5, 1.5e5]), np.array([4e8, 3e8, 3e8, 2e8])
CHAIN = sl.ShearBuilding(MASSES, STIFFNESSES, [4.0, 3.2, 3.2, 3.2], 0.05)


def first_mode() -> tuple[np.ndarray, float]:
    """Shape with 1 at the roof and circular frequency, by numpy."""
    drifts = np.eye(4) - np.eye(4, k=-1)
    matrix = drifts.T @ np.diag(STIFFNESSES) @ drifts
    root = np.sqrt(MASSES)
    squares, vectors = np.linalg.eigh(matrix / np.outer(root, root))
    shape = vectors[:, 0] / root
    return shape / shape[-1], float(np.sqrt(squares[0]))


SHAPE, OMEGA = first_mode()
OF_ROOF = OMEGA**2 * float(MASSES @ SHAPE)  # base shear over the displacement of the roof


def pushed_to(building: sl.ShearBuilding, base_shear: float) -> float:
    """Displacement of the roof under forces of the first mode, storey by storey from its law."""
    shears = base_shear * (MASSES * SHAPE)[::-1].cumsum()[::-1] / (MASSES @ SHAPE)
    values = {name: array.to_numpy() for name, array in building.arrays().items()}
    k, strength, hardening = values["stiffnesses"], values["yield_drifts"], values["hardening"]
    beyond = np.maximum(shears - k * strength, 0.0)
    return float((np.minimum(shears, k * strength) / k + beyond / (hardening * k)).sum())


@pytest.mark.parametrize("softer", [1.0, 0.8])
def test_a_chain_is_pushed_along_the_idealized_curve(softer: float) -> None:
    """Its own stiffness times a factor, yield at 3 cm and hardening of 0.08."""
    stiffness = softer * OF_ROOF
    u = np.array([0, 0.03, 0.06, 0.12])
    forces = stiffness * np.array([0, 0.03, 0.03 * 1.08, 0.03 * 1.24])
    ideal = sl.bilinear_of(curve(u, forces))
    np.testing.assert_allclose(numbers(ideal), [forces[1], 0.03, 0.08], rtol=1e-7)
    if softer == 1:
        building = CHAIN.with_pushover(ideal)
    else:
        with pytest.warns(DoubtfulInput, match="begins with the stiffness of a period of"):
            building = CHAIN.with_pushover(ideal)
    np.testing.assert_allclose(building.arrays()["stiffnesses"], softer * STIFFNESSES, rtol=1e-7)
    roof = [pushed_to(building, force) for force in forces]
    np.testing.assert_allclose(roof, u, rtol=1e-6, atol=1e-12)
    first = building.oscillator()
    moves = building.first_mode_moves()[-1]
    assert first.yield_displacement == pytest.approx(0.03 / float(moves), rel=1e-7)


def test_the_oscillator_of_the_first_mode_has_force_and_displacement_of_the_curve() -> None:
    """Chopra and Goel: ``F/L = V/(G L)`` and ``D = u/(G s)``, with a curve that cracks early."""
    u = np.array([0, 0.01, 0.04, 0.1])
    forces = OF_ROOF * np.array([0, 0.01, 0.024, 0.03])
    ideal = sl.bilinear_of(curve(u, forces))
    force, displacement, hardening = numbers(ideal)
    factor = MASSES @ SHAPE / (MASSES @ SHAPE**2)
    modal_mass = (MASSES @ SHAPE) ** 2 / (MASSES @ SHAPE**2)
    with pytest.warns(DoubtfulInput, match="of the mass"):
        modes = sl.ModalBuilding([2 * np.pi / OMEGA], -3 * SHAPE[None], MASSES, [3.2] * 4, 0.04)
    with pytest.warns(DoubtfulInput, match="of the mass"):
        yielding = modes.with_pushover(ideal)
    for building in (yielding, CHAIN.with_pushover(ideal)):
        first = building.oscillator()
        strength = (2 * np.pi / first.period) ** 2 * first.yield_displacement
        assert strength == pytest.approx(force / modal_mass, rel=1e-9)
        assert first.yield_displacement == pytest.approx(displacement / factor, rel=1e-9)
        assert first.hardening == pytest.approx(hardening, rel=1e-12)
        assert first.period > 1.1 * 2 * np.pi / OMEGA


def test_higher_modes_keep_their_strength() -> None:
    ideal = sl.bilinear_of(
        curve([0, 0.03, 0.06, 0.12], OF_ROOF * np.array([0, 0.03, 0.032, 0.036]))
    )
    drifts = np.eye(4) - np.eye(4, k=-1)
    root = np.sqrt(MASSES)
    matrix = drifts.T @ np.diag(STIFFNESSES) @ drifts / np.outer(root, root)
    squares, vectors = np.linalg.eigh(matrix)
    periods, shapes = 2 * np.pi / np.sqrt(squares), (vectors / root[:, None]).T
    modes = sl.ModalBuilding(
        periods, shapes, MASSES, [3.2] * 4, 0.05, hardening=0.2, yield_displacements=[0.05, 0.004]
    )
    values = modes.with_pushover(ideal).arrays()
    factor = MASSES @ SHAPE / (MASSES @ SHAPE**2)
    np.testing.assert_allclose(values["yield_displacements"], [0.03 / factor, 0.004], rtol=1e-7)
    np.testing.assert_allclose(values["hardening"], [float(ideal.hardening), 0.2])
    np.testing.assert_allclose(values["periods"], periods, rtol=1e-7)
    elastic = sl.ModalBuilding(periods, shapes, MASSES, [3.2] * 4, 0.05).with_pushover(ideal)
    assert elastic.arrays()["yield_displacements"].size == 1


def test_what_does_not_fit_a_building_is_said() -> None:
    ideal = sl.bilinear_of(
        curve([0, 0.03, 0.06, 0.12], OF_ROOF * np.array([0, 0.03, 0.032, 0.036]))
    )
    with pytest.warns(DoubtfulInput, match="are units, masses and"):
        CHAIN.with_pushover(ideal.assign(initial_stiffness=ideal.initial_stiffness * 1e3))
    with pytest.raises(
        ValueError, match="idealized has hardening = nan; allowed: the result of bilin"
    ):
        CHAIN.with_pushover({"yield_force": 1e6, "yield_displacement": 0.02})
    with pytest.raises(TypeError, match=r"idealized = 0\.02; allowed: the result of bilinear_of"):
        CHAIN.with_pushover(0.02)  # type: ignore[arg-type]
    values = CHAIN.arrays()
    heavy = sl.ShearBuilding(MASSES, STIFFNESSES, values["heights"], 0.05, p_delta=True)
    with pytest.raises(ValueError, match="p_delta = True; allowed: False with a pushover curve"):
        heavy.with_pushover(ideal)
    given_: dict[str, Any] = {"participation": [0.4, 1.2], "modal_masses": [1e5, 2.9e5]}
    turning = sl.ModalBuilding(
        [0.5, 0.4], [[0.5, 1], [0.4, 1]], [2e5] * 2, [3.0] * 2, 0.05, **given_
    )
    with (
        pytest.warns(DoubtfulInput, match="are units"),
        pytest.raises(ValueError, match="mode 2 has more effective mass than mode 1"),
    ):
        turning.with_pushover(ideal)
