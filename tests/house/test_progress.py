"""The progress of a command: the time that is left, on terminals only."""

import math
import os
import sys
from pathlib import Path

import pytest
from cases import example_case
from commands import process

from stochlin.views.shared import progress
from stochlin.views.shared.progress import TimeLeft, in_words

pytestmark = pytest.mark.cli


def foretold(monkeypatch: pytest.MonkeyPatch, reports: list[tuple[float, float]]) -> list[float]:
    """The time left after reports at these times [s] of these shares."""
    clock = iter([0.0, *(time for time, _ in reports)])
    monkeypatch.setattr(progress.time, "monotonic", lambda: next(clock))
    left = TimeLeft()
    return [left.after(share) for _, share in reports]


def test_the_time_left_follows_from_the_work_done(monkeypatch: pytest.MonkeyPatch) -> None:
    even = [(n / 10, n / 200) for n in range(201)]  # 20 s
    times = foretold(monkeypatch, even)
    assert all(map(math.isinf, times[:10]))  # the first second
    assert times[10:] == pytest.approx([20 - time for time, _ in even[10:]], abs=1e-6)


def test_a_slow_start_is_soon_forgotten(monkeypatch: pytest.MonkeyPatch) -> None:
    compiled = [(0.1, 0.0), *((8.0 + n / 10, n / 120) for n in range(121))]  # 8 s, and 12 s of work
    times = foretold(monkeypatch, compiled)
    assert math.isinf(times[1])
    assert max(left for left in times[20:] if math.isfinite(left)) < 60
    assert times[90:] == pytest.approx([20 - time for time, _ in compiled[90:]], abs=0.5)


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(math.inf, ""), (0.2, "1 s left"), (59.0, "59 s left"), (61.0, "2 min left")],
)
def test_words(seconds: float, words: str) -> None:
    assert in_words(seconds) == words


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="there are no such terminals")
def test_a_bar_stands_on_a_terminal_only_and_quiet_leaves_it_out(tmp_path: Path) -> None:
    import pty

    (tmp_path / "case.toml").write_text(example_case(), encoding="utf-8")
    command = ["-m", "stochlin", "gap", "case.toml"]
    piped = process(tmp_path, {}, *command)
    assert "should stand" in piped.stdout
    assert "simulating" not in piped.stderr
    os.chdir(tmp_path)
    for more, bars in (([], True), (["--quiet"], False)):
        shown = bytearray()

        def read(terminal: int, to: bytearray = shown) -> bytes:
            to += (data := os.read(terminal, 4096))
            return data

        assert pty.spawn([sys.executable, *command, *more], read) == 0
        assert b"should stand" in shown
        assert (b"simulating  [" in shown) == bars
