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
ROOF = 4 / 3  # participation of the roof, 3 n/(2 n + 1), and its effective mass over all, below
STIFFNESS = (10 / 12) * 4.8e5 * (2 * np.pi / 0.8) ** 2 / ROOF  # of the base shear over the roof
U = np.array([0.0, 0.02, 0.04, 0.08, 0.16])
CURVE = STIFFNESS * np.array([0.0, 0.02, 0.034, 0.042, 0.046])

OSCILLATOR = """[building_1]
period = "0.8 s"
damping = "5 %"
pushover = "push.csv"
participation = 1.3333333333333333

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
    """The oscillator is the first mode of the building with storeys, as both have the same mode."""
    line = 'hardening = "3 %"\n'
    ideal = sl.bilinear_of(sl.read_pushover(push), hardening=0.03)
    wanted = ELASTIC.with_pushover(ideal)
    chosen = (text.replace("damping", f"{line}damping", 1) for text in (OSCILLATOR, STOREYS, SINGLY))
    oscillator, *others = chosen
    for storeys in others:
        case = read(tmp_path, oscillator, storeys)
        assert case.buildings[0].strength == case.buildings[1].strength == "pushover"
        assert {*case.files} == {tmp_path / "case.toml", push}
        same(case.buildings[1].structure, wanted)
        first, mode = case.buildings[0].structure.arrays(), wanted.oscillator().arrays()
        for name in ("period", "hardening", "yield_displacement"):
            assert float(first[name]) == pytest.approx(float(mode[name]), rel=1e-6)


def test_hardening_is_that_of_the_curve_unless_it_is_given(push: Path, tmp_path: Path) -> None:
    ideal = sl.bilinear_of(sl.read_pushover(push))
    case = read(tmp_path, OSCILLATOR, STOREYS)
    for building in case.buildings:
        assert building.structure.hardening == pytest.approx(float(ideal.hardening), rel=1e-12)


def test_uncertain_parameters_keep_the_curve(tmp_path: Path) -> None:
    """A sample with another period of an oscillator has its strength; storeys that of the curve."""
    case = read(
        tmp_path,
        OSCILLATOR.replace("0.8 s", "0.8 s +- 10 %"),
        STOREYS.replace("0.8 s", "0.8 s +- 20 %"),
    )
    certain = read(tmp_path, OSCILLATOR, STOREYS)
    first, second = (building.sampled for building in case.buildings)
    assert first is not None
    assert second is not None
    longer = first.at({"period": 1.2})
    assert longer.period == pytest.approx(1.2 * certain.buildings[0].structure.period)
    assert longer.yield_displacement == certain.buildings[0].structure.yield_displacement
    same(second.at({"period": 1.4}), certain.buildings[1].structure)
