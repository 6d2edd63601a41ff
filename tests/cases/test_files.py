"""Case files: what is read is what is written, in any unit; what is wrong is said with its line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from cases import example_case
from cases import read_text as read
from hypothesis import given
from hypothesis import strategies as st

import stochlin as sl
from stochlin.applications.cases.examples import example_record
from stochlin.applications.cases.reading.kinds import WithUnit
from stochlin.applications.cases.reading.tables import key_lines
from stochlin.applications.cases.separation import answer_case
from stochlin.models.parameters import Range
from stochlin.models.units import UNITS, size_of

pytestmark = pytest.mark.invariant

EXAMPLE = example_case()


def changed(old: str, new: str, count: int = 1) -> str:
    assert old in EXAMPLE, old
    return EXAMPLE.replace(old, new, count)


def wave(folder: Path, name: str = "wave.txt", seed: int = 1) -> Path:
    time = 0.02 * np.arange(2000)
    noise = np.random.default_rng(seed).normal(size=time.size)
    motion = np.convolve(noise, np.exp(-4 * time) * np.sin(12 * time), "full")[: time.size]
    np.savetxt(folder / name, 0.01 * motion)
    return folder / name


RECORD = '[[site.records]]\npath = "wave.txt"\nunits = "g"\ndt = "20 ms"\n'
FITTED = f'ground = "fitted"\n{RECORD}'
GROUND = 'ground = "firm"'
# The envelope of the example is not that of the record: its motions are too weak, which is told.
OTHER_ENERGY = pytest.mark.filterwarnings("ignore:.*times the energy of the record")


def with_site(lines: str) -> str:
    start, end = EXAMPLE.index("[site]"), EXAMPLE.index("[motion]")
    return f"{EXAMPLE[:start]}[site]\n{lines}\n{EXAMPLE[end:]}"


def test_the_example_of_a_record_is_what_its_description_says(tmp_path: Path) -> None:
    """To its last digit, where another library may round differently."""
    (tmp_path / "record.at2").write_text(example_record())
    assert example_record().splitlines()[1].startswith("SYNTHETIC, by stochlin simulated_motions")
    site = sl.named_ground("firm", 0.01), 20.0, sl.AminAng(4.0, 15.0, 0.35)
    case = read(tmp_path, EXAMPLE)
    assert (case.site.ground, case.site.course.duration, case.site.course.envelope) == site
    shipped, motion = (
        sl.read_record(tmp_path / "record.at2"),
        sl.simulated_motions(*site, paths=2)[0],
    )
    np.testing.assert_allclose(shipped, motion, rtol=1e-7, atol=1e-9)


@given(
    st.sampled_from([units for units in UNITS if units != "1"]).flatmap(
        lambda units: st.tuples(st.just(units), st.sampled_from(sorted(UNITS[units])))
    ),
    st.floats(1e-6, 1e6),
    st.sampled_from(["", " ", "  "]),
)
def test_a_value_is_its_number_times_its_unit(
    pair: tuple[str, str], value: float, space: str
) -> None:
    units, unit = pair
    number, text = WithUnit(units, Range()), f"{value!r}{space}{unit}"
    if unit == "1/s" and not space:  # "21/s" might be 2 or 21
        with pytest.raises(ValueError, match="unknown unit"):
            number.in_si(text)
        return
    assert number.in_si(text) == pytest.approx(value * size_of(unit, units), rel=1e-14)


@pytest.mark.parametrize(
    ("text", "units", "value"),
    [
        ("2 kip-sec²/in", "kg", 2 * 4448.2216152605 / 0.0254),
        ("3 KN/m", "N/m", 3e3),
        ("100 lb/in", "N/m", 444.82216152605 / 0.0254),
        ("5 tonf*s/m", "N s/m", 5e3 * 9.80665),
        ("4 ft/s/s", "m/s^2", 4 * 0.3048),
        ("1 kip/in^1.5", "N/m^1.5", 4448.2216152605 / 0.0254**1.5),
    ],
)
def test_units_are_read_as_people_spell_them(text: str, units: str, value: float) -> None:
    assert WithUnit(units, Range()).in_si(text) == pytest.approx(value, rel=1e-12)


def test_ductility_gives_the_strength_that_has_it(tmp_path: Path) -> None:
    case = read(tmp_path, changed("\nreduction_factor = 4\nheight", "\nductility = 3\nheight"))
    structure = case.buildings[0].structure
    found = sl.linearize(structure, case.site.ground, "drift")
    assert 3 * float(found.ductility_std) == pytest.approx(3.0, rel=1e-6)


@OTHER_ENERGY
def test_records_are_read_beside_the_file_and_the_first_is_fitted(tmp_path: Path) -> None:
    path = wave(tmp_path)
    wave(tmp_path, "other.txt", seed=2)
    other = RECORD.replace("wave.txt", "other.txt")
    case = read(tmp_path, with_site(f'{FITTED}name = "Here"\n{other}'))
    assert list(case.site.records) == ["Here", "other.txt"]
    assert case.site.ground == sl.fit_ground(sl.read_record(path, dt=0.02, units="g"))


def test_what_is_no_case_file(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    with pytest.raises(FileNotFoundError, match=r"case\.toml"):
        sl.read_case(path)
    for content, says in (
        (b"", "site is missing"),
        (b"site = 5\n", r"motion is missing \(and also separation, building_1\)"),
    ):
        path.write_bytes(content)
        with pytest.raises(ValueError, match=says):
            sl.read_case(path)


def test_lines_of_keys_in_every_way_of_writing_them() -> None:
    text = """title = "a"
[ "site" ]  # note
a.b = 1
[[site.records]]
path = "x"
[[site.records]]
"path" = "y"
"""
    lines = key_lines(text)
    assert lines["site",] == 2
    assert lines["site", "a", "b"] == 3
    assert lines["site", "records", 0, "path"] == 5
    assert lines["site", "records", 1, "path"] == 7


def test_answer_is_that_of_the_library(tmp_path: Path) -> None:
    wave(tmp_path)
    site = f'{GROUND}\nintensity = "0.01 m^2/s^3"\n{RECORD}'
    common = 'floors_align = true\nsame_property = true\nsame_system = true\nzone = "II"\n'
    text = (
        with_site(site)
        .replace("paths = 2048", "paths = 128")
        .replace("floors_align = true", common)
    )
    case = read(tmp_path, text)
    answer = answer_case(case)
    pair = [sl.Bilinear(T, 0.05, 0.05, reduction_factor=4) for T in (1.0, 0.6)]
    motion = {"envelope": sl.AminAng(4.0, 15.0, 0.35), "paths": 128}
    ground = sl.named_ground("firm", intensity=0.01)
    record = sl.read_record(tmp_path / "wave.txt", dt=0.02, units="g")
    sites = {"height_1": 24.0, "height_2": 15.0, "storeys_1": 8, "storeys_2": 5, "zone": "II"}
    sites |= dict.fromkeys(("floors_align", "same_property", "same_system"), True)
    expected = sl.separation(
        *pair, ground, 20.0, **motion, codes=sites, records={"wave.txt": record}
    )
    # Sums over modes and products of matrices are not always rounded alike.
    common_part = answer.separation[list(expected.data_vars)]
    xr.testing.assert_allclose(common_part, expected, rtol=1e-10, atol=1e-15)
    scattered = sl.separation(*pair, ground, 20.0, **motion, scatter=0.3).sel(rule="simulation")
    assert float(answer.separation.gap_with_scatter) == pytest.approx(
        float(scattered.gap), rel=1e-13
    )
    assert answer.existing is not None
    existing = sl.existing_gap(*pair, ground, 0.05, duration=20.0, **motion)
    xr.testing.assert_allclose(answer.existing, existing, rtol=1e-13, atol=1e-15)
    assert "path" not in answer.table(samples=False).dims
    assert "existing_least_added_damping" in answer.table()
