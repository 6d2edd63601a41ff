"""``stochlin mitigate``: what it says, saves and draws."""

import numpy as np
import pytest
import xarray as xr
from cases import example_case
from commands import answered, invoke

import stochlin as sl
from stochlin.applications.cases.rows import gap_of, pair_of

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


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    folder = tmp_path_factory.mktemp("mitigate")
    return folder, invoke("mitigate", case_file(folder), "--out", folder / "m.nc")


@pytest.fixture(scope="module")
def enough(tmp_path_factory):
    """A gap for which no measure has to be searched."""
    folder = tmp_path_factory.mktemp("enough")
    path = case_file(folder, ('existing = "5 cm"', 'existing = "80 cm"'))
    return folder, invoke("mitigate", path, "--out", folder / "m.nc")


@pytest.mark.parametrize("kind", [pytest.param("done", marks=pytest.mark.slow), "enough"])
def test_it_says_what_the_library_says(kind, request):
    folder, result = request.getfixturevalue(kind)
    assert result.exit_code == 0, result.output
    case = sl.read_case(folder / "case.toml")
    table = sl.mitigate(
        case.buildings[0].structure,
        case.buildings[1].structure,
        case.site.ground,
        case.site.course.duration,
        gap_of(case),
        case.measures,
        envelope=case.site.course.envelope,
        paths=case.simulated.motions,
    )
    for name in table.measure.values:
        row = table.sel(measure=name)
        for number, building in enumerate(pair_of(case), start=1):
            name = name.replace(f"structure {number}", building.name)  # noqa: PLW2901
        line = next(one for one in result.output.splitlines() if one.startswith(f"{name}  "))
        shown = "none found" if np.isnan(row.required_gap) else f"{100 * float(row.required_gap):.1f}"
        assert shown in line
    assert ("least damping, Annex" in result.output) == (kind == "done")
    assert ("least damping, structure 2" in table.measure) == (kind == "done")
    assert "structure" not in result.output
    with xr.open_dataset(folder / "m.nc") as opened:
        saved = opened.load()
    for name in table.data_vars:
        np.testing.assert_array_equal(saved[name], table[name])
    assert saved.attrs["gap_m"] == table.attrs["gap_m"]
    device = next(one for one in result.output.splitlines() if "damper 1 to ground" in one)
    of_device = table.sel(measure="Braces in the office block", link=1)
    ends = [1e-6 * float(of_device[f"peak_link_force_{end}"]) for end in ("mean", "quantile")]
    assert " | ".join(f"{end:.3g}" for end in ends) in device
    assert ("so no further measure is searched." in result.output) == (kind == "enough")


def test_a_table_of_rows_has_no_devices(tmp_path):
    path = case_file(tmp_path, ('existing = "5 cm"', 'existing = "80 cm"'))
    answered("mitigate", path, "--out", tmp_path / "m.csv")
    head, *rows = (tmp_path / "m.csv").read_text(encoding="utf-8").splitlines()
    assert "peak_link_force" not in head
    assert len(rows) == 4
