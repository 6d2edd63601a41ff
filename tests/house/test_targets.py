"""What commands write: never over what they read, through links, and refused before any work."""

import errno
import os
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from cases import recorded_example
from commands import answered, invoke, refused

from stochlin.files.folders import mark
from stochlin.files.storage import save_table, whole_file

pytestmark = pytest.mark.cli

SAYS = "would overwrite"
PAIR = ("--period-1", "1s", "--period-2", "2s")


@pytest.fixture
def case(tmp_path: Path) -> Path:
    """A case whose record has the name of a table."""
    time = 0.01 * np.arange(400)
    np.savetxt(tmp_path / "taft.csv", np.sin(5 * time))
    path = tmp_path / "case.toml"
    path.write_text(recorded_example().replace("taft.txt", "taft.csv"), encoding="utf-8")
    return path


def test_the_record_of_a_case_or_table_is_not_written_over(case: Path) -> None:
    record = case.with_name("taft.csv")
    before = record.read_bytes()
    (case.parent / "link.csv").symlink_to(record)
    os.link(record, case.parent / "same.csv")
    (case.parent / "folder").mkdir()
    for name in ("taft.csv", "link.csv", "same.csv", "folder/../taft.csv"):
        result = refused("gap", case, "--out", case.parent / name)
        assert SAYS in result
        assert "give another name" in result
    for command in ("mitigate", "probability"):
        assert SAYS in refused(command, case, "--out", record)
    assert record.read_bytes() == before
    histories = record.rename(record.with_suffix(".nc"))  # the dataset that goes beside a picture
    case.write_text(case.read_text().replace("taft.csv", "taft.nc"), encoding="utf-8")
    assert SAYS in refused("pound", case, "--out", histories)
    assert SAYS in refused("pound", case, "--picture", histories.with_suffix(".png"))


def test_a_link_stays_and_what_it_leads_to_is_written(tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    link, real = tmp_path / "link.csv", tmp_path / "folder" / "real.csv"
    link.symlink_to(real)
    for _ in range(2):  # of a file that is not there yet, and of one that is
        answered("rho", *PAIR, "--out", link)
        assert link.is_symlink()
        assert real.read_text().startswith("case,rho")
        real.write_text("before")
        real.chmod(0o640)
    assert real.stat().st_mode & 0o777 == 0o640
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["folder", "link.csv", "real.csv"]


def test_a_file_that_is_read_only_is_kept(tmp_path: Path) -> None:
    path = tmp_path / "kept.csv"
    path.write_text("before")
    path.chmod(0o444)
    assert "is read-only; make it writable" in refused("rho", *PAIR, "--out", path)
    with pytest.raises(PermissionError, match="read-only"), whole_file(path):
        pass
    assert path.read_text() == "before"


def test_what_is_not_written_to_its_end_leaves_nothing(tmp_path: Path) -> None:
    target = tmp_path / "table.nc"
    target.write_text("before")

    def interrupted() -> None:
        with whole_file(target) as temporary:
            temporary.write_text("half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert list(tmp_path.iterdir()) == [target]
    assert target.read_text() == "before"
    left, named = tmp_path / ".writing-table-killed", tmp_path / ".writing-table-of-another"
    for folder in (left, named):
        folder.mkdir()
    os.close(mark(left))  # by a process that was killed
    with whole_file(target) as first, whole_file(target) as second:
        assert {*tmp_path.iterdir()} == {target, named, first.parent, second.parent}
        for temporary in (first, second):
            temporary.write_text("whole")
    assert {*tmp_path.iterdir()} == {target, named}


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("t.xlsx", "allowed: .nc or .csv"),
        ("no/such/folder/t.csv", "there is no folder"),
        ("folder.csv", "is no ordinary file"),
        ("round.csv", "give another name"),
        (f"{'a' * 300}.csv", "give another name"),
    ],
)
def test_what_cannot_be_written_is_refused_before_the_work(
    name: str, says: str, tmp_path: Path
) -> None:
    (tmp_path / "round.csv").symlink_to("round.csv")
    (tmp_path / "folder.csv").mkdir()
    long = (*PAIR, "--period-1", "0.1s:2s:100", "--hardening", 0.05, "--reduction-factor", 4)
    begin = time.perf_counter()
    result = refused(
        "rho", *long, "--method", "simulation", "--paths", 8192, "--out", tmp_path / name
    )
    assert time.perf_counter() - begin < 5  # the run takes minutes
    if name != "folder.csv":  # click says it itself
        assert says in result


@pytest.mark.parametrize("name", ["table.nc", "table.csv"])
def test_a_full_disk_is_told_with_the_file_and_leaves_nothing(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(xr.Dataset, "to_netcdf", full)
    monkeypatch.setattr("pandas.DataFrame.to_csv", full)
    result = invoke("rho", *PAIR, "--out", tmp_path / name)
    assert result.exit_code == 1
    assert f"{name} could not be written: the disk is full; make room on it" in result.output
    assert "Usage" not in result.output  # no option is wrong
    assert not list(tmp_path.iterdir())


def test_a_name_that_is_a_formula_of_spreadsheets_is_a_text_in_the_table(tmp_path: Path) -> None:
    names = ["=1+1", "@sum", "+3", "-x", "plain"]
    table = xr.Dataset({"gap": ("measure", [-0.1, 0.2, 0.3, 0.4, 0.5])}, {"measure": names})
    save_table(table, tmp_path / "table.csv")
    rows = (tmp_path / "table.csv").read_text(encoding="utf-8").splitlines()[1:]
    assert rows == ["'=1+1,-0.1", "'@sum,0.2", "'+3,0.3", "'-x,0.4", "plain,0.5"]
