"""Case files that name files of all kinds: those of their folder are read, nothing else is opened."""

import os
import socket
import sys
import time
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from uploads import open_case

pytestmark = [pytest.mark.invariant, pytest.mark.slow]

TIMES = int(os.environ.get("FUZZ_TIMES", "1"))
SECRET = "7.25,0.125\n"  # numbers, so that it would be read as a table of anything
GROUND = 'ground = "firm"\n'
STRONG = 'intensity = "0.01 m^2/s^3"\n'
SITES = (
    f'{GROUND}{STRONG}[[site.records]]\nunits = "g"\npath = PATH',
    f"{GROUND}{STRONG}[site.suite]\npath = PATH",
    f'{GROUND}{STRONG}[site.suite]\nskip_unreadable = true\nunits = "g"\npath = PATH',
    'units = "g"\nspectrum = PATH',
    f'{GROUND}return_period = "475 yr"\n[site.hazard]\nmeasure = "pga"\nunits = "g"\nfile = PATH',
)
WORDS = (
    ".. . secret.dat SECRET.CSV secret pipe.csv socket folder own.dat own.TXT suite.csv suite.TXT suite"
)
WORDS += " case.toml link zero urandom fd \u202e " + "a" * 300
PARTS = st.sampled_from(WORDS.split())
STARTS = st.sampled_from(
    ["", "", "", "/", "/dev/", "/proc/self/", "//", "~/", "https://", "{folder}/", "C:\\"]
)
PATHS = st.builds(
    lambda start, parts: start + "/".join(parts), STARTS, st.lists(PARTS, min_size=1, max_size=4)
)


class Watch:
    """An audit hook, which stays for good: what is opened or listed while somebody asks."""

    def __init__(self) -> None:
        self.names: list[str] | None = None

    def __call__(self, event: str, arguments: tuple[object, ...]) -> None:
        """Note a name."""
        if self.names is not None and event in ("open", "os.listdir", "os.scandir"):
            name = arguments[0]
            self.names.append(os.fspath(name) if isinstance(name, (str, os.PathLike)) else "")


WATCH = Watch()
sys.addaudithook(WATCH)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Where the temporary folders of uploads lie, among files that are nobody's business."""
    root = tmp_path_factory.mktemp("root")
    for name in ("secret.dat", "SECRET.CSV", "secret", "folder/secret.dat", "suite.csv"):
        (root / name).parent.mkdir(exist_ok=True)
        (root / name).write_text(SECRET * 40, encoding="utf-8")
    os.mkfifo(root / "pipe.csv")
    (root / "link").symlink_to("/etc/passwd")
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind(str(root / "socket"))
        yield root


@settings(
    max_examples=200 * TIMES, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(site=st.sampled_from(SITES), path=PATHS, rows=st.lists(PATHS, max_size=3), table=PARTS)
def test_an_upload_opens_nothing_outside_of_its_folder(folder, monkeypatch, site, path, rows, table):
    monkeypatch.setattr("tempfile.tempdir", str(folder))
    path, *rows = (text.replace("{folder}", folder.as_posix()) for text in (path, *rows))
    as_text = '"' + path.replace("\\", "\\\\") + '"'
    case = f'[site]\n{site.replace("PATH", as_text)}\n[motion]\nduration = "5 s"\n[separation]\n'
    files = {"case.toml": case.encode(), "own.dat": SECRET.encode() * 40, "own.TXT": b"", "link": b"x"}
    if "." in table and not table.startswith(("case", "..")) and table != ".":
        files[table] = "\n".join(["file,dt,units", *(f"{row},0.01,g" for row in rows)]).encode()
    began, WATCH.names = time.process_time(), []
    try:
        with pytest.raises(ValueError) as told:  # noqa: PT011 (the buildings are missing in any case)
            open_case(files)
    finally:
        opened, WATCH.names = WATCH.names, None
    assert time.process_time() - began < 5
    assert SECRET.strip() not in str(told.value)
    libraries = (*map(os.path.realpath, sys.path), sys.prefix, sys.base_prefix)
    for name in filter(None, opened):
        where = os.path.realpath(name)
        own = Path(where).is_relative_to(folder) and Path(where).relative_to(folder).parts[:1]
        allowed = own[0].startswith("tmp") if own else where.startswith(tuple(filter(None, libraries)))
        assert allowed or where == str(folder), f"{name} was opened for {path}, {rows}"
