"""Buildings by their modes in case files, against the same buildings storey by storey."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from cases import FIRM_SITE, SMALL_GAP, read_text, with_slow

import stochlin as sl
from stochlin.applications.cases.pounding import pound_case
from stochlin.applications.cases.reading.case import Case
from stochlin.applications.cases.separation import answer_case
from stochlin.views.separation.words import details

MASSES, HEIGHTS, STIFFNESSES = [3e5, 2.5e5, 2e5], [4.0, 3.0, 3.5], [2e8, 1.8e8, 1.2e8]
STOREYS = f"""
[building_1]
masses = {[f"{mass} kg" for mass in MASSES]}
stiffnesses = {[f"{stiffness} N/m" for stiffness in STIFFNESSES]}
heights = {[f"{height} m" for height in HEIGHTS]}
damping = 0.05
elastic = true
"""
NEIGHBOUR = """
[building_2]
name = "Shop"
period = "0.4 s"
damping = 0.05
hardening = 0.1
yield_displacement = "1 cm"
mass = "900 t"
"""
OF_FILE = """
[building_1]
name = "Tower"
modes = "tower.csv"
damping = 0.05
elastic = true
"""
YIELDING = OF_FILE.replace("elastic = true", 'hardening = 0.05\nyield_displacements = "2 cm"')


def eigen() -> tuple[np.ndarray, np.ndarray]:
    """Periods and shapes (modes, floors) of the storeys, by numpy alone."""
    k = np.append(STIFFNESSES, 0.0)
    matrix = np.diag(k[:-1] + k[1:]) - np.diag(k[1:-1], 1) - np.diag(k[1:-1], -1)
    root = np.sqrt(MASSES)
    squares, vectors = np.linalg.eigh(matrix / np.outer(root, root))
    shapes = vectors.T / root
    return 2 * np.pi / np.sqrt(squares), shapes / np.linalg.norm(shapes, axis=1, keepdims=True)


def tower() -> str:
    """The storeys by all their modes, in the plain form."""
    periods, shapes = eigen()
    rows = [
        ["mode", "", *"123"],
        ["period [s]", "", *periods],
        ["level [m]", "mass [kg]", *["shape"] * 3],
    ]
    rows += [[*floor] for floor in zip(np.cumsum(HEIGHTS), MASSES, *shapes, strict=True)]
    return "\n".join(",".join(map(str, row)) for row in rows)


def write(folder: Path) -> Path:
    path = folder / "tower.csv"
    path.write_text(tower(), encoding="utf-8")
    return path


def case_of(tmp_path: Path, building: str, gap: str = SMALL_GAP) -> Case:
    write(tmp_path)
    return read_text(tmp_path, f"{FIRM_SITE}envelope = 'none'\n{building}{NEIGHBOUR}{gap}")


def test_storeys_by_all_their_modes_need_the_same_gap_and_pound_alike(tmp_path: Path) -> None:
    """The same motions, elastic: what differs is the integration of the highest modes."""
    of_modes, of_storeys = (case_of(tmp_path, text) for text in (OF_FILE, STOREYS))
    assert of_modes.buildings[0].storeys == 3
    assert of_modes.buildings[0].height == pytest.approx(10.5)
    wanted = SMALL_GAP.replace('existing = "4 cm"', "")
    free = (case_of(tmp_path, text, wanted) for text in (OF_FILE, STOREYS))
    gaps = [answer_case(case).separation.gap_at_height[0] for case in free]
    np.testing.assert_allclose(*gaps, rtol=2e-3)
    hits = [pound_case(case, 16) for case in (of_modes, of_storeys)]
    assert float(hits[0].impacts.sum()) > 0
    np.testing.assert_allclose(*(hit.peak_alone for hit in hits), rtol=2e-3)
    np.testing.assert_allclose(*(hit.impacts.sum() for hit in hits), rtol=0.05)


def test_the_file_is_beside_the_case_and_an_input_of_it(tmp_path: Path) -> None:
    case = case_of(tmp_path, YIELDING)
    assert case.files == [tmp_path / "case.toml", tmp_path / "tower.csv"]
    assert case.buildings[0].structure.yield_displacements == pytest.approx(0.02)
    assert case.buildings[0].strength == "yield_displacements"
    listed = case_of(tmp_path, YIELDING.replace('"2 cm"', '["2 cm"]')).buildings[0].structure
    assert listed.describe().endswith("over yielding mode)")
    with pytest.raises(ValueError, match=r"line 10: building_1.modes = 'roof.csv' cannot be read"):
        case_of(tmp_path, YIELDING.replace("tower", "roof"))


def test_damping_and_strength_may_be_uncertain_and_damping_of_each_mode(tmp_path: Path) -> None:
    uncertain = YIELDING.replace("0.05", '"5 % +- 20 %"', 1).replace('"2 cm"', '"1.5 to 2.5 cm"')
    first = case_of(tmp_path, uncertain).buildings[0]
    assert {*first.sampled.uncertain} == {"damping", "yield_displacements"}
    each = (
        case_of(tmp_path, OF_FILE.replace("0.05", '["5 %", "4 %", "3 %"]')).buildings[0].structure
    )
    assert each.arrays()["damping"].values.tolist() == [0.05, 0.04, 0.03]


def test_a_base_shear_coefficient_means_the_same_by_storeys_and_by_modes(tmp_path: Path) -> None:
    """All storeys of a regular building yield at once, in its first mode."""
    shared = {"damping": 0.05, "hardening": 0.1, "base_shear_coefficient": 0.15}
    chain = sl.ShearBuilding.regular(period=0.7, storeys=6, storey_height=3.2, mass=2e5, **shared)
    shape = chain.first_mode_moves().values
    modes = xr.Dataset(
        {"period": ("mode", [0.7]), "shape": (("mode", "floor"), [shape])},
    ).assign(mass=("floor", [2e5] * 6), height=("floor", [3.2] * 6))
    with pytest.warns(sl.DoubtfulInput, match="of the mass"):
        tower = sl.ModalBuilding.from_table(modes, **shared)
    assert tower.oscillator().yield_displacement == pytest.approx(
        chain.oscillator().yield_displacement
    )


@pytest.mark.parametrize("law", with_slow(["bilinear", "bouc_wen"], {"bilinear"}))
def test_modes_of_a_case_take_a_strength_of_the_whole_building(tmp_path: Path, law: str) -> None:
    """The base shear of mode 1 at yield is that share of the weight; R is its oscillator's."""
    of_law = f'law = "{law}"\n' + "beta = 0.5\ngamma = 0.5\n" * (law == "bouc_wen")
    for key, value in (("base_shear_coefficient", '"12 %"'), ("reduction_factor", "4")):
        text = OF_FILE.replace("elastic = true", f"hardening = 0.05\n{of_law}{key} = {value}")
        case = case_of(tmp_path, text)
        tower = case.buildings[0].structure
        mode, shear = tower.oscillator(), tower.system()
        if key == "reduction_factor":
            factor = sl.reduction_factor(mode, case.site.ground).reduction_factor
            assert float(factor) == pytest.approx(4.0)
        else:
            at_yield = float((shear.post + shear.couple)[0] * mode.yield_displacement)
            assert at_yield == pytest.approx(0.12 * 9.80665 * sum(MASSES))
        assert np.isposinf(shear.strength[1:]).all()
        said = " ".join(block.text for block in details(answer_case(case)))
        assert "bears all of its strength and yields at" in said


@pytest.mark.filterwarnings("ignore:.*are their shapes exchanged")
def test_a_strength_of_the_whole_building_needs_most_of_the_mass_in_mode_1(tmp_path: Path) -> None:
    modes = sl.read_modes(write(tmp_path))
    modes["period"] = "mode", [0.5, 0.4, 0.3]
    modes["shape"] = ("mode", "floor"), modes["shape"].values[[1, 0, 2]]
    options = {"damping": 0.05, "hardening": 0.1}
    with pytest.raises(
        ValueError, match=r"mode 2 has more effective mass .*; yield_displacements give"
    ):
        sl.ModalBuilding.from_table(modes, **options, base_shear_coefficient=0.1)
    tower = sl.ModalBuilding.from_table(modes, **options, yield_displacements=[1.0, 0.02])
    assert tower.oscillator().yield_displacement == 0.02
    for wrong, says in (
        ({"yield_displacements": 0.1}, "allowed: one of them"),
        ({}, "-0.1 is out of range"),
    ):
        with pytest.raises(ValueError, match=says):
            sl.ModalBuilding.from_table(
                modes, **options, base_shear_coefficient=0.1 if wrong else -0.1, **wrong
            )
