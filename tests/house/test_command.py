"""The command line as its user meets it: output, files, errors and exit statuses."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from cases import example_case, recorded_example, with_slow
from commands import answered, invoke, refused

import stochlin as sl
from stochlin.views.command import main

pytestmark = pytest.mark.cli

PAIR = ("--period-1", "0.7s", "--period-2", "1s")
YIELDING = ("--hardening", 0.05, "--reduction-factor", 4)


def test_rho_of_a_pair_is_the_librarys() -> None:
    result = answered("rho", *PAIR, *YIELDING)
    first, second = (sl.Bilinear(T, 0.05, 0.05, reduction_factor=4) for T in (0.7, 1.0))
    rho = float(sl.correlate(first, second, sl.WhiteNoise()).rho)
    assert f"{rho:.3g}" in result.output
    assert result.output.count("Caution") == 1
    assert "reduction factor 4" in result.output
    assert "Caution" not in answered("rho", *PAIR).output  # they are elastic


def test_sweeps_become_dimensions_of_the_saved_table(tmp_path: Path) -> None:
    out = tmp_path / "table.nc"
    result = answered(
        *(
            "rho",
            "--period-1",
            "0.2s:2s:4",
            "--period-2",
            "0.5s:2s:3:log",
            "--hardening",
            "0.02,0.1",
        ),
        *("--reduction-factor", 4, "--ground", "kanai-tajimi", "--ground-period", "2s"),
        *("--ground-damping", "0.05,0.3", "--out", out),
    )
    with xr.open_dataset(out) as table:
        assert dict(table.sizes) == {
            "period_1": 4,
            "hardening": 2,
            "ground_damping": 2,
            "period_2": 3,
        }
        np.testing.assert_allclose(table.period_2, [0.5, 1, 2])
        chosen = table.sel(hardening=0.1, ground_damping=0.3).isel(period_1=1, period_2=2)
        pair = [sl.Bilinear(T, 0.05, 0.1, reduction_factor=4) for T in (0.8, 2.0)]
        expected = sl.correlate(*pair, sl.KanaiTajimi(2.0, 0.3)).rho
        np.testing.assert_allclose(chosen.rho, expected, rtol=1e-9)
        assert table.rho.attrs["units"] == "1"
    assert "more rows" in result.output
    answered("rho", "--period-1", "0.5s,1s,2s", "--period-2", "1s", "--out", tmp_path / "table.csv")
    heads, first, *others = (tmp_path / "table.csv").read_text().splitlines()
    assert heads.startswith("period_1 [s],rho,")
    assert first.split(",")[heads.split(",").index("status")] == "elastic_limit"
    assert len(others) == 2


@pytest.mark.slow
def test_a_reader_that_has_seen_enough_is_no_error() -> None:
    code = "import sys; from stochlin.views.command import main; main(sys.argv[1:])"
    command = [sys.executable, "-c", code, "rho", "--period-1", ".2s:2s:30", "--period-2", "1s"]
    reader, writer = os.pipe()
    os.close(reader)
    done = subprocess.run(command, stdout=writer, stderr=subprocess.PIPE, text=True, check=False)
    os.close(writer)
    assert "Usage" not in done.stderr
    assert "Error" not in done.stderr


@pytest.mark.slow
def test_the_package_runs_without_its_script() -> None:
    for arguments, says in (
        (["--version"], "stochlin, version"),
        (["rho"], "python -m stochlin rho"),
    ):
        command = [sys.executable, "-m", "stochlin", *arguments]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert says in done.stdout + done.stderr
        assert (done.returncode == 0) == (arguments == ["--version"])


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("rho --period-2 1s", "--period-1"),
        ("rho --period-1 one --period-2 1s", "'one' is no number"),
        ("rho --period-1 1s:2s --period-2 1s", "start:stop:count"),
        ("rho --period-1 1s:2s:1 --period-2 1s", "with 2 to 999999 values"),
        ("rho --period-1 0s:2s:5:log --period-2 1s", "includes 0"),
        ("rho --period-1 1s --period-2 1s --ground moon", "firm"),
        ("rho --period-1 1s --period-2 1s --ground kanai-tajimi", "needs --ground-period"),
        ("rho --period-1 1s --period-2 1s --ground-period 2s", "period is no argument"),
        ("rho --period-1 1s --period-2 1s --method effective --rule mine", "iwan_1980"),
        ("rho --period-1 0.7 --period-2 1s", "'0.7' has no unit"),
        ("probability case.toml --gap 5", "'5' has no unit"),
        ("charts fig10", "fig4b"),
        ("gaps", "No such command 'gaps'."),
    ],
)
def test_what_is_wrong_exits_with_2_and_is_named(line: str, says: str) -> None:
    assert says in refused(*line.split())


def test_one_chart_with_its_own_parameters(tmp_path: Path) -> None:
    """Whose files are the same when they are made again, without the comparison."""
    options = ("--damping", 0.02, "--reduction-factors", "1,3", "--points", 5, "--format", "svg")
    options += ("--simulated-points", 0)
    for folder, more in (("a", ["--comparison"]), ("b", [])):
        answered("charts", "fig4b", *options, *more, "--out", tmp_path / folder)
    files, again = (
        {path.name: path.read_bytes() for path in (tmp_path / folder).iterdir()} for folder in "ab"
    )
    assert {*again} == {"fig4b.nc", "fig4b.svg"} == {*files} - {"fig4b_comparison.svg"}
    assert again.items() < files.items()
    with xr.open_dataset(tmp_path / "a" / "fig4b.nc") as chart:
        assert chart.reduction_factor.values.tolist() == [1, 3]
        assert "ξ = 0.02" in chart.attrs["caption"]


def test_help_has_examples_on_lines_of_their_own() -> None:
    for name in main.list_commands(None):
        text = invoke(name, "--help").output
        assert "\\b" not in text  # the mark of paragraphs not to be filled
        assert [line for line in text.splitlines() if line.startswith("    stochlin ")], name


@pytest.mark.slow
@pytest.mark.parametrize("encoding", ["cp1252", "ascii"])
def test_what_an_output_cannot_encode_is_spelled_out(encoding: str, tmp_path: Path) -> None:
    """As when Windows writes to a file; names are the user's."""
    case = tmp_path / "case.toml"
    text = example_case().replace("Office block and", "Łódź, ρ and")
    case.write_text(text.replace("paths = 2048", "paths = 100"), encoding="utf-8")
    pair = ("rho", "--period-1", "0.7s", "--period-2", "1s", "--hardening", "0.05")
    commands = (*pair, "--reduction-factor", "4"), ("mitigate", str(case)), ("rho", "--help")
    code = "from stochlin.views.command import main\n"
    code += "".join(f"main({command}, standalone_mode=False)\n" for command in commands)
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        env=os.environ | {"PYTHONIOENCODING": encoding},
        check=False,
    )
    assert done.returncode == 0, done.stderr
    if encoding == "cp1252":
        assert b"linearized rho is off" in done.stdout


SAYS_THAT_THREADS_COMPUTE = """
from stochlin.kernels.basics import parallel
in_order = parallel.in_order
def told(task, count, progress=None):
    if count > 1:
        print("at work", flush=True)
    return in_order(task, count, progress)
parallel.in_order = told
"""
COMMAND_LINE = "from stochlin.views.command import main\nmain()"


@pytest.mark.skipif(os.name == "nt", reason="Windows has no SIGINT for another process")
@pytest.mark.parametrize("number", with_slow([signal.SIGINT, signal.SIGTERM], [signal.SIGTERM]))
@pytest.mark.parametrize("seconds", with_slow([0.5, 3.0], [3.0]))
def test_an_interrupted_command_ends_at_once(number: int, seconds: float, tmp_path: Path) -> None:
    """Also while threads compute, so long after the first began, and with no file left."""
    line = (
        "rho --period-1 0.7s --period-2 1s --hardening 0.05 --reduction-factor 2 "
        "--method simulation"
    )
    command = [*line.split(), "--paths", "200000", "--out", str(tmp_path / "table.nc")]
    # What runs in the background of a shell is told to ignore the signal, and hands that down.
    heed = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"
    with subprocess.Popen(
        [
            sys.executable,
            "-c",
            "\n".join((heed, SAYS_THAT_THREADS_COMPUTE, COMMAND_LINE)),
            *command,
        ],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env=os.environ | {"TMPDIR": str(tmp_path)},
    ) as running:
        assert running.stdout.readline() == b"at work\n"
        time.sleep(seconds)
        begin = time.perf_counter()
        running.send_signal(number)
        _, errors = running.communicate(timeout=60)
    assert running.returncode == 128 + number, errors
    assert time.perf_counter() - begin < 1
    assert b"Traceback" not in errors
    assert not list(tmp_path.iterdir())


def test_what_is_doubtful_is_shown_on_a_line(tmp_path: Path) -> None:
    case = recorded_example().replace('existing = "5 cm"', "#")
    (tmp_path / "case.toml").write_text(case, encoding="utf-8")
    np.savetxt(tmp_path / "taft.txt", 10 * np.sin(np.arange(400)))
    result = refused("pound", tmp_path / "case.toml")
    (line,) = [line for line in result.splitlines() if "10 g" in line]
    assert line.startswith("Warning: case.toml, line ")
    assert "is doubtful: taft.txt: its peak is 10 g; usual are 0.03 to 1 g" in line
