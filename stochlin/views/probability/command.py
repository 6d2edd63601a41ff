"""The command ``stochlin probability``: a case file in; how likely pounding is, printed and drawn."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from stochlin.views.shared.screen import FILE, PICTURES, bad_input, check_target

if TYPE_CHECKING:
    import xarray as xr

    from stochlin.analyses.cases.case import Case

ROWS = 11  # instants that are printed
COLUMNS = (
    ("formula", ""),
    ("Poisson", "_poisson"),
    ("corrected", "_corrected"),
    ("simulated", "_simulated"),
)


@click.command()
@click.argument("case", type=FILE)
@click.option("--gap", type=float, help="Gap [m], instead of the existing one of the file.")
@click.option("--out", type=FILE, help="Save the table, .nc or .csv.")
@click.option("--picture", type=FILE, help="Draw it: .png, .svg or .pdf.")
def probability(case: Path, gap: float | None, out: Path | None, picture: Path | None) -> None:
    """How likely two buildings are to pound in a finite earthquake, over time.

    CASE is a file as 'stochlin gap --example' prints one. Records in it are each judged by the hybrid
    method: radii of the record, random phase.

    \b
    Examples:
      stochlin probability case.toml
      stochlin probability case.toml --gap .08 --picture probability.png --out probability.nc
    """
    from stochlin.analyses.cases.case import read_case
    from stochlin.analyses.tables.storage import FORMATS, save_table

    with bad_input():
        check_target("--out", out, FORMATS)
        check_target("--picture", picture, PICTURES)
        described = read_case(case)
        chosen = described.gap if gap is None else gap
        if chosen is None:
            raise ValueError(
                f"{described.file} states no existing gap; give it there, or --gap in metres"
            )
        table = _finite(described, chosen)
        for line in _lines(described, chosen, table):
            click.echo(line)
        if out is not None:
            save_table(table, out)
            click.echo(f"saved {out}")
        if picture is not None:
            from stochlin.views.charts.charts import save
            from stochlin.views.probability.pictures import draw_pounding

            save(draw_pounding(table), picture)
            click.echo(f"saved {picture}")


def _finite(case: Case, gap: float) -> xr.Dataset:
    from stochlin.analyses.probability.probability import pounding_probability

    with click.progressbar(length=1000, label="simulating", file=sys.stderr) as bar:
        return pounding_probability(
            case.first.structure,
            case.second.structure,
            case.ground,
            gap,
            envelope=case.envelope,
            duration=case.duration,
            confidence=case.confidence,
            paths=case.paths,
            seed=case.seed,
            progress=lambda share: bar.update(int(1000 * share) - bar.pos),
        )


def _lines(case: Case, gap: float, table: xr.Dataset) -> list[str]:
    stem = "confidence_of_no_pounding"
    lines = [
        case.title,
        f"{case.first.name} (left) and {case.second.name}, gap {gap:.4g} m, {case.duration:.4g} s",
        "",
        "Confidence of no pounding so far",
        f"{'time [s]':>9}" + "".join(f"{name:>11}" for name, _ in COLUMNS) + f"{'95 % interval':>20}",
    ]
    step = max(1, (table.sizes["time"] - 1) // (ROWS - 1))
    for index in range(0, table.sizes["time"], step):
        row = table.isel(time=index)
        values = "".join(_number(row[stem + ending], 11) for _, ending in COLUMNS)
        low, high = (float(row[f"{stem}_simulated_{end}"]) for end in ("lower", "upper"))
        lines.append(f"{float(row.time):9.2f}{values}{low:12.4f} -{high:6.4f}")
    lines += [
        "",
        f"Gap for a confidence of {case.confidence:g}: {float(table.required_gap):.4f} m by formula, "
        f"{_corrected(table)}, "
        f"{float(table.required_gap_simulated):.4f} m simulated "
        f"({float(table.required_gap_simulated_lower):.4f} - "
        f"{float(table.required_gap_simulated_upper):.4f})",
    ]
    if bool(table.permanent_set.any()) and (case.first.structure.yields or case.second.structure.yields):
        end = table.attrs["strong_shaking_end_s"]
        lines.append(f"After {end:.3g} s the formula has lost the permanent set of yielding buildings.")
    lines += [_record_line(case, gap, name, record) for name, record in case.records.items()]
    if "comment" in table.attrs:
        lines.append(table.attrs["comment"].replace("α", "hardening").replace("≤", "<="))
    return lines


def _corrected(table: xr.Dataset) -> str:
    known = bool(table.required_gap_corrected.notnull())
    return f"{float(table.required_gap_corrected):.4f} m corrected" if known else "correction unknown"


def _number(value: xr.DataArray, width: int) -> str:
    """Four decimals; where the map of the bias does not reach, a word."""
    return f"{'unknown':>{width}}" if bool(value.isnull()) else f"{float(value):{width}.4f}"


def _record_line(case: Case, gap: float, name: str, record: xr.DataArray) -> str:
    from stochlin.analyses.probability.probability import pounding_probability

    table = pounding_probability(
        case.first.structure,
        case.second.structure,
        case.ground,
        gap,
        method="hybrid",
        record=record,
        confidence=case.confidence,
    )
    last = table.isel(time=-1)
    return (
        f"Record {name}: confidence {float(last.confidence_of_no_pounding):.4f} with one phase, "
        f"{float(last.confidence_of_no_pounding_fresh_phase):.4f} with a new one every cycle "
        f"(rho {float(table.rho):.3f}); the record itself takes {float(table.separation):.4f} m"
    )
