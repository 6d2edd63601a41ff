"""The command ``stochlin building``: what it prints of a file of modes."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from commands import answered, refused

import stochlin as sl

pytestmark = pytest.mark.cli

WALL = """mode;;1;2;3
period [s];;0,72;0,118;0,043
level [m];mass [t];shape;shape;shape
3,4;300;0,094;-0,565;1,729
6,8;300;0,331;-1,082;0,529
10,2;300;0,650;-0,495;-1,648
13,6;220;1;1;1
"""


@pytest.fixture
def wall(tmp_path: Path) -> Path:
    path = tmp_path / "wall.csv"
    path.write_text(WALL, encoding="utf-8")
    return path


def test_it_prints_what_the_building_has(wall: Path) -> None:
    """Masses and displacements are L^2/M and phi L/M, written out."""
    shapes = np.array([[0.094, 0.331, 0.65, 1], [-0.565, -1.082, -0.495, 1], [1.729, 0.529, -1.648, 1]])
    masses = np.array([300.0, 300, 300, 220])
    loads, modal = shapes @ masses, shapes**2 @ masses
    share, factors = 100 * loads**2 / modal / masses.sum(), loads / modal
    result = answered("building", wall).output
    rows = [line.split() for line in result.splitlines()]
    for mode, period in enumerate((0.72, 0.118, 0.043)):
        expected = f"{mode + 1} {period:g} {share[mode]:.1f} {share[: mode + 1].sum():.1f}"
        assert [*expected.split(), f"{factors[mode]:.3f}"] in rows
    roof, first = (
        [*cells, *(f"{move:.3f}" for move in factors * shapes[:, floor])]
        for cells, floor in ((["4", "13.6", "3.4", "220"], 3), (["1", "3.4", "3.4", "300"], 0))
    )
    assert rows.index(roof) < rows.index(first)
    assert f"together: {share.sum():.1f} %" in result
    assert "Damping ratio of every mode: 5.0 %, assumed" in result
    assert "computed from shapes and floor masses" in result
    assert "assumed" not in answered("building", wall, "--damping", "3 %").output.split("Damping")[1]


def test_its_example_is_a_building(wall: Path) -> None:
    example = wall.with_name("example.csv")
    example.write_text(answered("building", "--example").output, encoding="utf-8")
    of_example, own = (answered("building", path).output.splitlines()[1:] for path in (example, wall))
    assert of_example == [line.replace("wall.csv", "example.csv") for line in own]
    assert "MODES is missing; 'stochlin building --example" in refused("building")


def test_errors_name_options_and_no_input_is_overwritten(wall: Path) -> None:
    assert "direction = 'UX' has no meaning for wall.csv" in refused(
        "building", wall, "--direction", "UX"
    )
    bare = wall.with_name("bare.csv")
    bare.write_text(WALL.replace("[t]", ""), encoding="utf-8")
    assert "1120 t" in answered("building", bare, "--mass-units", "t").output.replace("\xa0", " ")
    assert "would overwrite" in refused("building", wall, "--out", wall)
    tower = wall.parent / "tower"
    tower.mkdir()
    table = tower / "a.csv"
    table.write_text(WALL, encoding="utf-8")
    assert "would overwrite" in refused("building", tower, "--out", table)
    assert table.read_text(encoding="utf-8") == WALL


PUSH = "roof displacement [cm],base shear [kN]\n0,0\n2,826\n4,1520\n6,1890\n10,2180\n20,2480\n32,2600\n"


def test_a_pushover_curve_gives_the_strength_of_mode_1(wall: Path) -> None:
    """The roof at yield is the factor of mode 1 times its oscillator; the period is 2 pi (M D/V)^.5."""
    push, out = wall.with_name("push.csv"), wall.with_name("modes.nc")
    push.write_text(PUSH, encoding="utf-8")
    said = answered("building", wall, "--pushover", push, "--out", out).output
    said = " ".join(said.replace("\xa0", " ").split())
    ideal, modes = sl.bilinear_of(sl.read_pushover(push)), xr.load_dataset(out)
    force, roof = float(ideal["yield_force"]), float(ideal["yield_displacement"])
    factor, mass = float(modes["floor_move"].sel(mode=1)[-1]), float(modes["modal_mass"][0])
    weight = 9.80665 * 1.12e6
    assert f"yield at {force / 1e3:.5g} kN, {100 * force / weight:.1f} % of the weight" in said
    period = 2 * np.pi * np.sqrt(mass * roof / factor / force)
    assert f"period {period:.4g} s up to yield" in said
    assert f"of its oscillator {100 * roof / factor:.1f} cm" in said
    push.write_text(PUSH.replace("[kN]", ""), encoding="utf-8")
    again = answered("building", wall, "--pushover", push, "--pushover-units", "cm, kN").output
    assert " ".join(again.replace("\xa0", " ").split()) == said.partition(" saved")[0]
    told = refused("building", wall, "--pushover", push, "--pushover-units", "cm")
    assert "--pushover-units 'cm'; allowed: two" in told
