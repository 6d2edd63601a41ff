"""Modes of buildings from files, against the buildings that the files were written of."""

import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import stochlin as sl

MASSES, LEVELS = np.array([3e5, 3e5, 2.2e5]), np.array([4.0, 7.2, 10.4])
CHAIN = sl.ShearBuilding(MASSES, [4e8, 3e8, 2e8], np.diff(LEVELS, prepend=0.0), 0.05)
PLAIN = """# a tower
mode,,1,2
period [s],,0.5,0.18
level [m],mass [t],shape,shape
7,200,1,1
3.5,200,0.62,-1.61
"""


def modes_of(building: sl.ShearBuilding) -> tuple[np.ndarray, np.ndarray]:
    """Periods and shapes (modes, floors) from the eigenvalues of its matrices, by numpy alone."""
    k, m = np.append(np.asarray(building.stiffnesses), 0.0), np.asarray(building.masses)
    stiffness = np.diag(k[:-1] + k[1:]) - np.diag(k[1:-1], 1) - np.diag(k[1:-1], -1)
    root = np.sqrt(m)
    squares, vectors = np.linalg.eigh(stiffness / np.outer(root, root))
    shapes = vectors.T / root
    return 2 * np.pi / np.sqrt(squares), shapes / np.linalg.norm(shapes, axis=1, keepdims=True)


def plain_text(separator: str = ",", comma: bool = False) -> str:
    """The chain in the plain form, from the roof down."""
    periods, shapes = modes_of(CHAIN)
    rows = [["mode", "", *"123"], ["period [s]", "", *map(repr, periods.tolist())]]
    rows += [["level [cm]", "mass [kN-s²/m]", "shape", "shape", "shape"]]
    for level, mass, shape in [*zip(LEVELS * 100, MASSES / 1000, shapes.T, strict=True)][::-1]:
        rows.append([f"{level:g}", f"{mass:g}", *map(repr, shape.tolist())])
    text = "\n".join("\t".join(row) for row in rows)
    return (text.replace(".", ",") if comma else text).replace("\t", separator)


def read(tmp_path: Path, text: str, **arguments: object) -> xr.Dataset:
    path = tmp_path / "tower.csv"
    path.write_text(text, encoding="utf-8")
    return sl.read_modes(path, **arguments)


@pytest.mark.parametrize(("separator", "comma"), [(",", False), (";", True), ("\t", True)])
def test_a_chain_of_storeys_by_its_modes_is_the_chain(
    tmp_path: Path, separator: str, comma: bool
) -> None:
    table = read(tmp_path, plain_text(separator, comma))
    tower = sl.ModalBuilding.from_table(table, damping=0.05)
    np.testing.assert_allclose(tower.mode_periods(), CHAIN.periods(), rtol=1e-9)
    np.testing.assert_allclose(tower.levels(), LEVELS)
    np.testing.assert_allclose(tower.effective_masses().sum(), MASSES.sum())
    ground = sl.WhiteNoise(0.01)
    expected, found = (
        sl.linearize_system([building], ground).displacement_std for building in (CHAIN, tower)
    )
    np.testing.assert_allclose(found, expected, rtol=1e-6)


def test_units_may_be_asked_for_and_must_not_contradict_the_file(tmp_path: Path) -> None:
    bare = PLAIN.replace("[m]", "").replace("[t]", "")
    table = read(tmp_path, bare, mass_units="kip-s²/in", length_units="ft")
    np.testing.assert_allclose(table["mass"], 200 * 4448.2216 / 0.0254, rtol=1e-7)
    np.testing.assert_allclose(table["height"], 3.5 * 0.3048)
    of_ton = read(
        tmp_path, PLAIN.replace("[t]", "[ton]"), mass_units="t"
    )  # which ton the user knows
    assert of_ton["mass"].values.tolist() == [2e5, 2e5]
    with pytest.raises(
        ValueError, match=r"mass_units = 'kg' contradicts tower.csv, line 4, column 2"
    ):
        read(tmp_path, PLAIN, mass_units="kg")


TURNING = PLAIN.replace("level", "participation,,0.7,0.2\nmodal mass [t],,210,60\nlevel", 1)


def test_what_shapes_do_not_give_is_taken_from_the_file(tmp_path: Path) -> None:
    table = read(tmp_path, TURNING)
    with pytest.warns(UserWarning, match=r"67\.5% of the mass"):
        tower = sl.ModalBuilding.from_table(table, damping=0.05)
    assert tower.effective_masses().tolist() == [2.1e5, 6e4]
    assert tower.factors().tolist() == [0.7, 0.2]
    own = sl.ModalBuilding.from_table(read(tmp_path, PLAIN), damping=0.05)
    masses = ",".join(f"{mass / 1000:.6g}" for mass in own.effective_masses())
    factors = ",".join(f"{factor:.6g}" for factor in own.factors())
    agreeing = TURNING.replace("210,60", masses).replace("0.7,0.2", factors)
    again = sl.ModalBuilding.from_table(read(tmp_path, agreeing), damping=0.05)
    assert again.modal_masses is None
    assert again.describe() == own.describe()


def test_floors_upside_down_are_doubted(tmp_path: Path) -> None:
    with pytest.warns(UserWarning, match="are the floors in order"):
        read(tmp_path, PLAIN.replace("\n7,", "\n3,"))


BROKEN = {
    "line 5, column 2: the mass is missing": PLAIN.replace("7,200", "7,"),
    "line 6, column 2: the mass is -200; allowed: 0 < value": PLAIN.replace("5,200", "5,-200"),
    "line 6, column 5: '1' is beyond the 4 columns above": PLAIN.replace("-1.61", "-1.61,1"),
    "line 6, column 3: '0.6.2' is not a shape": PLAIN.replace("0.62", "0.6.2"),
    "line 2: mode numbers are not 1, 2 and so on": PLAIN.replace("mode,,1,2", "mode,,1,1"),
    "line 3: the floors are missing": PLAIN[: PLAIN.index("\nlevel")],
    "line 2, column 1: a line 'period [s]' is missing below": PLAIN.replace(
        "period [s],,0.5,0.18\n", ""
    ),
    "line 3, column 1: periods are in 'min'; allowed: s, so": PLAIN.replace("[s]", "[min]"),
    "line 3, column 1: periods are in 'ms'; allowed: s, so convert them": PLAIN.replace(
        "[s]", "[ms]"
    ),
    "line 3, column 1: periods are in 'Hz'; allowed: s, so write 1/f": PLAIN.replace("[s]", "[Hz]"),
    (
        "line 3, column 1: 'frequency [Hz]' is not known; allowed: period, participation"
    ): PLAIN.replace("period [s]", "frequency [Hz]"),
    "line 4, column 2: the file does not say the unit of the mass; give mass_units=": PLAIN.replace(
        "[t]", ""
    ),
    "line 4, column 1: participation is given without modal mass": PLAIN.replace(
        "level", "participation,,1,1\nlevel", 1
    ),
    ": mode 2 hardly moves along the direction": PLAIN.replace("1,1\n", "1,1e-15\n").replace(
        "-1.61", "0"
    ),
    ": mode 1 hardly moves along the direction": PLAIN.replace("7,200,1", "7,200,-0.62").replace(
        "level", "participation,,1.4,0.2\nmodal mass [t],,300,60\nlevel", 1
    ),
    ": mode 2 hardly moves along the direction, where it has mass": PLAIN.replace(
        "-1.61", "-1"
    ).replace("level", "participation,,0.2,1.4\nmodal mass [t],,60,300\nlevel", 1),
    ": two floors are at 3.5 m": PLAIN.replace("\n7,", "\n3.5,"),
    (
        " is no file of modes that is known; allowed: a file with a line 'mode,,1,2'"
    ): "height,mass\n3,4\n",
}


@pytest.mark.parametrize("message", BROKEN)
def test_a_broken_table_is_refused_with_its_place(tmp_path: Path, message: str) -> None:
    with pytest.raises(ValueError, match=f"tower.csv,? ?{re.escape(message)}"):
        read(tmp_path, BROKEN[message])


def test_an_argument_without_a_meaning_is_refused(tmp_path: Path) -> None:
    with pytest.raises(
        ValueError, match=r"direction = 'UX' has no meaning for tower\.csv, which has"
    ):
        read(tmp_path, PLAIN, direction="UX")
    with pytest.raises(TypeError, match="points = '12'; allowed: a list of names"):
        read(tmp_path, PLAIN, points="12")


def test_a_table_that_lacks_masses_makes_no_building(tmp_path: Path) -> None:
    table = read(tmp_path, PLAIN)
    with pytest.raises(ValueError, match="allowed: a dataset with height, mass, period, shape"):
        sl.ModalBuilding.from_table(table.drop_vars("mass"), damping=0.05)
