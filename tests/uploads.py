"""Case files uploaded to the explorer, read as it reads them."""

from __future__ import annotations

from collections.abc import Mapping

from stochlin.applications.cases.reading.case import Case
from stochlin.applications.explorer.uploads import read_upload, uploaded


def open_case(files: Mapping[str, bytes]) -> tuple[Case, list[str]]:
    """The case among these files, and warnings on it; the temporary folder is gone afterwards."""
    upload = uploaded(files)
    try:
        return read_upload(upload.folder, upload.name, upload.text)
    finally:
        upload.remove()
