"""``stochlin mitigate``: what it says, saves and draws."""

import numpy as np
import pytest
import xarray as xr
from cases import example_case
from commands import answered

import stochlin as sl
from stochlin.applications.cases.rows import gap_of, pair_of
from stochlin.views.shared.words import along

pytestmark = pytest.mark.cli

FEW = ("paths = 2048", "paths = 128")


def case_file(folder, *changes):
    """The example case on few motions, changed."""
    text = example_case()
    for old, new in (FEW, *changes):
        assert old in text
        text = text.replace(old, new, 1)
    path = folder / "case.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_it_says_what_the_library_says(tmp_path):
    """Where no measure has to be searched; a table with the least is frozen among the answers."""
    path = case_file(tmp_path, ('existing = "5 cm"', 'existing = "80 cm"'))
    said = answered("mitigate", path, "--out", tmp_path / "m.nc").output
    case = sl.read_case(path)
    table = sl.mitigate(
        *(building.structure for building in pair_of(case)),
        *(case.site.ground, gap_of(case), case.measures),
        duration=case.site.course.duration,
        envelope=case.site.course.envelope,
        paths=case.simulated.motions,
    )
    for row in along(table, "measure"):
        line = next(one for one in said.splitlines() if one.startswith(f"{row.measure.item()}  "))
        assert f"{100 * float(row.required_gap):.1f}" in line
    assert "structure" not in said
    assert "so no further measure is searched." in said
    with xr.open_dataset(tmp_path / "m.nc") as saved:
        for name in table.data_vars:
            np.testing.assert_array_equal(saved[name], table[name])
    answered("mitigate", path, "--out", tmp_path / "m.csv")  # without devices
    head, *rows = (tmp_path / "m.csv").read_text(encoding="utf-8").splitlines()
    assert "peak_link_force" not in head
    assert len(rows) == 4
