"""Modes of buildings from files, as programs of structural analysis print them."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from typing import Literal, get_args

import numpy as np
import xarray as xr

from stochlin.applications.buildings.mode_files import AskedModes, ModesOfFile, csi
from stochlin.applications.buildings.mode_files import plain as plain_form
from stochlin.applications.buildings.mode_files.csi_tables import MASS_RATIOS, tables_in
from stochlin.applications.sheets.sheets import check_alone, sheets_of
from stochlin.files.inputs import input_path
from stochlin.messages import DoubtfulInput, brief, listed, plain
from stochlin.models.arguments import Label, checked
from stochlin.models.buildings.base import FLOOR, MODE
from stochlin.models.buildings.modal import ModalBuilding, doubt_of_shape, effective_masses_of
from stochlin.solver.tables import labels

Direction = Literal["UX", "UY"]
MODE_DIRECTIONS: tuple[Direction, ...] = get_args(Direction)
LOWEST_FLOOR = 0.01  # m: floors that are lower are at the ground or below it


@checked
def read_modes(
    path: str | os.PathLike[str],
    *,
    direction: Direction | None = None,
    points: Sequence[str] = (),
    tower: Label | None = None,
    mass_units: str | None = None,
    length_units: str | None = None,
) -> xr.Dataset:
    r"""Read the modes of a building from a file that a program of structural analysis printed.

    The format is recognized by its first lines. Units are those of the file, or are given here;
    they are not guessed.

    Parameters
    ----------
    path : str or path
        Path of the file: a table in the plain form of stochlin; or tables that ETABS exports, as a
        workbook, as text, or as a folder with one ``.csv`` for each. The user guide shows what each
        needs, and a script of OpenSeesPy that writes the plain form. Text is in UTF-8, with ``,``,
        ``;`` or tabs between columns.
    direction : {"UX", "UY"}, optional
        Direction of the gap, needed where the file has modes along two.
    points : sequence of str, optional
        Names of the points whose displacements are the shapes, such as those of the edge that faces
        the neighbour, one on each floor; needed where the file has several.
    tower : str, optional
        Name of the tower, or of the diaphragm on each floor, that is the building at the gap;
        needed where the file has several.
    mass_units, length_units : str, optional
        Units of masses and of levels, where the file does not state them: ``"kg"``, ``"t"``, or a
        force over an acceleration such as ``"kip-s2/in"``; ``"m"``, ``"cm"``, ``"mm"``, ``"in"`` or
        ``"ft"``.

    Returns
    -------
    xarray.Dataset
        ``period`` [s] and ``shape`` over ``mode`` and ``floor``, ``mass`` [kg] and the storey
        ``height`` [m] over ``floor``, from the ground up, for `ModalBuilding.from_table`. If the
        file has them, also ``participation`` and the effective modal masses ``modal_mass`` [kg].
        Modes keep the numbers of the file and come by period, longest first. The ground is at 0 of
        a model whose base is lower, else at the base; floors at the ground or below it do not pound
        and are left out, and the lowest floor above has their masses too. The attributes
        ``below_ground`` and ``turning`` are their number and the modes that turn in plan, if no
        ``points`` are named.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ImportError
        If the file is a workbook and python-calamine is not installed.
    ValueError
        If the format is not known; if masses, floors, units or numbers are missing or not valid
        (the message names line and column); if a direction is missing; or if an argument has no
        meaning for the format, or contradicts the file.

    Warns
    -----
    DoubtfulInput
        If the leading mode moves more at the lowest floor than at the roof.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> import stochlin as sl
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "tower.csv"
    >>> rows = ["mode,,1,2", "period [s],,0.5,0.18", "level [m],mass [t],shape,shape"]
    >>> rows += ["7,200,1,1", "3.5,200,0.62,-1.61"]
    >>> _ = path.write_text("\n".join(rows), encoding="utf-8")
    >>> modes = sl.read_modes(path)
    >>> modes["shape"].sel(mode=1).values.tolist(), modes.height.values.tolist()
    ([0.62, 1.0], [3.5, 3.5])
    >>> tower = sl.ModalBuilding.from_table(modes, damping=0.05)
    """
    path = input_path("path", path)
    if isinstance(points, str) or not isinstance(points, Sequence):
        raise TypeError(f"points = {brief(points)}; allowed: a list of names")
    name = plain(path.name)
    choice = AskedModes(direction, tuple(points), tower, mass_units, length_units)
    files = [path]
    if path.is_dir():
        files = sorted(f for f in path.iterdir() if f.suffix.lower() == ".csv" and f.is_file())
        if not files:
            raise ValueError(f"the folder {name} holds no file .csv")
    sheets = [sheet for file in files for sheet in sheets_of(file)]
    tables = tables_in(sheets)
    of_plain = plain_form.sheets_in(sheets)
    readable = [*of_plain, *(table.sheet for table in [*tables.values()][:1])]
    if not readable:
        begins = f"{plain_form.HEADER} or a line 'TABLE:  {MASS_RATIOS}' of ETABS"
        what = f"{name} is no file of modes that is known; allowed: a file with {begins}"
        raise ValueError(f"{what}, or a folder with '{MASS_RATIOS}.csv' and others so named")
    check_alone(readable, "modes")
    modes = csi.read(tables, choice) if tables else plain_form.read(readable[0], choice)
    return _labelled(modes, name, choice.direction)


def with_masses(table: xr.Dataset, building: ModalBuilding) -> xr.Dataset:
    """The table of modes with the participation factors and modal masses that the building has.

    ``mass_share`` is the effective modal mass over the mass of all floors, and ``floor_move`` the
    displacement of each floor over that of the oscillator of the mode.
    """
    masses = building.effective_masses()
    table = table.assign(
        participation=(MODE, building.factors()),
        modal_mass=(MODE, masses),
        mass_share=(MODE, masses / float(table["mass"].sum())),
        floor_move=((FLOOR, MODE), building.moves()),
    )
    return labels.label(table).assign_attrs(building=building.describe())


def _labelled(modes: ModesOfFile, name: str, direction: str | None) -> xr.Dataset:
    """The dataset, with floors from the ground up and the modes by period."""
    up = np.argsort(modes.levels)
    longest = np.argsort(-modes.periods, kind="stable")
    masses = modes.masses[up]
    below = int((modes.levels < LOWEST_FLOOR).sum())
    if below == up.size:
        raise ValueError(
            f"{name}: no floor is above the ground; allowed: levels above {LOWEST_FLOOR:g} m"
        )
    masses[below] += masses[:below].sum()
    up = up[below:]
    levels = modes.levels[up]
    heights = np.diff(levels, prepend=0.0)
    if not (heights > 0).all():
        twice = levels[int(np.argmin(heights))]
        raise ValueError(f"{name}: two floors are at {twice:g} m; allowed: each level once")
    table = xr.Dataset(
        {
            "period": (MODE, modes.periods[longest]),
            "shape": ((MODE, FLOOR), modes.shapes[longest][:, up]),
            "mass": (FLOOR, masses[below:]),
            "height": (FLOOR, heights),
        },
        {
            MODE: (MODE, np.asarray(modes.modes)[longest], {"long_name": "number of the mode"}),
            FLOOR: (
                FLOOR,
                np.arange(1, levels.size + 1),
                {"long_name": "floor, from the ground up"},
            ),
            "level": (FLOOR, levels, {"units": "m", "long_name": "level of the floor"}),
        },
    )
    if modes.participation is not None and modes.modal_masses is not None:
        table["participation"] = MODE, modes.participation[longest]
        table["modal_mass"] = MODE, modes.modal_masses[longest]
    _warn_of_order(table, name)
    table = labels.label(table)
    table = labels.with_run_information(table, f"Modes of {name}", "read_modes", {})
    keys = "source", "direction", "left_out", "turning", "below_ground"
    about = name, direction, listed(modes.left_out), listed(modes.turning), below
    return table.assign_attrs({key: text for key, text in zip(keys, about, strict=True) if text})


def _warn_of_order(table: xr.Dataset, name: str) -> None:
    """Warn if the leading mode moves most below, as if the floors were upside down."""
    shapes = table["shape"].values
    modal_mass = table.get("modal_mass")
    masses = (
        effective_masses_of(shapes, table["mass"].values)
        if modal_mass is None
        else modal_mass.values
    )
    for text in doubt_of_shape(shapes[np.argmax(masses)]):
        warnings.warn(f"{name}: {text}", DoubtfulInput, stacklevel=4)
