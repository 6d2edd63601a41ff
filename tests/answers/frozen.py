"""Frozen answers: what a case gives now beside what it gave before, number by number.

Every folder here with an ``about.toml`` is a case, as a user would have it:

``about.toml``      why it is kept; the ``commands``, if it has some; the tolerance and its reason
``case.py``         otherwise: a script
other files         what it reads: case files, records made for it
``expected/``       what it wrote, and in ``screen.txt`` what it printed
``independent.py``  for the verification manual: the same by hand or by another program
``independent.json``, ``manual.md``  the numbers that gave, and the words of the manual

Variables, and rules and other things with names along a dimension, are compared by their names: one
more is no difference, nor what texts say of an extension that was not known before.

Pictures are drawn, and not compared. The oldest and latest versions that reasons of tolerances
speak of are numpy 2.1.0, scipy 1.15.0, numba 0.61.0 and xarray 2025.11.0 on Python 3.11, and 2.5.5,
1.18.1, 0.68.1 and 2026.9.0 on Python 3.13, both on one x86-64 processor.
"""

from __future__ import annotations

import contextlib
import csv
import io
import json
import re
import runpy
import shlex
import shutil
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from click.testing import CliRunner

from stochlin.models.contacts.elements import CONTACTS
from stochlin.models.envelopes import ENVELOPES
from stochlin.models.grounds import GROUNDS
from stochlin.models.laws import LAWS
from stochlin.models.rules.codes import CODE_RULES
from stochlin.models.rules.effective_properties import EFFECTIVE_RULES
from stochlin.models.rules.peak_factors import PEAK_FACTORS
from stochlin.views.command import main
from stochlin.views.shared.progress import COMPILING
from stochlin.views.shared.screen import COMMANDS

RULES = CODE_RULES, EFFECTIVE_RULES, PEAK_FACTORS
HERE = Path(__file__).parent
CASES = sorted(path.parent.name for path in HERE.glob("*/about.toml"))
EXPECTED, SCREEN = "expected", "screen.txt"
SCRIPT, INDEPENDENT, FROZEN = "case.py", "independent.py", "independent.json"
OWN = (EXPECTED, INDEPENDENT, FROZEN, "about.toml", "manual.md", "__pycache__")
COMPARED = {".nc", ".csv", ".txt"}
CHANGING = {"stochlin_version", "code"}  # attributes that change with the library's own text
RELEASE = re.compile(r"^stochlin [\w.]+: ")  # at the beginning of the history
NUMBER = re.compile(r"(?<![\w.])([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)")


@dataclass(frozen=True)
class Tolerance:
    """How far numbers may move: by a share of themselves, the variable's largest, or by so much."""

    reason: str
    relative: float = 0.0
    of_largest: float = 0.0
    absolute: float = 0.0
    variables: tuple[str, ...] = ()  # that it is for, or words of a line; none: all others

    def allowed(self, old: Any) -> Any:
        """For each number of a variable."""
        sizes = np.abs(old, dtype=float)
        largest = np.max(sizes[np.isfinite(sizes)], initial=0.0)
        return self.absolute + self.relative * sizes + self.of_largest * largest


@dataclass(frozen=True)
class Case:
    """What ``about.toml`` says."""

    folder: Path
    why: str
    tolerance: Tolerance
    others: tuple[Tolerance, ...] = ()
    commands: tuple[str, ...] = ()
    verified: Mapping[str, Any] = field(default_factory=dict)

    @classmethod
    def named(cls, name: str) -> Case:
        """The case in the folder of this name."""
        about = tomllib.loads((HERE / name / "about.toml").read_text(encoding="utf-8"))
        others = tuple(
            Tolerance(**each | {"variables": tuple(each["variables"])})
            for each in about.pop("others", ())
        )
        about["tolerance"] = Tolerance(**about["tolerance"])
        return cls(HERE / name, **about | {"others": others})

    def tolerance_of(self, variable: str) -> Tolerance:
        """The one that is stated for it, or the case's."""
        return next((each for each in self.others if variable in each.variables), self.tolerance)

    def tolerance_of_text(self, number: str, line: str) -> Tolerance:
        """The one that is stated for words of the line; counts exactly; else the case's."""
        for each in self.others:
            if any(
                re.search(rf"(?<!\w){re.escape(words)}(?!\w)", line) for words in each.variables
            ):
                return each
        return Tolerance("a count") if re.fullmatch(r"[-+]?\d+", number) else self.tolerance


@dataclass(frozen=True)
class Difference:
    """Between the old and the new of one variable, line or attribute, where it is largest."""

    place: str
    old: str
    new: str
    relative: float = np.inf
    share: float = np.inf  # of what is allowed

    @property
    def moved(self) -> bool:
        """Whether it is more than the tolerance."""
        return not self.share <= 1

    def __str__(self) -> str:
        change = f"{self.relative:.1e}" if np.isfinite(self.relative) else "other"
        return f"{self.place}: {change}, {self.old} -> {self.new}"


def run(case: Case, scratch: Path) -> Path:
    """Do what the user does, in a copy of the folder; where the results are."""
    work, results = scratch / case.folder.name, scratch / f"{case.folder.name} results"
    shutil.copytree(case.folder, work, ignore=shutil.ignore_patterns(*OWN))
    inputs = {path.name for path in work.iterdir()}
    with contextlib.chdir(work):
        screen = "".join(map(_told, case.commands)) if case.commands else _printed(Path(SCRIPT))
    results.mkdir()
    for path in work.iterdir():
        if path.suffix in COMPARED and path.name not in inputs:
            shutil.copy(path, results)
    if screen:
        (results / SCREEN).write_text(screen, encoding="utf-8")
    return results


def _told(line: str) -> str:
    """A command and what the screen says."""
    program, *arguments = shlex.split(line)
    assert program == "stochlin", line
    done = CliRunner().invoke(main, arguments)
    if done.exception and not isinstance(done.exception, SystemExit):
        raise done.exception
    status = f"exit status {done.exit_code}\n" if done.exit_code else ""
    output = done.output.replace(f"{COMPILING}\n", "")  # it depends on what was compiled before
    return f"$ {line}\n{output}{status}\n"


def _printed(script: Path) -> str:
    with contextlib.redirect_stdout(io.StringIO()) as screen:
        runpy.run_path(str(script), run_name="__main__")
    return screen.getvalue()


def contents(folder: Path, before: Path | None = None) -> dict[str, Any]:
    """Arrays of floats, and all else as text, by its place in the files of a folder.

    Of the variables and names of its tables only those that tables in the folder ``before`` have.
    """
    parts: dict[str, Any] = {}
    for path in folder.glob("*"):
        kept = before / path.name if before is not None and (before / path.name).exists() else path
        if path.suffix == ".csv":
            parts[path.name] = _with_columns_of(*(each.read_text("utf-8") for each in (kept, path)))
            continue
        if path.suffix != ".nc":
            parts[path.name] = path.read_text(encoding="utf-8")
            continue
        table = xr.load_dataset(path)
        if kept != path:
            table = _with_names_of(xr.load_dataset(kept), table)
        attributes = {path.name: table.attrs}
        for name, variable in table.variables.items():
            place, kind = f"{path.name} {name}", variable.dtype.kind
            attributes[place] = variable.attrs | {"shape": f"{kind} {dict(variable.sizes)}"}
            parts[place] = (
                variable.values if kind == "f" else "\n".join(map(str, variable.values.flat))
            )
        for place, values in attributes.items():
            known = {key: str(value) for key, value in values.items() if key not in CHANGING}
            parts |= {f"{place}, {key}": RELEASE.sub("", text) for key, text in known.items()}
    return parts


def _with_columns_of(old: str, new: str) -> str:
    """The rows of the new file, with the columns of the old one, without quotation marks."""
    titles, *rows = csv.reader(new.splitlines())
    known = next(csv.reader(old.splitlines()))
    columns = [n for n, title in enumerate(titles) if title in known]
    return "\n".join(",".join(row[n] for n in columns if n < len(row)) for row in (titles, *rows))


def _with_names_of(old: xr.Dataset, new: xr.Dataset) -> xr.Dataset:
    """The new table with the variables of the old one, and its names along each dimension."""
    for name in new.indexes.keys() & old.indexes.keys():
        if new[name].dtype.kind in "UO":
            new = new.sel({name: new[name].isin(old[name])})
    return new.drop_vars(new.variables.keys() - old.variables.keys())


def registered_texts() -> list[str]:
    """Names of all extensions, and titles and references of rules, the longest first."""
    rules = [rule for registry in RULES for rule in registry.values()]
    texts = {text for rule in rules for text in (rule.title, rule.reference, rule.describe())}
    texts |= {
        name
        for registry in (*RULES, COMMANDS, CONTACTS, ENVELOPES, GROUNDS, LAWS)
        for name in registry
    }
    texts |= {f"eq_3_{name}" for name in EFFECTIVE_RULES}  # of the gap by its properties
    return sorted(filter(None, texts), key=len, reverse=True)


def without_new_extensions(old: str, new: str) -> str:
    """A text without what it says of extensions of which the old one does not speak."""
    texts = [text for text in registered_texts() if text in new and text not in old]
    lines = {" ".join(line.split()) for line in old.splitlines()}
    known = []
    for line in new.splitlines():
        shorter = line
        for text in texts:
            shorter = re.sub(rf"(?<!\w)['\"]?{re.escape(text)}['\"]?(?!\w)(?:[,;] )?", "", shorter)
        if shorter == line:
            known.append(line)
            continue
        shorter = re.sub(r"[,;] ?$", "", shorter)
        if " ".join(shorter.split()) in lines:  # else it is about them alone
            known.append(shorter)
    return "\n".join(known) + "\n" * new.endswith("\n") if texts else new


def differences(case: Case, results: Path) -> Iterator[Difference]:
    """Of all files, between those that are kept and these; none where they are the same."""
    old = contents(case.folder / EXPECTED)
    new = contents(results, before=case.folder / EXPECTED)
    for place in sorted(old | new):
        if place not in old or place not in new:
            yield Difference(
                place, *("there" if place in side else "missing" for side in (old, new))
            )
        elif isinstance(old[place], str) and isinstance(new[place], str):
            now = without_new_extensions(old[place], new[place])
            yield from _of_texts(case, place, old[place], now)
        elif np.shape(old[place]) == np.shape(new[place]):  # else the shapes are shown
            tolerance = case.tolerance_of(place.rpartition(" ")[2])
            yield from _of_numbers(place, old[place], new[place], tolerance)


def _of_numbers(place: str, old: Any, new: Any, tolerance: Tolerance) -> Iterator[Difference]:
    with np.errstate(invalid="ignore", divide="ignore"):
        apart = np.where((old == new) | (np.isnan(old) & np.isnan(new)), 0.0, np.abs(new - old))
        share = np.where(apart == 0, 0.0, apart / tolerance.allowed(old))
        share[np.isnan(share)] = np.inf  # one of them is no number
        relative = apart / np.abs(old)
    if share.size and share.max() > 0:
        at = np.unravel_index(np.argmax(share), share.shape)
        values = (f"{side[at]:.10g}" for side in (old, new))
        yield Difference(place, *values, float(relative[at]), float(share[at]))


def _of_texts(case: Case, place: str, old: str, new: str) -> Iterator[Difference]:
    """Words exactly, numbers by the tolerance; the width of columns is left to other tests."""
    before, now = old.splitlines(), new.splitlines()
    for number in range(max(len(before), len(now))):
        a, b = (side[number] if number < len(side) else "no line" for side in (before, now))
        if a.split() == b.split():
            continue
        at = f"{place}, line {number + 1}" if len(before) > 1 else place
        (words_a, numbers_a), (words_b, numbers_b) = _taken_apart(a), _taken_apart(b)
        if words_a != words_b:
            yield Difference(at, a.strip(), b.strip())
            if len(before) != len(now):
                return  # what follows has another place
            continue
        for each, other in zip(numbers_a, numbers_b, strict=True):
            tolerance = case.tolerance_of_text(each, f"{place} {a}")
            yield from _of_numbers(at, np.array([float(each)]), np.array([float(other)]), tolerance)


def _taken_apart(line: str) -> tuple[list[str], list[str]]:
    parts = NUMBER.split(line)
    return "\0".join(parts[::2]).split(), parts[1::2]


def independent(case: Case) -> dict[str, Any]:
    """What ``independent.py`` of a case finds now; ImportError if its program is not installed."""
    try:
        answer = runpy.run_path(str(case.folder / INDEPENDENT))
    except RuntimeError as error:  # OpenSeesPy without its libraries
        raise ImportError(str(error)) from error
    numbers = {kind.lower(): _as_lists(answer[kind]) for kind in ("ANSWERS", "NUMBERS")}
    return {"program": answer["PROGRAM"], **numbers}


def moved_independent(case: Case, now: Mapping[str, Any]) -> list[str]:
    """The numbers that are not within the tolerance of what ``independent.py`` found before."""
    before = kept_independent(case)
    return [
        name
        for kind in ("answers", "numbers")
        for name in before[kind] | now[kind]
        if name not in before[kind]
        or name not in now[kind]
        or not largest(now[kind][name], before[kind][name]) <= case.verified["within"]
    ]


def _as_lists(numbers: Mapping[str, Any]) -> dict[str, Any]:
    return {name: np.asarray(value, dtype=float).tolist() for name, value in numbers.items()}


def kept_independent(case: Case) -> dict[str, Any]:
    """What it found when it was frozen."""
    return json.loads((case.folder / FROZEN).read_text(encoding="utf-8"))


def verified_answers(case: Case) -> xr.Dataset:
    """The frozen answer that the manual is about."""
    return xr.load_dataset(case.folder / EXPECTED / "answer.nc")


def largest(values: Any, others: Any) -> float:
    """Largest relative difference; none if both are no numbers, NaN if one is or shapes differ."""
    values, others = np.asarray(values, dtype=float), np.asarray(others, dtype=float)
    if values.shape != others.shape:
        return np.nan
    apart = np.where(
        np.isnan(values) & np.isnan(others), 0.0, np.abs(values - others) / np.abs(others)
    )
    return float(np.max(apart))
