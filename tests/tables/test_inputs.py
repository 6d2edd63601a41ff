"""What is read of files that a user or a case file names, and what is refused, by what it is."""

import os
import re
import socket
from pathlib import Path

import pytest
from uploads import open_case

import stochlin as sl
from stochlin.files.inputs import MOST_BYTES, MOST_LINES_OF_TEXT, only_within

pytestmark = pytest.mark.invariant

READERS = {
    "record": lambda path: sl.read_record(path, units="g", dt=0.01),
    "spectrum": lambda path: sl.read_spectrum(path, units="g", elastic=True),
    "hazard": lambda path: sl.read_hazard(path, units="g"),
    "pushover": lambda path: sl.read_pushover(path, length_units="mm", force_units="kN"),
    "suite": lambda path: sl.read_records(path, units="g", dt=0.01),
    "case": sl.read_case,
}
of_any_reader = pytest.mark.parametrize("read", READERS.values(), ids=list(READERS))
SECRET = "root:0"


@of_any_reader
@pytest.mark.parametrize("device", ["zero", "full", "urandom", "null", "tty"])
@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="this system has no such devices")
def test_devices_are_refused(read, device):
    with pytest.raises(
        ValueError, match=f"{device} is a device or a pipe; allowed: a regular file"
    ):
        read(f"/dev/{device}")


@of_any_reader
def test_folders_are_refused_and_pipes_and_sockets_too(read, tmp_path):
    if read is not READERS["suite"]:
        with pytest.raises(ValueError, match="is a folder; allowed: a regular file"):
            read(tmp_path)
    os.mkfifo(tmp_path / "pipe.csv")
    with pytest.raises(
        ValueError, match=r"pipe\.csv is a device or a pipe; allowed: a regular file"
    ):
        read(tmp_path / "pipe.csv")
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind(str(tmp_path / "s"))
        with pytest.raises(ValueError, match="s is a device or a pipe; allowed: a regular file"):
            read(tmp_path / "s")


@of_any_reader
@pytest.mark.parametrize("address", ["https://example.org/a.at2", "file:///etc/passwd", "s3://a/b"])
def test_addresses_are_refused(read, address):
    with pytest.raises(
        ValueError, match="is an address on a network; allowed: a file on this computer"
    ):
        read(address)


@of_any_reader
def test_a_file_is_read_up_to_a_size_that_the_message_names(read, tmp_path):
    large = tmp_path / "large.csv"
    with large.open("wb") as file:
        file.truncate(MOST_BYTES + 1)
    with pytest.raises(ValueError, match=rf"{MOST_BYTES + 1} bytes or more; allowed: \d+ bytes"):
        read(large)
    lines = tmp_path / "lines.csv"
    lines.write_bytes(b"\n" * 10_000_000)
    with pytest.raises(
        ValueError, match=f"10000000 (lines; allowed: {MOST_LINES_OF_TEXT}|bytes or more)"
    ):
        read(lines)


def site_of(kind: str, path: str) -> str:
    """A site that names a file of each kind."""
    ground, intensity = 'ground = "firm"\n', 'intensity = "0.01 m^2/s^3"\n'
    return {
        "record": f'[site]\n{ground}{intensity}[[site.records]]\npath = "{path}"\nunits = "g"\n',
        "suite": f'[site]\n{ground}{intensity}[site.suite]\npath = "{path}"\n',
        "spectrum": f'[site]\nspectrum = "{path}"\nelastic = true\nunits = "g"\n',
        "hazard": f'[site]\n{ground}return_period = "475 yr"\n[site.hazard]\nmeasure = "pga"\n'
        f'file = "{path}"\nunits = "g"\n',
    }[kind]


KINDS = ("record", "suite", "spectrum", "hazard")
REST = """[motion]
duration = "10 s"
[separation]
confidence = 0.9
[building_1]
period = "1 s"
damping = 0.05
elastic = true
"""


def refusal(files: dict[str, bytes]) -> str:
    """Why an uploaded case is not opened."""
    with pytest.raises(ValueError, match=r"^case.toml, line \d+: ") as told:
        open_case(files)
    assert not re.search(r"/tmp\w{8}", str(told.value)), "the temporary folder of the files"
    return str(told.value)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", ["secret.dat", "SECRET.CSV", "secret", "none.txt"])
def test_an_uploaded_case_reads_no_file_outside_of_its_folder(kind, name, tmp_path, monkeypatch):
    """Whether it is there or not: the answer is the same."""
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    (tmp_path / "below").mkdir()
    for there in ("secret.dat", "SECRET.CSV", "secret"):
        (tmp_path / there).write_text(f"{SECRET}\n" * 7, encoding="utf-8")
    for path in (
        f"../{name}",
        f"x/../../{name}",
        f"below/../../{name}",
        (tmp_path / name).as_posix(),
    ):
        case = {"case.toml": (site_of(kind, path) + REST).encode()}
        message = refusal(case | {"x": b""})
        assert re.search(
            "is outside of the folder|there is no such file|is neither a (folder|code)", message
        )
        assert SECRET not in message


@pytest.mark.parametrize("table", ["suite.csv", "suite.CSV", "suite.txt", "suite"])
@pytest.mark.parametrize(
    "row", ["../secret.dat", "{folder}/secret.dat", "/dev/zero", "/etc/passwd"]
)
def test_tables_of_any_name_list_files_of_the_folder_alone(table, row, tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    (tmp_path / "secret.dat").write_text(f"{SECRET}\n", encoding="utf-8")
    rows = f"file,dt,units\n{row.format(folder=tmp_path)},0.01,g\n"
    case = {"case.toml": (site_of("suite", table) + REST).encode(), table: rows.encode()}
    assert f"{table}, line 2" in refusal(case)
    assert "is outside of the folder of the case file" in refusal(case)


def test_links_are_followed_before_a_path_is_allowed(tmp_path):
    inside = tmp_path / "inside"
    inside.mkdir()
    (tmp_path / "secret.dat").write_text("0.1\n" * 16, encoding="utf-8")
    (inside / "link.dat").symlink_to(tmp_path / "secret.dat")
    (inside / "own.dat").write_text("0.1\n" * 16, encoding="utf-8")
    (inside / "up").symlink_to(tmp_path)
    read = READERS["record"]
    assert read(inside / "link.dat").size == 16  # a user's own links lead anywhere
    with only_within(inside):
        assert read(inside / "own.dat").size == 16
        for path in ("link.dat", "up/secret.dat", "up/inside/../secret.dat"):
            with pytest.raises(ValueError, match="is outside of the folder"):
                read(inside / path)
        with pytest.raises(ValueError, match="is outside of the folder"):
            READERS["suite"](inside)
        with pytest.raises(ValueError, match="is outside of the folder"):
            READERS["suite"](inside / "up")
    assert read(inside / "link.dat").size == 16
