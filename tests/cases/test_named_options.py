"""What a refusal asks for is named as its reader writes it, and helps when it is written so."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from cases import FIRM_SITE, SMALL_GAP, read_text
from commands import answered, refused

import stochlin as sl

pytestmark = pytest.mark.cli

MODES = "mode,,1\nperiod [s],,0.5\nlevel [m],mass,shape\n3,200,0.6\n6,200,1\n"
PUSHOVER = "roof,base shear\n0,0\n20,900\n50,1300\n120,1500\n"
BUILDING = 'modes = "tower.csv"\ndamping = 0.05\nelastic = true\n'
WEAK = 'modes = "tower.csv"\ndamping = 0.05\nmass_units = "t"\npushover = "push.csv"\n'


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """One with modes and a pushover curve of unstated units, and a record of two columns."""
    (tmp_path / "tower.csv").write_text(MODES, encoding="utf-8")
    (tmp_path / "push.csv").write_text(PUSHOVER, encoding="utf-8")
    rows = [f"{0.01 * n:.2f} {0.1 * (-1) ** n} {0.2 * (-1) ** n}" for n in range(40)]
    (tmp_path / "record.txt").write_text("\n".join(rows), encoding="utf-8")
    return tmp_path


def case_of(folder: Path, building: str, more: str = ""):
    second = '\n[building_2]\nperiod = "1 s"\ndamping = 0.05\nelastic = true\n'
    return read_text(folder, f"{FIRM_SITE}{more}\n[building_1]\n{building}{second}{SMALL_GAP}")


def test_python_has_arguments(folder: Path) -> None:
    with pytest.raises(ValueError, match=r"give mass_units=, allowed: kg, t"):
        sl.read_modes(folder / "tower.csv")
    assert sl.read_modes(folder / "tower.csv", mass_units="t")["mass"].values.tolist() == [2e5, 2e5]


def test_a_command_has_options(folder: Path) -> None:
    modes = folder / "tower.csv"
    assert "give --mass-units, allowed: kg, t" in refused("building", modes)
    said = refused("building", modes, "--mass-units", "stone")
    assert "Error: --mass-units 'stone' is not a known unit; allowed: kg, t" in said
    pushed = "building", modes, "--mass-units", "t", "--pushover", folder / "push.csv"
    assert "give --pushover-units, allowed: " in refused(*pushed)
    assert "400 t" in answered("building", modes, "--mass-units", "t").output


@pytest.mark.filterwarnings("ignore::stochlin.DoubtfulInput")
@pytest.mark.parametrize(
    ("building", "asked", "values"),
    [
        (BUILDING, 'give mass_units = "...", allowed: kg, t', ["t"]),
        (WEAK, 'give pushover_units = ["...", "..."], allowed: ', ["mm", "kN"]),
    ],
)
def test_a_case_file_has_keys_that_can_be_pasted(folder: Path, building, asked, values) -> None:
    with pytest.raises(ValueError, match=re.escape(asked)) as refusal:
        case_of(folder, building)
    (line,) = re.findall(r"give (\w+ = .*?), allowed", str(refusal.value))
    for value in values:
        line = line.replace("...", value, 1)
    assert case_of(folder, building + line).buildings[0].floors == 2


def test_a_record_of_a_case_file_has_keys(folder: Path) -> None:
    record = '\n[[site.records]]\npath = "record.txt"\nunits = "g"\n'
    with pytest.raises(
        ValueError, match=r'give column = "\.\.\." .*, or wrapped = true for one series'
    ):
        case_of(folder, 'period = "1 s"\ndamping = 0.05\nelastic = true\n', record)
