"""Case files in folders of their own, together with the files that they name and no others."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path, PurePath
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import xarray as xr

from stochlin.applications.cases.reading.case import Case, case_of, read_case
from stochlin.applications.cases.reading.site import CaseSite
from stochlin.applications.cases.reading.tables import read_table
from stochlin.files.inputs import only_within
from stochlin.files.toml import read_toml
from stochlin.messages import DoubtfulInput


class Fitted(NamedTuple):
    """A site with its ground, the values that it was read from, and warnings on the ground."""

    values: Sequence[Any]
    site: CaseSite
    doubts: Sequence[str]

    def is_of(self, values: Sequence[Any], site: CaseSite) -> bool:
        """Whether a site has these values and the same content of all files that they name."""
        mine = {**self.site.records, "spectrum": self.site.spectrum, "hazard": self.site.hazard}
        others = {**site.records, "spectrum": site.spectrum, "hazard": site.hazard}
        same_files = mine.keys() == others.keys() and all(_same(mine[n], others[n]) for n in mine)
        return self.values == values and same_files


def _same(content: Any, other: Any) -> bool:
    """Whether two records, spectra or hazards are the same."""
    if isinstance(content, xr.DataArray) and isinstance(other, xr.DataArray):
        return content.identical(other)
    return type(content) is type(other) and bool(content == other)


_LAST_FITTED: list[Fitted] = []  # at most one


class Upload(NamedTuple):
    """A case file by its name and its text, and the folder of the files that it names."""

    folder: str
    name: str
    text: str
    temporary: TemporaryDirectory[str] | None = None  # the folder, if it is to be removed

    def remove(self) -> None:
        """Remove a temporary folder."""
        if self.temporary is not None:
            self.temporary.cleanup()


def uploaded(files: Mapping[str, bytes]) -> Upload:
    """The case file among these, in a folder with the others; raises a ValueError if there is none.

    ``files`` are the contents of the case file and of the files that it names, by name.
    """
    cases = [name for name in files if name.endswith(".toml")]
    if len(cases) != 1:
        what = f"{len(cases)} case files are chosen"
        raise ValueError(f"{what}; allowed: one .toml, together with the files that it names")
    folder = TemporaryDirectory()
    try:
        paths = {name: Path(folder.name).resolve() / PurePath(name).name for name in files}
        for name, path in paths.items():
            path.write_bytes(files[name])
        text, _ = read_toml(paths[cases[0]])
    except (OSError, ValueError) as error:
        folder.cleanup()
        raise ValueError(_without(folder.name, error)) from error
    return Upload(folder.name, PurePath(cases[0]).name, text, folder)


def of_file(path: Path) -> Upload:
    """A case file in its own folder; the files that it names must lie there or below."""
    folder = path.resolve().parent
    with only_within(folder):
        read_case(path)
    return Upload(str(folder), path.name, read_toml(path)[0])


def read_upload(folder: str, name: str, text: str) -> tuple[Case, list[str]]:
    """The case of this text in a folder outside of which nothing is read, and warnings on it.

    Its ground is fitted and scaled, unless it is that of the last text: with the same values of
    site and motion and the same content of all files.
    """
    path = Path(folder) / name
    with only_within(path.parent), warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", DoubtfulInput)
        try:
            case = case_of(read_table(path, text))
            values = path, case.whole.site.values, case.whole.motion.values
            if not (_LAST_FITTED and _LAST_FITTED[0].is_of(values, case.site)):
                before = len(caught)
                _ = case.site.ground
                texts = [str(warning.message) for warning in caught[before:]]
                _LAST_FITTED[:] = [Fitted(values, case.site, texts)]
        except (OSError, ValueError) as error:
            raise ValueError(_without(folder, error)) from error
    fitted = _LAST_FITTED[0]
    doubts = dict.fromkeys([*(str(warning.message) for warning in caught), *fitted.doubts])
    return replace(case, site=fitted.site), [*doubts]


def _without(folder: str, error: Exception) -> str:
    """Message of an error without the path of the temporary folder."""
    message = str(error).replace(f"{folder}{os.sep}", "").replace(folder, "")
    absent = isinstance(error.__cause__, FileNotFoundError)
    return (
        f"{message}; choose the case file together with the files that it names"
        if absent
        else message
    )
