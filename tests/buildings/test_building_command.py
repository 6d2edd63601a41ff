"""The command ``stochlin building``: what it prints of a file of modes."""

from pathlib import Path

import pytest
from commands import answered, refused

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


def test_its_example_is_a_building(wall: Path) -> None:
    example = wall.with_name("example.csv")
    example.write_text(answered("building", "--example").output, encoding="utf-8")
    of_example, own = (
        answered("building", path).output.splitlines()[1:] for path in (example, wall)
    )
    assert of_example == [line.replace("wall.csv", "example.csv") for line in own]
    assert "MODES is missing; 'stochlin building --example" in refused("building")


def test_errors_name_options_and_no_input_is_overwritten(wall: Path) -> None:
    assert "--direction 'UX' has no meaning for wall.csv" in refused(
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


def test_units_of_a_pushover_curve_are_two(wall: Path) -> None:
    """What the command prints of a curve is among the frozen answers."""
    push = wall.with_name("push.csv")
    push.write_text("roof,shear\n0,0\n2,826\n4,1520\n6,1890\n10,2180\n32,2600\n", encoding="utf-8")
    printed = answered("building", wall, "--pushover", push, "--pushover-units", "cm, kN").output
    assert "pushover curve push.csv, idealized by ASCE 41" in " ".join(printed.split())
    refusal = refused("building", wall, "--pushover", push, "--pushover-units", "cm")
    assert "--pushover-units 'cm'; allowed: two" in refusal
