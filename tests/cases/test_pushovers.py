"""Pushover curves in case files: buildings are those of Python, and what does not fit is said."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cases
import numpy as np
import pytest

import stochlin as sl
from stochlin.applications.cases.reading.case import Case

pytestmark = pytest.mark.invariant

# Of a building of 480 t in four equal storeys, whose first mode is straight and has 0.8 s.
REGULAR: dict[str, Any] = {"period": 0.8, "storeys": 4, "storey_height": 3.0, "mass": 1.2e5}
ELASTIC = sl.ShearBuilding.regular(**REGULAR, damping=0.05)
ROOF = 4 / 3  # participation of the roof, 3 n/(2 n + 1); its effective mass over all is 10/12
STIFFNESS = (10 / 12) * 4.8e5 * (2 * np.pi / 0.8) ** 2 / ROOF  # of the base shear over the roof
U = np.array([0.0, 0.02, 0.04, 0.08, 0.16])
CURVE = STIFFNESS * np.array([0.0, 0.02, 0.034, 0.042, 0.046])

FIRST = """[building_1]
period = "0.5 s"
damping = "5 %"
elastic = true

"""
STOREYS = """[building_2]
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


@pytest.fixture(autouse=True)
def push(tmp_path: Path) -> Path:
    """The curve beside the case file."""
    path = tmp_path / "push.csv"
    lines = [f"{100 * u!r},{v / 1e3!r}" for u, v in zip(U.tolist(), CURVE.tolist(), strict=True)]
    path.write_text("\n".join(["roof [cm],shear [kN]", *lines]), encoding="utf-8")
    return path


def read(folder: Path, *buildings: str) -> Case:
    text = cases.with_buildings(*buildings).replace("align = true", "align = false")
    (folder / "case.toml").write_text(text, encoding="utf-8")
    return sl.read_case(folder / "case.toml")


def same(one: Any, other: Any) -> None:
    assert one.describe() == other.describe()
    for name, array in one.arrays().items():
        np.testing.assert_allclose(array, other.arrays()[name], rtol=1e-12)


def test_buildings_are_those_of_python(push: Path, tmp_path: Path) -> None:
    ideal = sl.bilinear_of(sl.read_pushover(push), hardening=0.03)
    for text in (STOREYS, SINGLY):
        case = read(tmp_path, FIRST, text.replace("damping", 'hardening = "3 %"\ndamping', 1))
        assert case.buildings[1].strength == "pushover"
        assert {*case.files} == {tmp_path / "case.toml", push}
        same(case.buildings[1].structure, ELASTIC.with_pushover(ideal))


def test_uncertain_parameters_keep_the_curve(tmp_path: Path) -> None:
    (_, uncertain) = read(tmp_path, FIRST, STOREYS.replace("0.8 s", "0.8 s +- 20 %")).buildings
    (_, certain) = read(tmp_path, FIRST, STOREYS).buildings
    same(uncertain.sampled.at({"period": 1.4}), certain.structure)
