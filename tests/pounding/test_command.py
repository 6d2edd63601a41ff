"""``stochlin pound``: what it says, saves and draws, and the energy balance of any valid case."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from cases import example_case, with_buildings
from click.testing import Result
from commands import answered, invoke, refused

import stochlin as sl
from stochlin.views.pounding.pictures import draw_pound

pytestmark = pytest.mark.cli

STEP = 0.02
RECORD = '[[site.records]]\npath = "{}.txt"\nname = "{}"\nunits = "g"\ndt = "0.02 s"\n'


def wave(folder: Path, name: str, seed: int, peak: float, seconds: float = 8.0) -> None:
    """A band of noise that rises and falls, in g."""
    time = STEP * np.arange(int(seconds / STEP))
    noise = np.random.default_rng(seed).normal(size=time.size)
    motion = np.convolve(noise, np.exp(-3 * time) * np.sin(9 * time), "full")[: time.size]
    motion *= np.sin(np.pi * time / time[-1])
    np.savetxt(folder / f"{name}.txt", peak * motion / np.abs(motion).max())


def case_file(folder: Path, *records: tuple[str, float], text: str = example_case()) -> Path:
    lines = ""
    for seed, (name, peak) in enumerate(records):
        wave(folder, f"r{seed}", seed, peak)
        lines += RECORD.format(f"r{seed}", name)
    (folder / "case.toml").write_text(text.replace("[motion]", f"{lines}\n[motion]", 1))
    return folder / "case.toml"


@pytest.fixture(scope="module")
def strong(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Result]:
    folder = tmp_path_factory.mktemp("strong")
    path = case_file(folder, ("Strong & near", 0.5))
    return folder, invoke("pound", path, "--out", folder / "p.nc", "--picture", folder / "p.png")


def test_few_time_steps_and_a_weak_record_are_said(tmp_path: Path) -> None:
    path = case_file(tmp_path, ("Strong", 0.5))
    done = invoke("pound", path, "--steps-per-contact", 4)
    assert "CAUTION: more than 1 %; take more --steps-per-contact." in " ".join(done.output.split())
    path = case_file(tmp_path, ("weak", 0.01))
    done = invoke("pound", path, "--out", tmp_path / "p.nc")
    with xr.open_dataset(tmp_path / "p.nc") as weak:
        least = float((0.05 + weak.displacement[:, 1] - weak.displacement[:, 0]).min())
    shown = " ".join(done.output.split())
    assert f"weak: no pounding. At least {100 * least:.1f} cm of the gap of 5.0 cm" in shown


def test_the_picture_is_drawn_from_the_file(strong: tuple[Path, Result]) -> None:
    folder, _ = strong
    with xr.open_dataset(folder / "p.nc") as table:
        assert all("long_name" in variable.attrs for variable in table.variables.values())
        figure = draw_pound(table)
        drawn = figure.axes[0].get_lines()[1].get_ydata()
        np.testing.assert_allclose(drawn, 100 * (table.displacement[:, 1] + 0.05))
        assert len(figure.axes) == 3


def with_row(*buildings: str, gaps: str = '"1 cm"') -> str:
    """The example with these buildings and gaps in place of its own."""
    numbered = (f"[building_{n}]\n{lines}" for n, lines in enumerate(buildings, start=1))
    return with_buildings(*numbered).replace('existing = "5 cm" ', f"existing = {gaps} ")


# --- Many motions
# -----------------------------------------------------------------------------------


def regular(count: int, period: float) -> str:
    return (
        f'period = "{period} s"\ndamping = "5 %"\nstoreys = {count}\nstorey_height = "3 m"\n'
        'floor_mass = "400 t"\nhardening = "5 %"\nbase_shear_coefficient = 0.2\n'
    )


def of_storeys(low_storey: str = "3 m") -> str:
    tall, low = (regular(*one) for one in ((4, 0.6), (2, 0.3)))
    return with_row(tall, low.replace("3 m", low_storey))


@pytest.mark.slow
def test_simulated_motions_are_said_saved_and_drawn_together(tmp_path: Path) -> None:
    text = of_storeys("3.6 m").replace("floors_align = true", "floors_align = false")
    path = case_file(tmp_path, text=text)
    done = answered("pound", path, "--motions", 8, "--picture", tmp_path / "p.png")
    assert {p.name for p in tmp_path.glob("p*")} == {"p.nc", "p.png"}
    shown = " ".join(done.output.split())
    with xr.open_dataset(tmp_path / "p.nc") as table:
        again = sl.pound_case(sl.read_case(path), 8)
        np.testing.assert_array_equal(table.impacts, again.impacts)
        assert f"hit in {100 * float(table.pounding_probability[0]):.0f} % of them" in shown
        assert "SLABS HIT COLUMNS" in shown
        panels = draw_pound(table).axes
        assert len(panels) == 2
        steps = panels[1].get_lines()[1]
        alone = 100 * table.peak_alone[:, 0].sel(floor=4)
        np.testing.assert_allclose(steps.get_xdata()[:-1], np.sort(alone))
        assert steps.get_ydata()[-1] == pytest.approx(0.0)


def test_motions_that_failed_are_said_loudly(tmp_path: Path) -> None:
    weak = of_storeys().replace("base_shear_coefficient = 0.2", "base_shear_coefficient = 0.02", 1)
    weak = weak.replace('hardening = "5 %"', "hardening = 0.01\np_delta = true", 1)
    path = case_file(tmp_path, text=weak.replace("0.01 m^2/s^3", "0.0002 m^2/s^3", 1))
    table = sl.pound_case(sl.read_case(path), 16)
    failed = int((table.status > 0).sum())
    assert 0 < failed < 16
    done = invoke("pound", path, "--motions", 16)
    assert (
        f"{failed} of 16 motions FAILED and are left out: pound: structure 1 falls over"
        in " ".join(done.output.split())
    )


def test_a_case_without_records_is_refused(tmp_path: Path) -> None:
    assert "--motions 100 for simulated ones" in refused("pound", case_file(tmp_path))


def test_buildings_stand_between_walls(tmp_path: Path) -> None:
    walls = 'wall_left = { gap = "1 cm" }\nwall_right = { gap = "2 cm", fixed = "space" }\n'
    path = case_file(tmp_path, ("Strong", 0.5), text=walls + example_case())
    done = invoke("pound", path, "--out", tmp_path / "p.nc", "--picture", tmp_path / "p.png")
    with xr.open_dataset(tmp_path / "p.nc") as table:
        assert table.neighbours.values.tolist() == ["wall | 1", "1 | 2", "2 | wall"]
        assert table.wall.values.tolist() == ["ground", "", "space"]
        assert table.attrs["wall_right"] == "Wall (fixed in space)"
        np.testing.assert_allclose(table.gap, [0.01, 0.05, 0.02])
        moved = (table.displacement[:, 1] - table.wall_displacement).max()
        assert float(table.least_clearance[2]) == pytest.approx(0.02 - float(moved), abs=1e-12)
        assert float(table.least_clearance[0]) == pytest.approx(
            0.01 + float(table.displacement[:, 0].min()), abs=1e-12
        )
    assert "Gap wall | 1, 1 cm" in done.output
    assert "Gap 2 | wall, 2 cm" in done.output
    many = answered("pound", path, "--motions", 8)
    assert "building 1 hits the wall in" in " ".join(many.output.split())


def test_a_wall_beside_one_building_needs_a_contact(tmp_path: Path) -> None:
    text = example_case().partition("[building_2]")[0] + '[wall_left]\ngap = "1 cm"\n'
    text += '[separation]\nconfidence = "90 %"\n'
    said = refused("pound", case_file(tmp_path, text=text), "--motions", 8)
    assert "needs the contact between building and wall; write [contact]" in said


def test_a_wall_has_no_mass(tmp_path: Path) -> None:
    text = 'wall_left = { gap = "1 cm", mass = "5 t" }\n' + example_case()
    path = case_file(tmp_path, ("Strong", 0.5), text=text)
    said = refused("pound", path)
    assert "wall_left.mass = '5 t' is not a key" in said
    assert "of a wall, which has no mass; allowed: gap, fixed, levels" in said
