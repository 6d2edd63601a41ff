"""One building alone through a motion: what it bears and where its energy goes, as in a row."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from cases import assert_near, recorded_example
from commands import answered

import stochlin as sl
from stochlin.views.pounding.pictures import draw_pound

YIELDING = {"hardening": 0.05, "yield_displacement": 0.02}
OSCILLATOR = sl.Bilinear(1.2, 0.05, **YIELDING, mass=2e5)
TOWER = sl.ShearBuilding.regular(
    period=0.6, storeys=4, storey_height=3.0, mass=2e5, damping=0.05, hardening=0.05,
    base_shear_coefficient=0.2,
)  # fmt: skip
FAR = 0.8
CONTACT = sl.Kelvin(1e8, restitution=0.65)
GROUND = sl.named_ground("firm", intensity=0.02)
MOTIONS = sl.simulated_motions(GROUND, 8.0, sl.AminAng(1.0, 5.0, 2.0), paths=4, seed=1)
RECORD = MOTIONS.isel(path=0, drop=True)


@pytest.mark.oracle
@pytest.mark.parametrize("structure", [OSCILLATOR, TOWER])
def test_it_is_a_building_of_a_row_that_never_meets(structure):
    """To the error of the steps, which in a row are chosen for all of it."""
    alone = sl.pound([structure], motion=RECORD, steps_per_contact=128)
    row = sl.pound(
        [structure, OSCILLATOR, TOWER], [FAR, FAR], CONTACT, RECORD, steps_per_contact=128
    )
    assert row.sizes["impact"] == 0
    assert not {"contact", "impact", "neighbours", "side"} & set(alone.dims)
    for name in ("displacement", "velocity", "acceleration", "storey_shear", "base_shear"):
        own, other = alone[name].isel(structure=0), row[name].isel(structure=0)
        if "floor" in row[name].dims and "floor" not in own.dims:
            other = other.isel(floor=0, drop=True)
        assert_near(other, own, 1e-4)
    for name in ("input", "kinetic", "elastic", "viscous", "hysteretic"):
        own, other = (table[f"{name}_energy"].isel(structure=0) for table in (alone, row))
        np.testing.assert_allclose(own, other, rtol=0, atol=1e-4 * float(alone.input_energy.max()))


@pytest.mark.oracle
def test_an_oscillator_follows_respond_and_its_energies_add_up():
    alone = sl.pound([OSCILLATOR], motion=RECORD, steps_per_contact=128)
    other = sl.respond(OSCILLATOR, RECORD)
    peak = float(alone.peak[0])
    np.testing.assert_allclose(
        alone.displacement[:, 0], other.displacement, rtol=0, atol=2e-5 * peak
    )
    assert float(alone.energy_balance_error.max()) < 1e-9
    assert alone.peak.equals(alone.peak_alone.rename("peak"))
    assert float(alone.amplification[0]) == 1
    assert "contact" not in alone.attrs


ONE_ALONE = (
    'storeys = 4\nstorey_height = "3 m"\nfloor_mass = "200 t"\nbase_shear_coefficient = 0.2\n'
)


def alone_file(folder: Path, storeys: bool, more: str = "") -> Path:
    """The example with its first building only."""
    text = recorded_example()
    np.savetxt(folder / "taft.txt", RECORD.values / 9.80665)
    second, rest, contact = (
        text.index(f"[{name}]") for name in ("building_2", "separation", "contact")
    )
    text = text[:second] + text[rest:contact].replace('existing = "5 cm"', more or "# ")
    if storeys:
        begin = text.index("reduction_factor = 4\nheight")
        text = text[:begin] + ONE_ALONE + text[text.index("[separation]") :]
    path = folder / "alone.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.cli
@pytest.mark.parametrize("storeys", [False, True])
def test_the_command_takes_one_building(storeys: bool, tmp_path: Path) -> None:
    path = alone_file(tmp_path, storeys)
    picture = tmp_path / "p.png"
    done = answered("pound", path, "--picture", picture)
    shown = " ".join(done.output.split())
    assert "one building alone, without a neighbour" in shown
    assert "contact" not in shown.replace(str(tmp_path), "")
    case = sl.read_case(path)
    assert case.title == "Office block and annex"
    with xr.open_dataset(tmp_path / "p.nc") as table:
        assert table.attrs["title"].startswith("Office block and annex: alone in ")
        labels = [axes.get_ylabel() for axes in draw_pound(table).axes]
        assert labels[0] == ("roof [cm]" if storeys else "place [cm]")
        assert len(labels) == 2
        if storeys:
            assert f"{float(table.peak_storey_shear[0, 0]) / 1e6:.3g}" in shown
        else:
            assert f"{float(table.peak_base_shear[0]) / 1e6:.3g}" in shown
