"""Modes as ETABS prints them, of a building that turns.

The building is written out here: rigid floors with their masses at the four corners, and storeys
whose stiffness along x is off the centre. Its eigenvalues are those of numpy. All modes together
move every point of every floor as the ground does: the participation factors times the shapes add
up to 1.
"""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import scipy.linalg
import xarray as xr

import stochlin as sl
from stochlin.applications.buildings.mode_files import AskedModes, csi
from stochlin.applications.buildings.mode_files.csi_tables import tables_in
from stochlin.applications.sheets.sheets import text_sheet
from stochlin.files.inputs import only_within

MASSES, HEIGHTS = np.array([300.0, 300.0, 220.0]), np.array([4.0, 3.2, 3.2])  # t, m
LEVELS, STORIES = np.cumsum(HEIGHTS), ("Story1", "Story2", "Roof")
A, B, OFF = 9.0, 6.0, 2.0  # half length along x, along y, and eccentricity [m]
CORNERS = {"1": (A, B), "2": (-A, B), "3": (-A, -B), "4": (A, -B)}
STIFFNESS = np.array(
    [[4e5, 0, -4e5 * OFF], [0, 3e5, 0], [-4e5 * OFF, 0, 4e7 + 4e5 * OFF**2]]
)  # kN, m


def eigen() -> tuple[np.ndarray, np.ndarray]:
    """Periods [s], and displacements of centres (modes, floors, ux uy rz), of unit modal mass."""
    n = MASSES.size
    matrix = np.zeros((3 * n, 3 * n))
    for i in range(n):
        matrix[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] += STIFFNESS
        if i:
            below = slice(3 * i - 3, 3 * i)
            own = slice(3 * i, 3 * i + 3)
            matrix[below, below] += STIFFNESS
            matrix[below, own] -= STIFFNESS
            matrix[own, below] -= STIFFNESS
    inertia = np.ravel([(m, m, m * (A**2 + B**2)) for m in MASSES])
    squares, vectors = scipy.linalg.eigh(matrix, np.diag(inertia))
    return 2 * np.pi / np.sqrt(squares), vectors.T.reshape(3 * n, n, 3)


PERIODS, SHAPES = eigen()
LOADS = np.einsum(
    "mfd,f->md", SHAPES[..., :2], MASSES
)  # sums of mass times displacement (modes, x y)
RATIOS = LOADS**2 / MASSES.sum()


def moves(y: float) -> np.ndarray:
    """Displacements along x at this y (modes, floors)."""
    return SHAPES[..., 0] - y * SHAPES[..., 2]


def at(corner: str, n: int, f: int) -> list[float]:
    """Displacements along x and y of a corner."""
    x, y = CORNERS[corner]
    return [moves(y)[n, f], SHAPES[n, f, 1] + x * SHAPES[n, f, 2]]


Cells = list[list[object]]


def table(name: str, titles: str, units: str, rows: Cells) -> Cells:
    return [[f"TABLE:  {name}"], titles.split("|"), units.split("|"), *rows, []]


def ratios_table() -> Cells:
    rows: Cells = [
        ["Modal", n, period, *np.round(ratio, 8), 0.0, *np.cumsum(RATIOS[:n], axis=0)[-1], 0.0]
        for n, (period, ratio) in enumerate(zip(PERIODS, RATIOS, strict=True), 1)
    ]
    titles = "Case|Mode|Period|UX|UY|UZ|SumUX|SumUY|SumUZ"
    return table("Modal Participating Mass Ratios", titles, "||sec|||||", rows)


def etabs() -> list[Cells]:
    """The tables of ETABS."""
    down = [*range(MASSES.size)][::-1]
    heights: Cells = [[STORIES[f], HEIGHTS[f] * 1000, "Yes"] for f in down]
    masses: Cells = [[STORIES[f], MASSES[f], MASSES[f], 0] for f in down] + [["Base", 50, 50, 0]]
    centres: Cells = [
        [STORIES[f], "D1", "Modal", "LinModEigen", "Mode", n + 1, *SHAPES[n, f]]
        for f in down
        for n in range(PERIODS.size)
    ]
    centres.insert(0, ["Roof", "D1", "Dead", "LinStatic", "", "", 1, 1, 0])
    joints: Cells = [
        [STORIES[f], c, f"{f}{c}", "Modal", "LinModEigen", "Mode", n + 1, *at(c, n, f)]
        for f in down
        for c in CORNERS
        for n in range(PERIODS.size)
    ]
    of_case = "Output Case|Case Type|Step Type|Step Number"
    return [
        ratios_table(),
        table("Story Definitions", "Story|Height|Master Story", "|mm|", heights),
        table("Mass Summary by Story", "Story|UX|UY|UZ", "|kN-s²/m|kN-s²/m|kN-s²/m", masses),
        table(
            "Diaphragm Center Of Mass Displacements",
            f"Story|Diaphragm|{of_case}|UX|UY|RZ",
            "||||||mm|mm|rad",
            centres,
        ),
        table(
            "Joint Displacements",
            f"Story|Label|Unique Name|{of_case}|Ux|Uy",
            "|||||||mm|mm",
            joints,
        ),
    ]


def as_text(tables: list[Cells], separator: str = ",", comma: bool = False) -> str:
    rows = [row for cells in tables for row in cells]
    lines = ["\t".join(map(str, row)) for row in rows]
    if comma:
        lines = [re.sub(r"(\d)\.(\d)", r"\1,\2", line) for line in lines]
    return "\n".join(lines).replace("\t", separator)


def by_page(cells: Cells, every: int = 5) -> Cells:
    """A table with its titles and units again on each page."""
    rows = cells[3:]
    pages = [rows[n : n + every] for n in range(0, len(rows), every)]
    return [row for page in pages for row in (*cells[:3], *page)]


def read(tmp_path: Path, text: str, **arguments: object) -> sl.ModalBuilding:
    path = tmp_path / "tower.csv"
    path.write_text(text, encoding="utf-8")
    return sl.read_modes(path, **arguments)


def changed(name: str, rows: Cells | None = None, titles: str = "", units: str = "") -> str:
    """The tables of ETABS with another table in place of one, or without it."""
    new = [table(titles.partition(":")[0], titles.partition(":")[2], units, rows)] if rows else []
    return as_text([cells for cells in etabs() if name not in str(cells[0])] + new)


def upwards() -> str:
    """Stories from the ground up, with their elevations above a base at 2 m."""
    rows: Cells = [[STORIES[f], HEIGHTS[f], 2 + LEVELS[f]] for f in range(3)]
    return changed("Story Definitions", rows, "Story Data:Name|Height|Elevation", "|m|m")


def by_diaphragm() -> str:
    rows: Cells = [[STORIES[f], "D1", MASSES[f], MASSES[f]] for f in (2, 1, 0)]
    titles = "Centers Of Mass And Rigidity:Story|Diaphragm|Mass X|Mass Y"
    return changed("Mass Summary", rows, titles, "||kN-s2/m|kN-s2/m")


VARIANTS: dict[str, Callable[[], str]] = {
    "as exported": lambda: as_text(etabs()),
    "in another order": lambda: as_text(etabs()[::-1]),
    "with a decimal comma": lambda: as_text(etabs(), ";", comma=True),
    "page by page": lambda: as_text([by_page(cells) for cells in etabs()]),
    "merged cells": lambda: re.sub(
        r"\n(Roof|Story\d)(?=,D1,Modal.*,Mode,[2-9],)", "\n", as_text(etabs())
    ),
    "from the ground up": upwards,
    "masses of diaphragms": by_diaphragm,
}


@pytest.mark.parametrize("variant", VARIANTS)
def test_tables_of_etabs_are_the_building(tmp_path: Path, variant: str) -> None:
    table = read(tmp_path, VARIANTS[variant](), direction="UX")
    np.testing.assert_allclose(table["mass"], MASSES * 1000)
    np.testing.assert_allclose(table["height"], HEIGHTS)
    kept = RATIOS[:, 0] >= 1e-3
    assert table["mode"].values.tolist() == (np.flatnonzero(kept) + 1).tolist()
    np.testing.assert_allclose(table["period"], PERIODS[kept])
    np.testing.assert_allclose(
        table["modal_mass"], 1000 * MASSES.sum() * RATIOS[kept, 0], rtol=1e-5
    )
    moved = table["participation"] * table["shape"]
    np.testing.assert_allclose(moved, (LOADS[:, :1] * SHAPES[..., 0])[kept], rtol=1e-4, atol=1e-9)
    assert table.attrs["direction"] == "UX"
    assert table.attrs["turning"] == ", ".join(map(str, np.flatnonzero(kept) + 1))
    assert "below_ground" not in table.attrs


def test_sheets_without_lines_of_names_are_known_by_their_own() -> None:
    """Which a workbook cuts after 31 characters."""
    names = [str(cells[0][0]).removeprefix("TABLE:  ") for cells in etabs()]
    texts = (as_text([cells[1:]]).splitlines() for cells in etabs())
    named = zip(texts, names, strict=True)
    tables = tables_in([text_sheet(text, f"tower.xlsx, sheet {name[:31]}") for text, name in named])
    assert [table.name for table in tables.values()] == [f"table {name}" for name in names]
    np.testing.assert_allclose(csi.read(tables, AskedModes("UX")).masses, 1e3 * MASSES)


def based(elevation: float) -> list[Cells]:
    """The tables of ETABS with an elevation of the base [m]."""
    name = "Tower and Base Story Definitions"
    return [*etabs(), table(name, "Tower|BSName|BSElev", "||m", [["T1", "Base", elevation]])]


@pytest.mark.parametrize(("elevation", "below"), [(-8.0, 2), (-1.5, 0), (25.0, 0)])
def test_floors_at_or_below_the_ground_do_not_pound(
    tmp_path: Path, elevation: float, below: int
) -> None:
    """The ground is at 0, or at a base that is higher; modes have the mass of all floors."""
    whole, deep = (
        read(tmp_path, as_text(based(base)), direction="UX") for base in (0.0, elevation)
    )
    np.testing.assert_allclose(deep.level, LEVELS[below:] + min(elevation, 0.0))
    np.testing.assert_allclose(
        deep["mass"], [MASSES[: below + 1].sum() * 1e3, *1e3 * MASSES[below + 1 :]]
    )
    for name in ("period", "participation", "modal_mass"):
        np.testing.assert_allclose(deep[name], whole[name])
    np.testing.assert_allclose(deep["shape"], whole["shape"][:, below:])
    assert deep.attrs.get("below_ground", 0) == below
    assert sl.ModalBuilding.from_table(deep, damping=0.05).storeys == 3 - below


def test_the_edge_of_a_building_that_turns_moves_with_the_ground_by_all_modes(
    tmp_path: Path,
) -> None:
    table = read(tmp_path, as_text(etabs()), points=["1"], direction="UX")
    whole = (table["participation"] * table["shape"]).sum("mode")
    np.testing.assert_allclose(whole, 1.0, atol=2e-3)
    exact = (LOADS[:, :1] * moves(B))[table["mode"].values - 1]
    np.testing.assert_allclose(table["participation"] * table["shape"], exact, atol=1e-5)
    assert "turning" not in table.attrs  # since points are named
    tower = sl.ModalBuilding.from_table(table, damping=0.05)
    assert tower.modal_masses is not None
    np.testing.assert_allclose(tower.effective_masses().sum(), MASSES.sum() * 1000, rtol=2e-3)
    np.testing.assert_allclose(tower.levels(), LEVELS)


def test_the_other_direction_does_not_turn_and_needs_no_factors(tmp_path: Path) -> None:
    """Along y the centre of stiffness is that of mass."""
    table = read(tmp_path, as_text(etabs()), points=["1"], direction="UY")
    assert table.sizes["mode"] == 3
    assert table.attrs["left_out"].count(",") == 5
    tower = sl.ModalBuilding.from_table(table, damping=0.05)
    assert tower.modal_masses is None
    np.testing.assert_allclose(tower.effective_masses().sum(), MASSES.sum() * 1000)


def test_a_folder_with_a_file_for_each_table_has_the_same_modes(tmp_path: Path) -> None:
    """Other files in it are left alone, and links lead nowhere."""
    folder = tmp_path / "tower"
    folder.mkdir()
    for n, cells in enumerate(etabs()[::-1]):
        (folder / f"table {n}.csv").write_text(as_text([cells]), encoding="utf-8")
    (folder / "push.csv").write_text(
        "displacement [mm],base shear [kN]\n0,0\n5,200\n", encoding="utf-8"
    )
    (folder / "notes.txt").write_text("UY is across the gap", encoding="utf-8")
    of_folder = sl.read_modes(folder, direction="UX")
    of_text = read(tmp_path, as_text(etabs()), direction="UX")
    xr.testing.assert_identical(of_folder.drop_attrs(), of_text.drop_attrs())
    masses = folder / "table 2.csv"
    outside = tmp_path / "outside.csv"
    masses.rename(outside)
    masses.symlink_to(outside)
    with only_within(folder), pytest.raises(ValueError, match="is outside of the folder"):
        sl.read_modes(folder, direction="UX")
    (tmp_path / "empty").mkdir()
    with pytest.raises(ValueError, match=r"the folder empty holds no file \.csv"):
        sl.read_modes(tmp_path / "empty")


@pytest.mark.parametrize("of_building", ["", "Tower A - ", "tower_"])
def test_tables_are_known_by_the_names_of_their_files(tmp_path: Path, of_building: str) -> None:
    """As other programs save them, without a line TABLE: and with or without one of units."""
    folder = tmp_path / "tower"
    folder.mkdir()
    for cells in etabs():
        name = str(cells[0][0]).removeprefix("TABLE:  ")
        name = name.lower().replace(" ", "_") if of_building.endswith("_") else name
        (folder / f"{of_building}{name}.csv").write_text(as_text([cells[1:]]), encoding="utf-8")
    of_folder = sl.read_modes(folder, direction="UX")
    of_text = read(tmp_path, as_text(etabs()), direction="UX")
    xr.testing.assert_identical(of_folder.drop_attrs(), of_text.drop_attrs())


def test_masses_by_diaphragm_are_those_of_the_stories(tmp_path: Path) -> None:
    titles = "Story|Diaphragm|Mass X|Mass Y|Mass Moment of Inertia|X Mass Center|Y Mass Center"
    rows: Cells = [
        [STORIES[f], "D1", 1e3 * MASSES[f], 1e3 * MASSES[f], 9.0, 1.0, 2.0] for f in (2, 1, 0)
    ]
    units = "||kg|kg|ton-m²|m|m"
    of_diaphragms = changed("Mass Summary", rows, f"Mass Summary by Diaphragm:{titles}", units)
    modes, of_stories = (
        read(tmp_path, text, direction="UX") for text in (of_diaphragms, as_text(etabs()))
    )
    np.testing.assert_allclose(modes["mass"], of_stories["mass"])
    of_towers = towers("same", OF_FLOORS).replace(
        "Centers Of Mass And Rigidity", "Mass Summary by Diaphragm"
    )
    expected = read(tmp_path, towers("same", OF_FLOORS), direction="UX", tower="D1")
    tower = read(tmp_path, of_towers, direction="UX", tower="D1")
    xr.testing.assert_identical(tower.drop_attrs(), expected.drop_attrs())


def towers(second: str, masses: Cells, moves: str = "D2") -> str:
    """Two towers of two floors, which move in modes of their own: 1 is that of T1, 2 that of T2."""
    names = {
        "T1": ("Roof", "Story1"),
        "T2": ("Roof", "Story1") if second == "same" else ("R2", "S2"),
    }
    heights: Cells = [[t, n, h] for t in names for n, h in zip(names[t], (3.6, 4.2), strict=True)]
    found: Cells = [
        [name, diaphragm, "Modal", mode, move * (mode == which), 0.0]
        for which, (t, diaphragm) in enumerate((("T1", "D1"), ("T2", moves)), 1)
        for name, move in zip(names[t], (2.0, 1.0), strict=True)
        for mode in (1, 2)
    ]
    ratios: Cells = [["Modal", 1, 0.4, 0.6, 0], ["Modal", 2, 0.3, 0.3, 0]]
    titles = "Story|Diaphragm|Mass X|Mass Y" if len(masses[0]) == 4 else "Story|UX|UY"
    name = "Centers Of Mass And Rigidity" if len(masses[0]) == 4 else "Mass Summary by Story"
    return as_text(
        [
            table("Modal Participating Mass Ratios", "Case|Mode|Period|UX|UY", "||sec||", ratios),
            table("Story Definitions", "Tower|Story|Height", "||m", heights),
            table(name, titles, "|".join(["", *["t"] * (len(masses[0]) - 1)]), masses),
            table(
                "Diaphragm Center Of Mass Displacements",
                "Story|Diaphragm|Output Case|Step Number|UX|UY",
                "||||mm|mm",
                found,
            ),
        ]
    )


OF_NAMES: Cells = [[n, m, m] for n, m in (("Roof", 190), ("Story1", 260), ("R2", 100), ("S2", 150))]
OF_FLOORS: Cells = [[n, d, m, m] for d, n, m in (("D1", "Roof", 190), ("D1", "Story1", 260))]
OF_FLOORS += [["Roof", "D2", 100, 100], ["Story1", "D2", 150, 150]]


@pytest.mark.parametrize(
    ("text", "tower"), [(towers("other", OF_NAMES), "T1"), (towers("same", OF_FLOORS), "D1")]
)
def test_one_of_two_towers_is_read(tmp_path: Path, text: str, tower: str) -> None:
    """Its modes alone; the ratios of the file are those of the mass of both."""
    modes = read(tmp_path, text, direction="UX", tower=tower)
    np.testing.assert_allclose(modes["level"], [4.2, 7.8])
    assert modes["mode"].values.tolist() == [1]
    assert modes["mass"].values.tolist() == [260e3, 190e3]
    np.testing.assert_allclose(modes["modal_mass"], 0.6 * 700e3)
    np.testing.assert_allclose(modes["participation"], 0.6 * 700e3 / (260e3 + 2 * 190e3))


ETABS = as_text(etabs())


def swap(old: str, new: str, count: int = -1) -> str:
    return ETABS.replace(old, new, count)


def sub(pattern: str, new: str, count: int = 0) -> str:
    return re.sub(pattern, new, ETABS, count=count)


BROKEN: dict[str, str | tuple[str, dict[str, object]]] = {
    "tower.csv: no floor is above the ground; allowed: levels above 0.01 m": as_text(based(-99.0)),
    "direction is missing: table Modal Participating Mass Ratios has modes along UX and UY": ETABS,
    "line 5, column 4: 'n/a' is not a UX": sub(r"(?<=Modal,2,)([^,]*),[^,]*", r"\1,n/a", 1),
    "line 22: table Mass Summary by Story has no mass of story Story2": swap(
        "Story2,300.0,300.0,0\n", ""
    ),
    "has no displacement of floor 'Story1' in mode 5": sub(
        r"Story1,D1,Modal,LinModEigen,Mode,5,.*\n", ""
    ),
    "line 35: 'Roof 2' is there twice; choose by tower= or points=": sub(
        r"(Roof,D1,Modal,LinModEigen,Mode,2,.*\n)", r"\1\1"
    ),
    "Joint Displacements has no joint 9; allowed as points: 1, 21": (ETABS, {"points": ["9"]}),
    "line 5, column 1: a second load case, 'Ritz' beside 'Modal'": swap("Modal,2,", "Ritz,2,"),
    (
        "hardly moves along the direction, where it has mass; allowed: shapes of the same analysis"
    ): sub("(Story.|Roof),D1(.*),Mode,2,[^,]*", r"\1,D1\2,Mode,2,1e-12"),
    "has T1, T2, which may be several buildings; give": towers("other", OF_NAMES),
    "does not say which masses are those of 'T1'; name a diaphragm as tower=, of Centers Of": (
        towers("same", OF_NAMES[:2], "D1").replace("0.0\nStory1,D1,Modal,1,0.0", "0.0\n"),
        {"tower": "T1"},
    ),
    "table Diaphragm Center Of Mass Displacements is missing: the file has Modal": changed(
        "Diaphragm"
    ),
    "tower = 'T3' is not in the tables; allowed: T1, T2": (
        towers("other", OF_NAMES),
        {"tower": "T3"},
    ),
    "has D1, D2, which may be several buildings; give that at the gap, tower='D1'": re.sub(
        "T[12],", "T1,", towers("same", OF_FLOORS)
    ),
    (
        "has S2, R2 and Story1, Roof, which move in different modes, as two buildings; name those"
    ): re.sub(
        "(?m)^(Tower|T[12]),",
        "",
        towers("other", OF_NAMES).replace("||m\n", "|m\n").replace(",,m\n", ",m\n"),
    ),
}


@pytest.mark.parametrize("message", BROKEN)
def test_a_broken_export_is_refused_with_its_place(tmp_path: Path, message: str) -> None:
    text, arguments = row if isinstance(row := BROKEN[message], tuple) else (row, {})
    along = {} if "direction is missing" in message else {"direction": "UX"}
    with pytest.raises(ValueError, match=re.escape(message)):
        read(tmp_path, text, **along | arguments)
