"""Pushover curves: from files, and their bilinear idealizations by ASCE 41."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from typing import Annotated, Any

import numpy as np
import scipy.optimize
import xarray as xr

from stochlin.applications.sheets import quantities
from stochlin.applications.sheets.columns import (
    ColumnName,
    Need,
    check_one_kind,
    chosen,
    noted,
)
from stochlin.applications.sheets.sheets import sheets_of, table_in
from stochlin.files.inputs import input_path
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import DoubtfulInput, brief, plain
from stochlin.models.arguments import Metres, Number, checked
from stochlin.models.plausible import PLAUSIBLE
from stochlin.models.structures import STATIONARY_HARDENING
from stochlin.solver.tables import labels

CURVE = "base_shear"
ROOF_DISPLACEMENT = "displacement"
OF_ROOF = "displacement of the roof"
FEWEST_POINTS = 4  # points of a curve
LEAST_HARDENING = 0.01
SAME_SHEARS = 1e-3  # relative difference of base shears that are alike
AT_ORIGIN = 1e-3  # share of the largest values up to which the first point is the origin
EQUAL_AREAS = 1e-9  # difference of areas, relative to the area
LEAST_BEND = 1e-3  # least energy beyond that of a straight line, over the latter
ELASTIC_SHARE = 0.1  # share of the largest base shear up to which the curve is taken to be elastic
IDEALIZATION_REFERENCE = "ASCE/SEI 41-17 (2017), 7.4.3.2.4."


@checked
def read_pushover(
    path: str | os.PathLike[str],
    *,
    length_units: str | None = None,
    force_units: str | None = None,
    displacement_column: ColumnName | None = None,
    force_column: ColumnName | None = None,
) -> xr.DataArray:
    r"""Read a pushover curve from a file: base shear over the displacement of the roof.

    Units are those of the file, or are given here; they are not guessed. A curve that is pushed in
    the negative direction, or whose base shear is that of the reactions, is turned to positive
    signs. Where the file begins above 0 in both, the origin is added.

    Parameters
    ----------
    path : str or path
        Path of the file: text in UTF-8 with ``,``, ``;``, tabs or spaces between its columns, or a
        workbook. Text after ``#`` at the start of a line is a comment. Lines of titles, and a line
        of units below them, may come first. The columns are known by their titles, as ``roof`` or
        ``displacement`` and ``base shear`` or ``force``, in several languages.
    length_units, force_units : str, optional
        Units of the displacement, ``"m"``, ``"cm"``, ``"mm"``, ``"in"`` or ``"ft"``, and of the
        base shear, ``"N"``, ``"kN"``, ``"MN"``, ``"kgf"``, ``"tonf"``, ``"lbf"`` or ``"kip"``. Not
        needed if the titles have them, as in ``base shear [kN]``, or a line below the titles.
    displacement_column, force_column : int or str, optional
        Columns of the displacement and of the base shear, each by its number from 1 or by its
        title, where the titles do not say it. The attribute ``columns`` has those that are given by
        number.

    Returns
    -------
    xarray.DataArray
        Base shear [N] over ``displacement``, that of the roof [m], which begins at 0.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ImportError
        If the file is a workbook and python-calamine is not installed.
    ValueError
        If a column or a unit is not known, contradicts the file or is missing, something is no
        number, there are fewer than 4 points, displacements do not increase, or the base shear is
        not positive or falls from the start. The message names the line.

    Warns
    -----
    DoubtfulInput
        If the largest displacement is below 4 mm or above 2 m, or the largest base shear below 10
        kN or above 20 GN, so that a unit is probably wrong.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> import stochlin as sl
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "push.csv"
    >>> rows = ["roof displacement [mm],base shear [kN]", "0,0", "20,900", "50,1300", "120,1500"]
    >>> _ = path.write_text("\n".join(rows), encoding="utf-8")
    >>> curve = sl.read_pushover(path)
    >>> curve.displacement.values.tolist(), curve.values.tolist()
    ([0.0, 0.02, 0.05, 0.12], [0.0, 900000.0, 1300000.0, 1500000.0])
    """
    path = input_path("path", path)
    name = plain(path.name)
    table = table_in(sheets_of(path), "displacements and base shears")
    for column in (n for n, name in enumerate(table.names) if "case" in name):
        check_one_kind(table, column, "load case")
    needs = [
        Need("displacement_column", displacement_column, (quantities.DISPLACEMENT_COLUMN,)),
        Need("force_column", force_column, (quantities.FORCE_COLUMN,)),
    ]
    choices = [choice for choice in chosen(table, needs) if choice]
    series = []
    for choice, units in zip(choices, (length_units, force_units), strict=True):
        values = choice.in_si(units)
        series.append(values * np.sign(values[np.argmax(np.abs(values))]))
    displacement, force = checked_curve(series[0], series[1], table.places())
    for what, values, unit in ((ROOF_DISPLACEMENT, displacement, "m"), ("force", force, "N")):
        if text := PLAUSIBLE[f"{what} of a pushover"].doubt(float(values.max())):
            largest = f"{name}: its largest {what} is {values.max():.3g} {unit}"
            warnings.warn(f"{largest}; {text}", DoubtfulInput, stacklevel=3)
    return xr.DataArray(
        force,
        coords=[labels.axis(ROOF_DISPLACEMENT, OF_ROOF, displacement, "m")],
        name=CURVE,
        attrs={"units": "N", "long_name": "base shear", "source": name} | noted(choices),
    )


def pushover_options(units: Sequence[Any] | None, columns: Sequence[Any] | None) -> dict[str, Any]:
    """Arguments of `read_pushover` from units and columns, each of displacement and force."""
    of_units = dict(zip(("length_units", "force_units"), units or (), strict=False))
    return of_units | dict(
        zip(("displacement_column", "force_column"), columns or (), strict=False)
    )


@checked
def bilinear_of(
    pushover: xr.DataArray,
    *,
    target_displacement: Metres | None = None,
    hardening: Annotated[float, Number(STATIONARY_HARDENING)] | None = None,
) -> xr.Dataset:
    """Bilinear idealization of a pushover curve.

    The area below is that below the curve, the first line crosses the curve at 0.6 of the yield
    force, and the second one ends on it.

    Parameters
    ----------
    pushover : xarray.DataArray
        Base shear [N] over the dimension ``displacement`` of the roof [m], as `read_pushover` reads
        it.
    target_displacement : float, optional
        Displacement of the roof [m] up to which the curve is idealized, if it is less than that of
        the largest base shear, which is the default.
    hardening : float, optional
        Hardening ratio to be taken in place of that of the idealization [-], in (0, 1].

    Returns
    -------
    xarray.Dataset
        Without dimensions ``yield_force`` [N], ``yield_displacement`` [m], ``hardening`` [-],
        ``initial_stiffness`` [N/m] of the curve up to a tenth of its largest base shear,
        ``effective_stiffness`` [N/m] up to yield and ``target_displacement`` [m]; the curve,
        ``base_shear`` [N] over ``displacement``; and over ``point`` (origin, yield, end)
        ``idealized_displacement`` [m] and ``idealized_base_shear`` [N].

    Raises
    ------
    ValueError, TypeError
        If the curve has fewer than 4 points, its displacements do not increase, its base shear is
        not positive or falls from the start; if it does not bend up to its peak or target, so that
        it has no yield point, or its area cannot be met; if the target is beyond the curve; or if
        an argument is not valid.

    Warns
    -----
    DoubtfulInput
        If the idealization has a hardening ratio below 0.01, and none is given. 0.01 is then taken,
        which a stationary response needs.

    References
    ----------
    ASCE/SEI 41-17 (2017), 7.4.3.2.4.

    Examples
    --------
    >>> import xarray as xr
    >>> import stochlin as sl
    >>> roof = xr.DataArray([0.0, 0.02, 0.05, 0.12], dims="displacement", attrs={"units": "m"})
    >>> shear = [0.0, 9e5, 1.3e6, 1.5e6]
    >>> curve = xr.DataArray(
    ...     shear, coords={"displacement": roof}, dims="displacement", attrs={"units": "N"}
    ... )
    >>> ideal = sl.bilinear_of(curve)
    >>> round(float(ideal.yield_force)), round(float(ideal.yield_displacement), 4)
    (1153846, 0.0256)
    """
    whole, forces = _curve_of(pushover)
    peak = _peak_of(forces)
    end = whole[peak] if target_displacement is None else min(target_displacement, whole[peak])
    if target_displacement is not None and target_displacement > whole[-1]:
        what = f"target_displacement = {target_displacement:g} m is beyond the curve"
        raise ValueError(f"{what}, which ends at {whole[-1]:g} m; allowed: up to there")
    before = whole < end
    u = np.append(whole[before], end)
    v = np.append(forces[before], np.interp(end, whole, forces))
    force, displacement, last = _idealized(u, v, float(np.trapezoid(v, u)))
    stiffness = force / displacement
    ratio = (last - force) / (end - displacement) / stiffness
    if text := PLAUSIBLE["hardening of a pushover"].doubt(ratio):
        what = f"bilinear_of: the hardening ratio of the curve is {ratio:.3g}"
        warnings.warn(f"{what}; {text}", DoubtfulInput, stacklevel=3)
    beginning = ELASTIC_SHARE * v.max()
    table = xr.Dataset(
        {
            CURVE: pushover,
            "yield_force": force,
            "yield_displacement": displacement,
            "hardening": _hardening(ratio) if hardening is None else float(hardening),
            "initial_stiffness": beginning / _first_at(u, v, beginning),
            "effective_stiffness": stiffness,
            "target_displacement": float(end),
            "idealized_displacement": ("point", [0.0, displacement, end]),
            "idealized_base_shear": ("point", [0.0, force, last]),
        },
        {
            "point": (
                "point",
                ["origin", "yield", "end"],
                {"long_name": "point of the idealization"},
            )
        },
    )
    title = "Bilinear idealization of a pushover curve"
    table = labels.label(table, {ROOF_DISPLACEMENT: ("m", OF_ROOF)})
    return labels.with_run_information(table, title, "bilinear_of()", {}, IDEALIZATION_REFERENCE)


def checked_curve(displacement: Array, force: Array, places: Sequence[str]) -> tuple[Array, Array]:
    """A pushover curve without repeated points, from the origin; ``places`` name its points.

    Up to the largest base shear displacements must increase. What follows is not looked at, and
    left out from where the displacement goes back. Raises a ValueError for what is no pushover
    curve.
    """
    small = AT_ORIGIN * np.abs([displacement, force]).max(axis=1, initial=0.0)
    at_zero = force.size and abs(displacement[0]) <= small[0] and abs(force[0]) <= small[1]
    if at_zero:
        displacement = np.append(0.0, displacement[1:])
        force = np.append(0.0, force[1:])
    elif force.size and displacement[0] > 0 and force[0] > 0:
        displacement = np.append(0.0, displacement)
        force = np.append(0.0, force)
        places = ["the origin", *places]
    new = np.append(True, (np.diff(displacement) != 0) | (np.diff(force) != 0))[: force.size]
    places = [place for place, is_new in zip(places, new, strict=True) if is_new]
    u = displacement[new]
    v = force[new]
    peak = _peak_of(v) if v.size else 0
    back = np.diff(u, prepend=-np.inf) <= 0
    if back[: peak + 1].any():
        n = int(np.argmax(back))
        what = f"{places[n]}: the displacement goes from {u[n - 1]:g} to {u[n]:g} m"
        raise ValueError(f"{what}; allowed: increasing displacements of one push")
    again = (np.abs(u) <= small[0]) & (np.arange(u.size) > peak)
    if again.any():
        n = int(np.argmax(again))
        raise ValueError(f"{places[n]}: a second push begins; allowed: one, so take the other out")
    end = int(np.argmax(back)) if back.any() else u.size
    u = u[:end]
    v = v[:end]
    if u.size < FEWEST_POINTS:
        raise ValueError(f"pushover has {u.size} points; allowed: {FEWEST_POINTS} or more")
    if u[0] != 0 or v[0] != 0:
        what = f"the curve begins at {u[0]:g} m and {v[0]:g} N; allowed: 0 and 0"
        raise ValueError(f"{places[0]}: {what}, so take off what the permanent loads cause")
    if n := int(np.argmax(np.append(1.0, v[1 : peak + 1]) <= 0)):
        raise ValueError(f"{places[n]}: the base shear is {v[n]:g} N; allowed: positive ones")
    if peak == 1:
        what = f"the base shear falls from the start, from {v[1]:g} to {v[2]:g} N"
        raise ValueError(f"{places[2]}: {what}; allowed: a later peak, so give points in between")
    return u, v


def _peak_of(force: Array) -> int:
    """Index of the last point with the largest base shear, as far as the curve is known."""
    return int(np.flatnonzero(force >= (1 - SAME_SHEARS) * force.max())[-1])


def _curve_of(pushover: object) -> tuple[Array, Array]:
    """Displacements [m] and base shears [N] of a curve, checked."""
    if not isinstance(pushover, xr.DataArray) or pushover.dims != (ROOF_DISPLACEMENT,):
        raise TypeError(f"pushover = {brief(pushover)}; allowed: what read_pushover returns")
    arrays = pushover[ROOF_DISPLACEMENT], pushover
    for array, units in zip(arrays, ("m", "N"), strict=True):
        stated = array.attrs.get("units")
        if stated != units or array.dtype.kind not in "iuf" or not np.isfinite(array).all():
            what = f"pushover has {array.dtype} values in {brief(stated)}"
            raise ValueError(
                f"{what}; allowed: finite numbers with the attribute units = {units!r}"
            )
    displacement = arrays[0].to_numpy().astype(float)
    force = arrays[1].to_numpy().astype(float)
    return checked_curve(
        displacement, force, [f"pushover, point {n}" for n in range(1, force.size + 1)]
    )


def _hardening(ratio: float) -> float:
    """The hardening ratio of an idealization, or the least one with a warning."""
    if ratio >= LEAST_HARDENING:
        return ratio
    what = (
        f"pushover: the hardening ratio is {ratio:.3g}; {LEAST_HARDENING:g} is taken; give "
        "hardening"
    )
    warnings.warn(what, DoubtfulInput, stacklevel=4)
    return LEAST_HARDENING


def _first_at(u: Array, v: Array, force: float) -> float:
    """Displacement at which a curve first has this base shear."""
    n = int(np.argmax(v >= force))
    return float(u[n - 1] + (u[n] - u[n - 1]) * (force - v[n - 1]) / (v[n] - v[n - 1]))


def _idealized(u: Array, v: Array, energy: float) -> tuple[float, float, float]:
    """Force and displacement at yield, and force at the end, of a curve with this area below it."""
    most = float(v.max())
    last = float(v[-1])
    straight = 0.5 * u[-1] * last  # energy of a straight line to the end of the curve
    if energy < straight * (1 + LEAST_BEND):
        what = f"pushover does not bend up to {u[-1]:g} m, so that it has no yield point"
        raise ValueError(f"{what}; allowed: a curve that is pushed into yielding and flattens")

    def at_yield(force: float) -> float:
        return _first_at(u, v, 0.6 * force) / 0.6

    def excess(force: float) -> float:
        """Twice the area of the idealization beyond that of the curve, over the latter."""
        return (force * u[-1] + last * (u[-1] - at_yield(force))) / energy - 2

    force = most
    if excess(most) > EQUAL_AREAS:  # else it hardly hardens, or has no such idealization
        force = float(scipy.optimize.brentq(excess, 1e-6 * most, most, xtol=1e-9 * most))
    if abs(excess(force)) > 1e3 * EQUAL_AREAS:
        what = "pushover: no two lines have its area and cross it at 0.6 of the yield force"
        raise ValueError(f"{what}; allowed: a curve that flattens")
    return force, at_yield(force), last
