"""``stochlin pound``: what it says, saves and draws, and the energy balance of any valid case."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from cases import example_case, with_buildings
from click.testing import Result
from commands import answered, invoke, refused

import stochlin as sl
from stochlin.applications.cases.rows import pair_of
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


def test_it_says_what_the_library_says(strong: tuple[Path, Result]) -> None:
    """With strengths in metres of the ground of the file; all lines are frozen among the answers."""
    folder, done = strong
    assert done.exit_code == 0, done.output
    case, pair = sl.read_case(folder / "case.toml"), []
    for building in pair_of(case):
        uy = float(sl.linearize(building.structure, case.site.ground).yield_displacement)
        pair.append(replace(building.structure, reduction_factor=None, yield_displacement=uy))
    [record] = case.site.records.values()
    table = sl.pound(pair, 0.05, case.contact, record)
    assert table.sizes["impact"] > 2
    shown = " ".join(done.output.split())
    assert f"Strong & near: {table.sizes['impact']} impacts" in shown
    assert f"Largest force {float(table.largest_force.max()) / 1e6:.3g} MN" in shown
    for n, structure in enumerate(pair):
        moved, alone = (100 * float(table[f"peak{end}"][n]) for end in ("", "_alone"))
        assert f"displacement [cm] {moved:.3g} alone {alone:.3g}" in shown
        assert f"ductility {moved / 100 / structure.yield_displacement:.3g}" in shown
    share = float(table.viscous_energy[-1].sum() / table.input_energy[-1].sum())
    assert f"damping dissipated {100 * share:.1f} %" in shown
    assert "refer to the ground of the file, firm, Clough" in shown
    assert "CAUTION" not in shown


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


def test_several_records_are_one_table(tmp_path: Path) -> None:
    path = case_file(tmp_path, ("a", 0.5), ("b", 0.01))
    shown = " ".join(invoke("pound", path).output.split())
    assert "2 records: buildings 1 and 2 hit in 50 % of them" in shown
    assert "PGA 0.01 g to 0.5 g" in shown


YIELDS = 'hardening = 0.05\nyield_drifts = "1 cm"'


def storeys(count: int, stiffness: str, height: str = "3 m", strength: str = YIELDS) -> str:
    """A building of so many equal storeys."""
    lists = {"masses": "300 t", "stiffnesses": stiffness, "heights": height}
    lines = [f"{name} = {[value] * count}" for name, value in lists.items()]
    return "\n".join([*lines, 'damping = "5 %"', strength, ""])


def with_row(*buildings: str, gaps: str = '"1 cm"') -> str:
    """The example with these buildings and gaps in place of its own."""
    numbered = (f"[building_{n}]\n{lines}" for n, lines in enumerate(buildings, start=1))
    return with_buildings(*numbered).replace('existing = "5 cm" ', f"existing = {gaps} ")


def test_slabs_that_hit_columns_are_said_loudly(tmp_path: Path) -> None:
    text = with_row(storeys(4, "350 MN/m"), storeys(2, "900 MN/m", "3.6 m", "elastic = true"))
    done = answered("pound", case_file(tmp_path, ("r", 0.4), text=text), "--picture", tmp_path / "p.png")
    shown = " ".join(done.output.split())
    with xr.open_dataset(tmp_path / "p.nc") as table:
        one = table.isel(contact=int(table.column_force.argmax("contact")))
        assert f"SLABS HIT COLUMNS at {int((table.column_force > 0).sum())} contacts" in shown
        assert f"{float(one.level):.4g} m up: the columns of storey {int(one.storey)} of " in shown
        assert f"take {float(one.column_force) / 1e6:.3g} MN" in shown
        assert "SLAB AGAINST COLUMN" in draw_pound(table).axes[0].texts[0].get_text()
        tall, low = (table.displacement.sel(structure=n) for n in (1, 2))
        there = low.sel(floor=1) * (3.0 / 3.6)
        least = float((0.01 + there - tall.sel(floor=1)).min())
        assert float(table.least_clearance[0]) == pytest.approx(least, rel=1e-9)
    weak = invoke("pound", case_file(tmp_path, ("r", 0.001), text=text))
    assert "SLABS FACE COLUMNS" in weak.output


# --- Many motions -----------------------------------------------------------------------------------


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
        again = sl.charts.pound_case(sl.read_case(path), 8)
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
    table = sl.charts.pound_case(sl.read_case(path), 16)
    failed = int((table.status > 0).sum())
    assert 0 < failed < 16
    done = invoke("pound", path, "--motions", 16)
    assert f"{failed} of 16 motions FAILED and are left out: pound: structure 1 falls over" in " ".join(
        done.output.split()
    )


@pytest.mark.parametrize(
    ("records", "arguments", "says"),
    [
        (["a"], ("--out", "p.csv"), "allowed: .nc"),
        ([], ("--motions", "1"), "1 is not in the range x>=2"),
        ([], (), "--motions 100 for simulated ones"),
    ],
)
def test_what_cannot_be_answered_is_refused_and_writes_nothing(
    records: list[str], arguments: tuple[str, ...], says: str, tmp_path: Path
) -> None:
    path = case_file(tmp_path, *((name, 0.1) for name in records))
    before = set(tmp_path.iterdir())
    assert says in refused("pound", path, *arguments)
    assert set(tmp_path.iterdir()) == before
