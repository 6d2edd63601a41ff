"""Buildings of a case file by storeys: none is taken for an oscillator; what is wrong is said."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import cases
import numpy as np
import pytest

import stochlin as sl
from stochlin.applications.cases.reading.case import Case
from stochlin.applications.cases.rows import of_codes
from stochlin.messages import DoubtfulInput

pytestmark = pytest.mark.invariant

REGULAR = """[building_1]
period = "0.8 s"
storeys = 4
storey_height = "3 m"
floor_mass = "400 t"
damping = "5 %"
hardening = "5 %"
base_shear_coefficient = "15 %"

"""
SINGLE = """[building_2]
masses = ["300 t", "250 t"]
stiffnesses = ["500 MN/m", "4e5 kN/m"]
heights = ["4 m", "300 cm"]
damping = "5 %"
hardening = 0.1
yield_drifts = ["1 cm", "8 mm"]

"""
BOTH = {"period": 0.8, "storeys": 4, "mass": 4e5, "damping": 0.05, "hardening": 0.05}
KNOWN = BOTH | {"storey_height": 3.0, "base_shear_coefficient": 0.15}


def read(folder: Path, *buildings: str, align: str = "false", gaps: str = '"5 cm"') -> Case:
    text = cases.with_buildings(*buildings).replace("align = true", f"align = {align}")
    text = text.replace('existing = "5 cm"', f"existing = {gaps}")
    return cases.read_text(folder, text)


def same(one: sl.ShearBuilding, other: sl.ShearBuilding, rtol: float = 0.0) -> None:
    assert one.describe() == other.describe()
    for name, array in one.arrays().items():
        np.testing.assert_allclose(array, other.arrays()[name], rtol=rtol)


def test_a_regular_building_is_that_of_python(tmp_path: Path) -> None:
    case = read(tmp_path, REGULAR, SINGLE)
    same(case.buildings[0].structure, sl.ShearBuilding.regular(**KNOWN))
    elastic = REGULAR.replace('base_shear_coefficient = "15 %"', "elastic = true")
    bare = {name: value for name, value in BOTH.items() if name != "hardening"}
    expected = sl.ShearBuilding.regular(**bare, storey_height=3.0)
    same(read(tmp_path, elastic, SINGLE).buildings[0].structure, expected)
    heights = 'heights = ["4 m", "3 m", "3 m", "3 m"]'
    listed = REGULAR.replace('storey_height = "3 m"', heights)
    expected = sl.ShearBuilding.regular(**KNOWN | {"storey_height": [4, 3, 3, 3]})
    for text in (listed, listed.replace("storeys = 4\n", "")):
        same(read(tmp_path, text, SINGLE).buildings[0].structure, expected)


def test_laws_dampers_and_the_weight_are_read_by_storey(tmp_path: Path) -> None:
    lines = 'law = "bouc_wen"\nbeta = "60 %"\nexponent = 2\ngamma = 0.3\n'
    lines += 'dampers = ["2 MN s/m", "0 N s/m"]\np_delta = true\nstoreys = 2\n'
    lines += "damping_modes = [2, 1]\n"
    found = (
        read(tmp_path, REGULAR, SINGLE.replace("damping", f"{lines}damping", 1))
        .buildings[1]
        .structure
    )
    expected = sl.ShearBuilding(
        [3e5, 2.5e5],
        [5e8, 4e8],
        [4.0, 3.0],
        0.05,
        0.1,
        [0.01, 0.008],
        dampers=[2e6, 0.0],
        law="bouc_wen",
        law_parameters={"beta": 0.6, "gamma": 0.3, "exponent": 2.0},
        p_delta=True,
        damping_modes=(2, 1),
    )
    same(found, expected)


def of_levels(number: int, heights: Sequence[float]) -> str:
    each = [f'"{h} m"' for h in heights]
    kept = {"masses": ['"300 t"'] * len(each), "stiffnesses": ['"500 MN/m"'] * len(each)}
    lines = "".join(f"{key} = [{', '.join(values)}]\n" for key, values in kept.items())
    lines += f'heights = [{", ".join(each)}]\ndamping = "5 %"\nelastic = true\n\n'
    return f"[building_{number}]\n{lines}"


def test_slabs_on_columns_are_found_from_the_ground_up(tmp_path: Path) -> None:
    case = read(tmp_path, of_levels(1, [4, 3, 3]), of_levels(2, [3, 3]))
    assert [each[:2] for each in case.slabs] == [(1, 3.0), (2, 4.0), (1, 6.0)]
    assert "floor 1 of Building 1, at 4 m, meets the columns in storey 2 of " in case.slabs[1].words
    three = of_levels(1, [4, 3]), of_levels(2, [4.04, 3]), of_levels(3, [4, 4])
    row = read(tmp_path, *three, gaps='["5 cm", "5 cm"]')
    assert [slab.column_of for slab in row.slabs] == [3]


def test_floors_that_are_said_to_align_and_do_not(tmp_path: Path) -> None:
    said = (
        r"case.toml, line \d+: separation.floors_align = True is not so: "
        r"floor 1 of Building 2, at 3 m, "
        "meets the columns in storey 1 of Building 1; codes are asked as if it were false"
    )
    with pytest.warns(DoubtfulInput, match=said):
        case = read(tmp_path, of_levels(1, [4, 3]), of_levels(2, [3, 3]), align="true")
    assert not of_codes(case)["floors_align"]


# --- Pushover curves ---

# Of a building of 480 t in four equal storeys, whose first mode is straight and has 0.8 s.
OF_CURVE: dict[str, Any] = {"period": 0.8, "storeys": 4, "storey_height": 3.0, "mass": 1.2e5}
ELASTIC = sl.ShearBuilding.regular(**OF_CURVE, damping=0.05)
ROOF = 4 / 3  # participation of the roof, 3 n/(2 n + 1); its effective mass over all is 10/12
STIFFNESS = (10 / 12) * 4.8e5 * (2 * np.pi / 0.8) ** 2 / ROOF  # of the base shear over the roof
U = np.array([0.0, 0.02, 0.04, 0.08, 0.16])
CURVE = STIFFNESS * np.array([0.0, 0.02, 0.034, 0.042, 0.046])

FIRST = """[building_1]
period = "0.5 s"
damping = "5 %"
elastic = true

"""
BY_CURVE = """[building_2]
period = "0.8 s"
storeys = 4
storey_height = "3 m"
floor_mass = "120 t"
damping = "5 %"
pushover = "push.csv"

"""
MASSES, STIFFNESSES = (
    str([f"{value!r} {unit}" for value in ELASTIC.arrays()[key].values.tolist()])
    for key, unit in (("masses", "kg"), ("stiffnesses", "N/m"))
)
SINGLY = f"""[building_2]
masses = {MASSES}
stiffnesses = {STIFFNESSES}
storey_height = "3 m"
damping = "5 %"
pushover = "push.csv"

"""


@pytest.fixture
def push(tmp_path: Path) -> Path:
    """The curve beside the case file."""
    path = tmp_path / "push.csv"
    lines = [f"{100 * u!r},{v / 1e3!r}" for u, v in zip(U.tolist(), CURVE.tolist(), strict=True)]
    path.write_text("\n".join(["roof [cm],shear [kN]", *lines]), encoding="utf-8")
    return path


def test_buildings_with_a_curve_are_those_of_python(push: Path, tmp_path: Path) -> None:
    ideal = sl.bilinear_of(sl.read_pushover(push), hardening=0.03)
    for text in (BY_CURVE, SINGLY):
        case = read(tmp_path, FIRST, text.replace("damping", 'hardening = "3 %"\ndamping', 1))
        assert case.buildings[1].strength == "pushover"
        assert {*case.files} == {tmp_path / "case.toml", push}
        same(case.buildings[1].structure, ELASTIC.with_pushover(ideal), 1e-12)
    push.write_text("\n".join(push.read_text().splitlines()[1:]), encoding="utf-8")
    untitled = 'pushover = "push.csv"\npushover_units = ["cm", "kN"]\npushover_columns = [1, 2]\n'
    case = read(
        tmp_path, FIRST, BY_CURVE.replace('pushover = "push.csv"', f'hardening = "3 %"\n{untitled}')
    )
    same(case.buildings[1].structure, ELASTIC.with_pushover(ideal), 1e-12)


def test_uncertain_parameters_keep_the_curve(push: Path, tmp_path: Path) -> None:
    (_, uncertain) = read(tmp_path, FIRST, BY_CURVE.replace("0.8 s", "0.8 s +- 20 %")).buildings
    (_, certain) = read(tmp_path, FIRST, BY_CURVE).buildings
    same(uncertain.sampled.at({"period": 1.4}), certain.structure, 1e-12)
