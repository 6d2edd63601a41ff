"""The verification manual: its page is made of the frozen cases; no number stands in two places.

``manual.md`` here says what comes first and the order of the cases; that of a case, its problem and
how it is solved. In them ``<< T >>`` is a number of ``independent.json``, ``<< T | digits(4) >>``
the same to four digits.
"""

import itertools
from collections.abc import Iterator
from typing import Any, NamedTuple

import jinja2
import numpy as np
import xarray as xr
from answers.frozen import HERE, SCRIPT, Case, kept_independent, verified_answers

PAGE = HERE.parents[1] / "docs" / "manual.md"
ROUNDING = 1e-12  # differences below this are not the same on every machine


class Row(NamedTuple):
    """One number of a case's table."""

    what: str
    theirs: float
    ours: float

    @property
    def difference(self) -> float:
        """Relative."""
        return abs(self.ours - self.theirs) / abs(self.theirs)


def digits(value: float, number: int = 7) -> str:
    """A number to so many significant digits, without the zeros of its end."""
    return f"{float(value):.{number}g}"


def of_difference(value: float) -> str:
    """A relative difference, to one digit."""
    return "rounding" if value < ROUNDING else f"{value:.0e}".replace("e-0", "e-")


def rows(theirs: dict[str, Any], ours: xr.Dataset) -> Iterator[Row]:
    """Every number that the independent way gives, beside the library's."""
    for name, values in theirs.items():
        variable = ours[name]
        what, units = variable.attrs["long_name"], variable.attrs["units"]
        unit = "" if units == "1" else f" [{units}]"
        for at in itertools.product(*map(range, np.shape(values))):
            if np.isnan(np.asarray(values)[at]):
                continue  # a floor that is not there
            place = ", ".join(
                _label(variable, str(dim), n) for dim, n in zip(variable.dims, at, strict=True)
            )
            yield Row(
                f"{what}, {place}{unit}" if place else f"{what}{unit}",
                float(np.asarray(values)[at]),
                float(variable.values[at]),
            )


def _label(variable: xr.DataArray, dim: str, number: int) -> str:
    value = variable[dim].values[number]
    shown = str(value) if isinstance(value, str) else f"{value:g}"
    return f"{dim.replace('_', ' ')} {shown.replace('_', ' ')}"


def section(name: str) -> str:
    """Problem, the independent way, the library's lines, and the table of one case."""
    case, kept = Case.named(name), kept_independent(Case.named(name))
    words = (case.folder / "manual.md").read_text(encoding="utf-8")
    _, _, code = (case.folder / SCRIPT).read_text(encoding="utf-8").split('"""', 2)
    verified = case.verified
    lines = [
        _rendered(words, **kept["numbers"], **kept["answers"]).rstrip(),
        f"\n```py\n{code.strip()}\n```\n",
        f"| | {kept['program']} | stochlin | difference |",
        "|---|---|---|---|",
    ]
    for row in rows(kept["answers"], verified_answers(case)):
        theirs, ours = digits(row.theirs, 9), digits(row.ours, 9)
        lines.append(f"| {row.what} | {theirs} | {ours} | {of_difference(row.difference)} |")
    held = f"`tests/answers/{name}` requires agreement within {of_difference(verified['within'])}"
    return "\n".join([*lines, f"\n{held}:\n{verified['reason']}.\n"])


def summary(name: str) -> str:
    """The row of a case in the table at the top."""
    kept = kept_independent(Case.named(name))
    words = (HERE / name / "manual.md").read_text(encoding="utf-8")
    title = words.splitlines()[0].removeprefix("## ")
    worst = max(row.difference for row in rows(kept["answers"], verified_answers(Case.named(name))))
    return f"| {title} | {kept['program']} | {of_difference(worst)} |"


def page() -> str:
    """The whole page, from what is frozen."""
    return _rendered(
        (HERE / "manual.md").read_text(encoding="utf-8"), section=section, summary=summary
    )


def _rendered(text: str, **names: Any) -> str:
    environment = jinja2.Environment(
        variable_start_string="<<",
        variable_end_string=">>",
        block_start_string="<%",
        block_end_string="%>",
        trim_blocks=True,
        undefined=jinja2.StrictUndefined,
        keep_trailing_newline=True,
    )
    environment.filters["digits"] = digits
    environment.finalize = lambda value: digits(value) if isinstance(value, float) else value
    return environment.from_string(text).render(names)
