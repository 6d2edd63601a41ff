"""Checked records and structures, the cells of a table of structures, and the labelled table."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated, Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.applications.records.components import word_of
from stochlin.applications.records.records import checked_record, copies, doubts_of_motion
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import cores
from stochlin.kernels.records.oscillator import DISPLACEMENT
from stochlin.kernels.records.runs import SampledMotion, work_of
from stochlin.messages import plain
from stochlin.models.arguments import OfClass, check_label, is_label
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.parameters import expect
from stochlin.models.structures import AnyStructure, Structure
from stochlin.models.systems import falls_at
from stochlin.solver.tables import labels
from stochlin.solver.tables.cells import Flat, flat
from stochlin.solver.tables.checks import check_work, count_cells
from stochlin.solver.tables.lazy import check_names


class AskedRecords:
    """What is asked about records in memory, as `read_record` asks about those of files."""

    def doubts(self, name: str, records: object) -> Iterator[str]:
        """Texts on implausible records, and on those that are there twice."""
        named = {name: records} if isinstance(records, xr.DataArray) else _by_name(records)
        try:
            motions = {label: checked_record(record) for label, record in named.items()}
        except (TypeError, ValueError):  # which are refused later
            return
        for label, (values, step) in motions.items():
            yield from (f"{plain(label)}: {text}" for text in doubts_of_motion(values, step))
            component = word_of(label) if isinstance(records, Mapping) else None
            if component and component.vertical:
                yield f"{plain(label)} is vertical by its name; is it the right component?"
        names = [plain(label) for label in motions]
        for first, later in copies([values for values, _ in motions.values()]):
            yield f"{names[first]} and {names[later]} are the same motion; is it to count twice?"


def _by_name(records: object) -> dict[str, Any]:
    """Several records by their names, or by their numbers from 1."""
    if isinstance(records, Mapping):
        return {str(name): record for name, record in records.items()}
    if isinstance(records, (list, tuple)):
        return {str(number): record for number, record in enumerate(records, 1)}
    return {}


Records = Annotated[
    xr.DataArray | Sequence[xr.DataArray] | Mapping[str, xr.DataArray], AskedRecords()
]
"""One record, as from `read_record`, or several as a list, or as a mapping with their names."""

RECORD = "record"
ONE_STRUCTURE = "scalars, since histories are of one structure; response_spectrum takes arrays"
# Numbers in memory at once for a structure of a cell, and for a cell on a record.
NUMBERS_OF_STRUCTURE = 10
NUMBERS_ON_RECORD = 28
SUBSTEP_SECONDS = 6e-8  # of a sub-step [s]
OUT_OF_RANGE = "its squares are beyond the range of numbers; take a record in m/s^2 of usual size"
# shortest period over time step; below it the response is to the interpolation
SHORTEST_IN_STEPS = 0.1


class RecordedMotions(NamedTuple):
    """Checked records, as accelerations with a time step, and their names."""

    records: list[xr.DataArray]
    grounds: list[SampledMotion]
    names: list[str] | None  # None for a single record, which adds no dimension to results

    def describe(self) -> str:
        """The records in one line, for the run information."""
        names = self.names or ["record"]
        named = zip(names, self.grounds, strict=True)
        return "; ".join(
            f"{name}: {len(values)} samples at {dt:g} s" for name, (values, dt) in named
        )

    def together(self, tables: Sequence[xr.Dataset]) -> xr.Dataset:
        """The tables of all records in one over ``record``, or that of a single record as it is."""
        if self.names is None:
            return tables[0]
        names = xr.DataArray(self.names, dims=RECORD, name=RECORD, attrs={"long_name": "record"})
        return xr.concat(tables, names, data_vars="all", coords="minimal", compat="override")


def checked_motions(record: Records, may_be_still: bool = False) -> RecordedMotions:
    """The checked records with names: in a list sources if they are labels and differ, or numbers.

    A ground that ``may_be_still`` has zeros alone.
    """
    if isinstance(record, xr.DataArray):
        return RecordedMotions(
            [record], [SampledMotion(*checked_record(record, may_be_still))], None
        )
    if isinstance(record, Mapping):
        names = [str(name) for name in record]
        records = list(record.values())
    elif isinstance(record, (list, tuple)):
        records = list(record)
        sources = [str(getattr(motion, "attrs", {}).get("source", "")) for motion in records]
        distinct = all(map(is_label, sources)) and len(set(sources)) == len(sources)
        names = sources if distinct else [str(n + 1) for n in range(len(records))]
    else:
        raise TypeError(
            f"record is a {type(record).__name__}; allowed: an xarray.DataArray or several"
        )
    if not records:
        raise ValueError("record is empty; allowed: at least one record")
    grounds = []
    for name, motion in zip(names, records, strict=True):
        check_label("the name of a record", name)
        try:
            grounds.append(SampledMotion(*checked_record(motion, may_be_still)))
        except (TypeError, ValueError) as error:
            raise type(error)(f"record {name}: {error}") from error
    return RecordedMotions(records, grounds, names)


def ends_of_events(values: xr.DataArray, events: Sequence[object]) -> list[xr.DataArray]:
    """The smallest and the largest values of each event, over ``record``.

    Components of a station are not independent: the lower end of an interval is that of the
    smallest values, its upper end that of the largest.
    """
    numbers = [
        [n for n, of_record in enumerate(events) if of_record == event]
        for event in dict.fromkeys(events)
    ]
    parts = [values.isel({RECORD: of_event}) for of_event in numbers]
    ends = ([getattr(part, end)(RECORD, skipna=False) for part in parts] for end in ("min", "max"))
    return [xr.concat(extremes, RECORD) for extremes in ends]


def check_structure(role: str, structure: AnyStructure) -> None:
    """Raise an error for a structure whose response to a record cannot be computed."""
    expect(structure, AnyStructure, role)
    if structure.by_reduction_factor:
        raise ValueError(f"{role}: reduction_factor is for a ground; allowed: yield_displacement")


# Structures whose response to a record can be computed.
OnRecord = Annotated[AnyStructure, check_structure]
OscillatorOnRecord = Annotated[Structure, OfClass((Structure,)), check_structure]


class RecordCells(NamedTuple):
    """One or two bilinear structures on records, in valid cells of a table of their parameters."""

    motions: RecordedMotions
    flat: Flat
    sides: list[Array]  # (valid cells, 4) each: w, damping, hardening and yield displacement

    @classmethod
    def of(cls, motions: RecordedMotions, *structures: Bilinear) -> RecordCells:
        """The cells of structures; raises a ValueError if the responses would take too much.

        A cell with a period below a tenth of the longest time step of the records is not valid.
        """
        least = SHORTEST_IN_STEPS * max(ground.dt for ground in motions.grounds)
        for structure in structures:
            if (period := structure.arrays()["period"]).ndim == 0 and period < least:
                what = f"{least:g} s or more, a tenth of the time step of a record"
                raise ValueError(f"period = {float(period):g} s; allowed: {what}")
        cure = "take longer periods, or fewer structures or records at a time"
        numbers = NUMBERS_OF_STRUCTURE * len(structures) + NUMBERS_ON_RECORD * len(motions.grounds)
        check_work("the table would take", cure, numbers=numbers * count_cells(*structures))
        cells = flat(dict(zip(("first", "second"), structures, strict=False)), settled=False)
        check_names((*cells.shape.dims, *cells.shape.coords), (RECORD, "status"))
        sides = [_parameters(structure, cells.where.size) for structure in cells.models.values()]
        usable = np.all([side[:, 0] <= 2 * np.pi / least for side in sides], axis=0)
        cells = cells._replace(where=cells.where[usable])
        sides = [side[usable] for side in sides]
        seconds = SUBSTEP_SECONDS * sum(work_of(ground, *sides).sum() for ground in motions.grounds)
        check_work("structures on records would take", cure, seconds=seconds, cores=cores())
        return cls(motions, cells, sides)

    def peak(self, number: int, peaks: Array) -> Array:
        """Peak displacements of a structure (records, valid cells) [m], infinite where it falls."""
        _, _, hardening, uy = self.sides[number].T
        peak = peaks[..., DISPLACEMENT]
        return np.where(peak > falls_at(hardening, 1 - hardening, uy), np.inf, peak)

    def table(self, columns: Mapping[str, Array], peaks: Sequence[Array]) -> xr.Dataset:
        """Columns (records, valid cells) as a labelled table over the records and the dimensions.

        The status of a cell is ``elastic_limit`` if no structure yielded in its peak displacement,
        and ``invalid_input`` if its parameters are. Where a number is not finite, and no structure
        falls, all are NaN, with the status ``not_converged``. An ArithmeticError is raised for a
        lone cell.
        """
        shape = self.flat.shape
        check_names((*shape.dims, *shape.coords), columns)
        stayed = [peak <= side[:, 3] for peak, side in zip(peaks, self.sides, strict=True)]
        status = np.where(np.all(stayed, axis=0), labels.ELASTIC_LIMIT, labels.CONVERGED)
        falls = np.any(np.isposinf(peaks), axis=0)
        lost = ~falls & ~np.all([np.isfinite(values) for values in columns.values()], axis=0)
        if lost.any():
            if shape.ndim == 0 and self.motions.names is None:
                raise ArithmeticError(f"the response is not a number; {OUT_OF_RANGE}")
            status = np.where(lost, labels.NOT_CONVERGED, status)
            columns = {name: np.where(lost, np.nan, values) for name, values in columns.items()}
        whole = {name: self.flat.whole(values) for name, values in columns.items()}
        whole["status"] = self.flat.whole(status.astype(np.int8), labels.INVALID_INPUT)
        over = (RECORD, *shape.dims)
        table = xr.Dataset({name: (over, values) for name, values in whole.items()}, shape.coords)
        if self.motions.names is None:
            return table.isel({RECORD: 0})
        return table.assign_coords({RECORD: (RECORD, self.motions.names, {"long_name": "record"})})


def _parameters(structure: Bilinear, cells: int) -> Array:
    """Parameters (cells, 4) of structures in a row; elastic ones have no yield displacement."""
    values = {"hardening": 1.0, "yield_displacement": np.inf, **structure.cells()}
    names = "period", "damping", "hardening", "yield_displacement"
    rows = np.array([np.broadcast_to(values[name], cells) for name in names])
    rows[0] = 2 * np.pi / rows[0]
    return rows.T
