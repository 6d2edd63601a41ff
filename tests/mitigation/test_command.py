"""``stochlin mitigate``: what it says, saves and draws."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from cases import recorded_example, storeyed_building, with_buildings
from click.testing import CliRunner

import stochlin as sl
from stochlin.views.command import main
from stochlin.views.mitigation.pictures import draw_measures

pytestmark = pytest.mark.cli

FEW = ("paths = 2048", "paths = 128")


def run(*arguments):
    return CliRunner().invoke(main, ["mitigate", *map(str, arguments)])


def case_file(folder, *changes):
    """The example case on few motions, changed."""
    text = sl.example_case()
    for old, new in (FEW, *changes):
        assert old in text
        text = text.replace(old, new, 1)
    path = folder / "case.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    folder = tmp_path_factory.mktemp("mitigate")
    return folder, run(case_file(folder), "--picture", folder / "m.png")


def test_it_says_what_the_library_says(done):
    folder, result = done
    assert result.exit_code == 0, result.output
    case = sl.read_case(folder / "case.toml")
    table = sl.mitigate(
        case.first.structure,
        case.second.structure,
        case.ground,
        case.duration,
        case.gap,
        case.measures,
        envelope=case.envelope,
        paths=case.paths,
        contact=case.contact,
    )
    for name in table.measure.values:
        row = table.sel(measure=name)
        line = next(one for one in result.output.splitlines() if one.startswith(f"{name}  "))
        shown = "none found" if np.isnan(row.required_gap) else f"{100 * float(row.required_gap):.1f}"
        assert shown in line
    assert "Rubber bumpers: what a contact does shows on records" in result.output
    with xr.open_dataset(folder / "m.nc") as opened:
        saved = opened.load()
    np.testing.assert_array_equal(saved.required_gap, table.required_gap)
    assert (folder / "m.png").stat().st_size > 20_000


def test_records_are_shown_beside(tmp_path):
    time = 0.01 * np.arange(800)
    np.savetxt(tmp_path / "taft.txt", 0.3 * np.sin(7 * time) * np.sin(np.pi * time / time[-1]))
    path = tmp_path / "case.toml"
    path.write_text(recorded_example().replace(*FEW), encoding="utf-8")
    result = run(path, "--out", tmp_path / "m.csv")
    assert result.exit_code == 0, result.output
    assert "In Taft 1952:" in result.output
    assert "Times: largest displacement over that as built" in result.output
    assert (tmp_path / "m.csv").exists()


def test_a_gap_that_is_enough_asks_for_nothing_more(tmp_path):
    result = run(case_file(tmp_path, ('existing = "5 cm"', 'existing = "80 cm"')))
    assert result.exit_code == 0, result.output
    assert "That is enough: nothing more is looked for." in result.output
    assert "least" not in result.output.split("Added damping")[0]


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ([('existing = "5 cm"', 'existing = "0 cm"')], "it has to be open"),
        ([('mass = "3200 t"', "")], "links the buildings, which takes their masses"),
        ([("added_damping_2", "added_damping_3")], "added_damping_3"),
    ],
)
def test_bad_cases(tmp_path, changes, told):
    result = run(case_file(tmp_path, *changes))
    assert result.exit_code == 2
    assert told in " ".join(result.output.split())


def test_floors_that_are_not_level_are_told_and_links_have_to_say_theirs(tmp_path):
    storeys = [storeyed_building(n, start) for n, start in ((1, "period"), (2, "masses"))]
    path = tmp_path / "case.toml"
    path.write_text(with_buildings(*storeys).replace(*FEW).replace("align = true", "align = false"))
    refused = run(path)
    assert refused.exit_code == 2
    told = "case.toml: 'Dampers between both' links the buildings, and no two of their floors are at one"
    assert told in " ".join(refused.output.split())
    assert "as link_floors = [3, 3]" in " ".join(refused.output.split())
    constant = 'link_damping_constant = "5 MN s/m"'
    path.write_text(path.read_text().replace(constant, f"{constant}\nlink_floors = [3, 3]"))
    result = run(path)
    assert result.exit_code == 0, result.output
    assert "Floors are not level: floor 1 of Block 1, at 3 m" in " ".join(result.output.split())
    assert "least dashpot between: not looked for" in result.output


def test_the_picture_takes_nothing_else():
    with pytest.raises(ValueError, match="allowed: what mitigate returns"):
        draw_measures(xr.Dataset())
