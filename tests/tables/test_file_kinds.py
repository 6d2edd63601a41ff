"""Files of other programs, which every reader names, with a way to read them."""

import gzip
import io
import zipfile
from pathlib import Path

import numpy as np
import pytest

import stochlin as sl
from stochlin.files.file_kinds import KINDS_OF_FILES

pytestmark = pytest.mark.oracle

READERS = (
    *(sl.read_record, sl.read_records, sl.read_spectrum, sl.read_hazard),
    *(sl.read_modes, sl.read_pushover, sl.read_case),
)
WORKBOOKS = sl.read_spectrum, sl.read_hazard, sl.read_modes, sl.read_pushover  # which read them
JSON = sl.read_spectrum, sl.read_hazard
HEAD = '<?xml version="1.0" encoding="utf-8"?>\n'


def zipped(name: str) -> bytes:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(name, "1 2 3\n" * 5000)
    return content.getvalue()


def sac(order: str) -> bytes:
    """A file of SAC: 70 numbers, 40 whole numbers, the seventh is the version; texts, samples."""
    whole = np.full(40, -12345, f"{order}i4")
    whole[6] = 6
    numbers = np.full(70, -12345.0, f"{order}f4")
    return numbers.tobytes() + whole.tobytes() + b" " * 192 + np.ones(50, f"{order}f4").tobytes()


def numpy_array() -> bytes:
    content = io.BytesIO()
    np.save(content, np.ones(5))
    return content.getvalue()


FILES = [
    ("a workbook", zipped("xl/workbook.xml")),
    ("JSON", b'\xef\xbb\xbf{"a": 1}'),
    ("a compressed archive", zipped("record.txt")),
    ("a compressed archive", b"7z\xbc\xaf\x27\x1c" + bytes(40)),
    ("miniSEED", b"000001D AAA    HNZ" + bytes(50)),
    ("miniSEED", b"MS\x03" + bytes(50)),
    ("SAC", sac("<")),
    ("SAC", sac(">")),
    ("SAC", gzip.compress(sac("<"), mtime=0)),
    ("NRML of OpenQuake", f'{HEAD}<nrml xmlns="http://openquake.org"></nrml>'.encode()),
    ("a web page", b"<!DOCTYPE html><html></html>"),
    ("XML", f"{HEAD}<quakeml></quakeml>".encode()),
    (
        "a model of SAP2000",
        b'File a.s2k was saved\n \nTABLE:  "MODES"\n   Case=MODAL   Period=0.7\n',
    ),
    ("a model of ETABS", b"$ File a.e2k saved 1/1/2024\n$ PROGRAM INFORMATION\n"),
    ("a PDF", b"%PDF-1.7\n"),
    ("a netCDF or HDF5 file", b"\x89HDF\r\n\x1a\n" + bytes(20)),
    ("a file of MATLAB", b"MATLAB 5.0 MAT-file, Platform: GLNXA64" + bytes(20)),
    ("an array of numpy", numpy_array()),
]


@pytest.mark.parametrize(("title", "content"), FILES)
def test_every_reader_names_the_kind_of_a_file_that_it_does_not_read(
    tmp_path: Path, title, content
):
    path = tmp_path / "file.txt"
    path.write_bytes(content)
    for read in READERS:
        if (title == "JSON" and read in JSON) or (title == "a workbook" and read in WORKBOOKS):
            continue
        zip_of_case = read is sl.read_case and content[:2] == b"\x1f\x8b"  # which is no case file
        with pytest.raises(
            ValueError, match="TOML" if zip_of_case else "is not read here; "
        ) as refused:
            read(path)
        assert zip_of_case or f"file.txt is {title}" in str(refused.value), read


def test_every_known_kind_of_file_has_an_example():
    tried = {title for title, _ in FILES}
    assert all(
        any(kind.title.startswith(title) for title in tried) for kind in KINDS_OF_FILES.values()
    )
