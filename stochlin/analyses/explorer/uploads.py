"""Case files in folders of their own, together with the files that they name and no others."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator, Mapping
from contextlib import suppress
from functools import lru_cache
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

from stochlin.analyses.cases.case import Case, case_of
from stochlin.analyses.cases.files.known import Known
from stochlin.analyses.cases.files.sections import read_sections
from stochlin.analyses.sites.suites import table_rows
from stochlin.analyses.tables.inputs import only_within
from stochlin.analyses.tables.toml import read_toml
from stochlin.kernels.basics.parallel import Progress
from stochlin.messages import DoubtfulInput, brief

LONGEST_NAME = 255  # bytes, of a file on most systems
MOST_FOLDERS = 8  # of which a process keeps the fitted grounds


class Upload(NamedTuple):
    """A case file in a temporary folder: its name and its text."""

    folder: TemporaryDirectory[str]
    name: str
    text: str


def uploaded(files: Mapping[str, bytes]) -> Upload:
    """The case file among these, in a folder with the others; raises a ValueError if there is none.

    ``files`` are the contents of the case file and of the files that it names, by name.
    """
    cases = [name for name in files if name.endswith(".toml")]
    if len(cases) != 1:
        raise ValueError(
            f"{len(cases)} case files are chosen; allowed: one, its name ends in .toml, together with "
            "the files that it names, such as records"
        )
    for name in files:
        _check_name(name)
    folder = TemporaryDirectory()
    path = Path(folder.name) / cases[0]
    try:
        for name, data in files.items():
            (Path(folder.name) / name).write_bytes(data)
        text, tables = read_toml(path)
        _to_subfolders(tables, files, path.parent)
    except (OSError, ValueError) as error:
        folder.cleanup()
        raise ValueError(_without(folder.name, error)) from error
    return Upload(folder, path.name, text)


def of_case(case: Case) -> Upload:
    """The file of a case with copies of all files that it names; they lie in its folder or below it."""
    path, files = Path(os.path.abspath(case.inputs[0])), dict[Path, bytes]()
    for each in (Path(os.path.abspath(each)) for each in case.inputs):
        if not each.is_relative_to(path.parent):
            raise ValueError(
                f"{path.name} names {each}, which is outside of its folder; allowed in the explorer: "
                "files in the folder of the case file, so copy it there"
            )
        within = [file for file in each.iterdir() if file.is_file()] if each.is_dir() else [each]
        files |= {file.relative_to(path.parent): file.read_bytes() for file in within}
    folder = TemporaryDirectory()
    for name, content in files.items():
        copy = Path(folder.name) / name
        copy.parent.mkdir(parents=True, exist_ok=True)
        copy.write_bytes(content)
    return Upload(folder, path.name, path.read_text(encoding="utf-8-sig"))


def read_upload(
    folder: str, name: str, text: str, progress: Progress | None = None
) -> tuple[Case, list[str]]:
    """The case of this text in a folder outside of which nothing is read, and warnings on it.

    Its ground is fitted and scaled, and ``progress`` called with the share of this work that is done.
    Raises the errors of `read_case`.
    """
    path = Path(folder) / name
    with only_within(path.parent), warnings.catch_warnings(record=True) as doubts:
        warnings.simplefilter("always", DoubtfulInput)
        try:
            path.write_text(text, encoding="utf-8")
            case = case_of(read_sections(path), path, _known(folder))
            if case.of_site.waits:
                case.of_site.settled(progress)
        except (OSError, ValueError) as error:
            raise ValueError(_without(folder, error)) from error
    return case, [str(doubt.message) for doubt in doubts]


@lru_cache(MOST_FOLDERS)
def _known(folder: str) -> Known:
    """What is known of the files in a folder, which stay as they are."""
    return Known()


def _check_name(name: str) -> None:
    """Raise a ValueError unless an uploaded file can be kept under its name."""
    if name.strip(".") and not set(name) & {"/", "\\", "\0"} and len(name.encode()) <= LONGEST_NAME:
        return
    raise ValueError(
        f"the file name {brief(name)} cannot be used; allowed: a name of 1 to {LONGEST_NAME} bytes, not "
        "of dots alone, and without slashes; rename the file, and choose it again"
    )


def _without(folder: str, error: Exception) -> str:
    """Message of an error without the path of the temporary folder."""
    message = str(error).replace(f"{folder}{os.sep}", "")
    absent = isinstance(error.__cause__, FileNotFoundError)
    return (
        f"{message}; choose the case file together with the files that it names" if absent else message
    )


def _to_subfolders(tables: Mapping[str, Any], files: Mapping[str, bytes], folder: Path) -> None:
    """Move uploaded files to the subfolders of ``folder`` where the case looks for them."""
    for text in {*_texts(tables), *_of_tables(files)}:
        chosen, there = folder / PurePosixPath(text).name, folder / text
        inside = ".." not in there.parts and len(there.parts) < 100 and there.is_relative_to(folder)
        if inside and there.name in files and not there.exists():
            there.parent.mkdir(parents=True, exist_ok=True)
            chosen.rename(there)


def _texts(values: Any) -> Iterator[str]:
    """All texts in nested tables and lists."""
    if isinstance(values, str):
        yield values
    elif isinstance(values, (dict, list)):
        for value in values.values() if isinstance(values, dict) else values:
            yield from _texts(value)


def _of_tables(files: Mapping[str, bytes]) -> Iterator[str]:
    """Names of the files in tables of records."""
    for name, content in files.items():
        with suppress(ValueError):  # it is no table of records
            yield from (row[1] for row in table_rows(content.decode("utf-8-sig", "replace"), name))
