"""The command line as its user meets it: output, files, errors and exit statuses."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import click
import numpy as np
import pytest
import xarray as xr
from cases import example_case, recorded_example
from commands import answered, invoke, refused

import stochlin as sl
from stochlin.analyses.cases.examples import example_record
from stochlin.analyses.tables import storage
from stochlin.models.laws import closure_names
from stochlin.views.command import main

pytestmark = pytest.mark.cli

FORMULAS = ("fig3a", "fig3b", "fig6", "fig7", "fig8")  # of no ground
OF_MOTIONS = ("fig1", "fig1b", "fig2")
PAIR = ("--period-1", "0.7s", "--period-2", "1s")
YIELDING = ("--hardening", 0.05, "--reduction-factor", 4)
KANAI_TAJIMI = ("--ground", "kanai-tajimi")
FIGURES = (*FORMULAS, "fig4a", "fig4b", "fig4c", "fig5a", "fig5b")
# A pair of points and of reduction factors in each, and few motions.
QUICK_CHARTS = {
    "charts": {"points": 9, "simulated_points": 2, "paths": 4, "reduction_factors": "4,6"},
}
RECORDED = ("site_spectrum", "fig1", "fig1b", "fig2", "added_damping")


def test_rho_of_a_pair_is_the_librarys() -> None:
    result = answered("rho", *PAIR, *YIELDING)
    first, second = (sl.Bilinear(T, 0.05, 0.05, reduction_factor=4) for T in (0.7, 1.0))
    rho = float(sl.correlate(first, second, sl.WhiteNoise()).rho)
    assert f"{rho:.6g}" in result.output
    assert result.output.count("Caution") == 1
    assert "reduction factor 4" in result.output


def test_rho_of_elastic_structures_needs_no_caution() -> None:
    result = answered("rho", *PAIR)
    assert "Caution" not in result.output


def test_sweeps_become_dimensions_of_the_saved_table(tmp_path: Path) -> None:
    out = tmp_path / "table.nc"
    result = answered(
        *("rho", "--period-1", "0.2s:2s:4", "--period-2", "0.5s:2s:3:log", "--hardening", "0.02,0.1"),
        *("--reduction-factor", 4, "--ground", "kanai-tajimi", "--ground-period", "2s"),
        *("--ground-damping", "0.05,0.3", "--out", out),
    )
    with xr.open_dataset(out) as table:
        assert dict(table.sizes) == {"period_1": 4, "hardening": 2, "ground_damping": 2, "period_2": 3}
        np.testing.assert_allclose(table.period_2, [0.5, 1, 2])
        chosen = table.sel(hardening=0.1, ground_damping=0.3).isel(period_1=1, period_2=2)
        pair = [sl.Bilinear(T, 0.05, 0.1, reduction_factor=4) for T in (0.8, 2.0)]
        expected = sl.correlate(*pair, sl.KanaiTajimi(2.0, 0.3)).rho
        np.testing.assert_allclose(chosen.rho, expected, rtol=1e-9)
        assert table.rho.attrs["units"] == "1"
    assert "more rows" in result.output


def test_csv_has_a_row_a_cell(tmp_path: Path) -> None:
    out = tmp_path / "table.csv"
    answered("rho", "--period-1", "0.5s,1s,2s", "--period-2", "1s", "--out", out)
    lines = out.read_text().splitlines()
    assert lines[0].startswith("period_1 [s],rho,")
    assert len(lines) == 4
    heads, first = (line.split(",") for line in lines[:2])
    assert first[heads.index("status")] == "elastic_limit"


def test_names_are_taken_with_either_dash() -> None:
    shared = ("--period", "0.7s", "--period-2", "1s", "--hardening", "0.1", "--reduction-factor", "4")
    dashed, plain = (invoke("rho", *shared, "--law", name) for name in ("bouc-wen", "bouc_wen"))
    assert dashed.exit_code == 0
    assert dashed.stdout == plain.stdout


@pytest.mark.parametrize("closure", closure_names())
def test_every_closure_is_an_option_of_rho(closure: str, tmp_path: Path) -> None:
    periods = ("--period-1", "0.5s,0.9s", "--period-2", "0.7s")
    out = tmp_path / "table.nc"
    answered("rho", *periods, *YIELDING, "--closure", closure, "--out", out)
    first, second = (
        sl.Bilinear(period, 0.05, 0.05, reduction_factor=4) for period in (np.array([0.5, 0.9]), 0.7)
    )
    with xr.open_dataset(out) as table:
        expected = sl.correlate(first, second, sl.WhiteNoise(), closure=closure)
        np.testing.assert_array_equal(table.rho, expected.rho)


def test_effective_properties_by_a_rule_of_ones_own_choice() -> None:
    given = ("rho", *PAIR, *YIELDING, "--method", "effective", "--rule", "secant")
    result = answered(*given)
    first, second = (sl.Bilinear(T, 0.05, 0.05, reduction_factor=4) for T in (0.7, 1.0))
    table = sl.correlate(first, second, sl.WhiteNoise(), "effective", rule="secant")
    assert f"{float(table.rho):.6g}" in result.output
    assert "iwan_1980" in refused(*given[:-1], "mine")


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
    for arguments, says in ((["--version"], "stochlin, version"), (["rho"], "python -m stochlin rho")):
        command = [sys.executable, "-m", "stochlin", *arguments]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert says in done.stdout + done.stderr
        assert (done.returncode == 0) == (arguments == ["--version"])


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--period-2", "1s"), "--period-1"),
        (("--period", "-1s"), "Bilinear: period = -1 is out"),
        (("--period", "one"), "'one' is no number"),
        (("--period", "1s:2s"), "start:stop:count"),
        (("--period", "1s:2s:1"), "count >= 2"),
        (("--period", "1s", "--reduction-factor", "4"), "Bilinear: hardening is not given"),
        (("--period", "1s", "--ground", "moon"), "firm"),
        (("--period", "1s", *KANAI_TAJIMI), "--ground-period, --ground-damping"),
        (("--period", "1s", "--ground-period", "2s"), "does not apply"),
        (("--period", "1s", "--record", "nowhere.txt"), "nowhere.txt: there is no such file"),
    ],
)
def test_bad_input_exits_with_2_and_says_what(arguments: tuple[str, ...], says: str) -> None:
    assert says in refused("rho", *arguments)


@pytest.mark.slow
def test_every_chart_is_drawn_beside_its_dataset(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As on the page of all calls, with fewer points and motions."""
    monkeypatch.chdir(tmp_path)
    answered("charts", default_map=QUICK_CHARTS)
    names = {*FIGURES, *OF_MOTIONS}
    assert {path.stem for path in Path("figures").glob("*.nc")} == names
    assert {path.stem for path in Path("figures").glob("*.png")} == names
    assert not list(Path("figures").glob(".*"))


def test_one_chart_with_its_own_parameters(tmp_path: Path) -> None:
    options = ("--damping", 0.02, "--reduction-factors", "1,3", "--points", 9, "--format", "svg")
    options += ("--simulated-points", 0, "--comparison")
    answered("charts", "fig4b", *options, "--out", tmp_path)
    files = {"fig4b.nc", "fig4b.svg", "fig4b_comparison.svg"}
    assert {path.name for path in tmp_path.iterdir()} == files
    with xr.open_dataset(tmp_path / "fig4b.nc") as chart:
        assert chart.reduction_factor.values.tolist() == [1, 3]
        assert "ξ = 0.02" in chart.attrs["caption"]


@pytest.mark.parametrize(
    ("chart", "kind"),
    [
        pytest.param("fig4b --simulated-points 0", "svg", marks=pytest.mark.slow),
        ("fig3b", "pdf"),
    ],
)
def test_the_same_command_makes_the_same_files(chart: str, kind: str, tmp_path: Path) -> None:
    few = ("--points", 9, "--simulated-points", 2, "--paths", 4, "--format", kind)
    for name in ("a", "b"):
        answered("charts", *few, *chart.split(), "--out", tmp_path / name)
    for path in (tmp_path / "a").iterdir():
        assert path.read_bytes() == (tmp_path / "b" / path.name).read_bytes(), path.name


@pytest.mark.slow
def test_charts_of_a_site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As on the page that one starts with, with fewer points and motions."""
    monkeypatch.chdir(tmp_path)
    Path("record.at2").write_text(example_record(), encoding="utf-8")
    line = "charts --record record.at2 --out site"
    answered(*line.split(), default_map=QUICK_CHARTS)
    names = {f"{name}_site" for name in FIGURES if name not in FORMULAS}
    assert {path.stem for path in Path("site").glob("*.png")} == names | set(RECORDED)
    np.savetxt("column.txt", sl.read_record("record.at2"))
    assert "dt" in refused("charts", "--record", "column.txt", "--units", "m/s^2", "--out", "site")


def test_unknown_chart_names_the_known_ones(tmp_path: Path) -> None:
    result = refused("charts", "fig9", "--out", tmp_path)
    assert all(name in result for name in FIGURES)


def test_a_command_that_is_not_there_brings_the_nearest_to_mind() -> None:
    result = refused("gaps")
    assert "No such command 'gaps'." in result
    if hasattr(click.exceptions, "NoSuchCommand"):  # older ones suggest nothing
        assert "Did you mean 'gap'?" in result


def test_a_failed_write_leaves_nothing(tmp_path: Path) -> None:
    target = tmp_path / "table.nc"
    target.write_text("before")

    def interrupted() -> None:
        with storage.whole_file(target) as temporary:
            temporary.write_text("half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert list(tmp_path.iterdir()) == [target]
    assert target.read_text() == "before"
    (tmp_path / ".writing-table-0123abcd.nc").touch()  # by a process that was killed
    with storage.whole_file(target) as first, storage.whole_file(target) as second:
        assert {*tmp_path.iterdir()} == {target, first, second}


@pytest.mark.parametrize("name", main.list_commands(None))
def test_help_keeps_its_lines(name):
    """The mark of paragraphs not to be filled is not shown, and examples stand on their own lines."""
    text = invoke(name, "--help").output
    assert "\\b" not in text
    examples = [line for line in text.splitlines() if line.startswith("    stochlin ")]
    assert examples


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
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("seconds", [0.5, pytest.param(3.0, marks=pytest.mark.slow)])
def test_an_interrupted_command_ends_at_once(number: int, seconds: float, tmp_path: Path) -> None:
    """Also while threads compute, so long after the first began, and with no file left."""
    pair = (
        "--period-1",
        "0.7s",
        "--period-2",
        "1s",
        "--hardening",
        "0.05",
        "--reduction-factor",
        "0.72",
    )
    command = ("rho", *pair, "--method", "simulation", "--out", str(tmp_path / "table.nc"))
    # What runs in the background of a shell is told to ignore the signal, and hands that down.
    heed = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"
    with subprocess.Popen(
        [sys.executable, "-c", "\n".join((heed, SAYS_THAT_THREADS_COMPUTE, COMMAND_LINE)), *command],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env=os.environ | {"TMPDIR": str(tmp_path)},
    ) as running:
        assert running.stdout.readline() == b"at work\n"
        time.sleep(seconds)
        begin = time.perf_counter()
        running.send_signal(number)
        _, told = running.communicate(timeout=60)
    assert running.returncode == 128 + number, told
    assert time.perf_counter() - begin < 1
    assert b"Traceback" not in told
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("rho", "--period", "0.7"), ["'0.7' has no unit", '"0.7 s"', '"0.7 ms"']),
        (("rho", "--period", "1s", "--yield-displacement", "5"), ["'5' has no unit", '"5 cm"']),
        (("rho", "--period", "0s:2s:5:log"), ["includes 0"]),
        (("rho", "--period", "1s:2s:99999999999999"), ["GB; allowed", "take fewer points"]),
        (("probability", "case.toml", "--gap", "5"), ["'5' has no unit", '"5 cm"']),
    ],
)
def test_a_number_without_its_unit_is_refused(arguments: tuple[str, ...], says: list[str]) -> None:
    """On the command line as in case files."""
    result = refused(*arguments)
    assert all(text in result for text in says), result


def test_units_are_those_of_case_files() -> None:
    plain = invoke("rho", "--period-1", "0.7s", "--period-2", "1 s", *YIELDING, "--damping", 0.02).output
    other = invoke("rho", "--period-1", "700ms", "--period-2", "1000 ms", *YIELDING, "--damping", "2%")
    assert other.output == plain
    strong = ("rho", "--period", "1s,1200ms", "--hardening", "0.05")
    metres = answered(*strong, "--yield-displacement", "0.02m", "--intensity", "0.01 m²/s³")
    centimetres = invoke(*strong, "--yield-displacement", "2cm", "--intensity", "100cm^2/s^3")
    assert centimetres.output == metres.output


def test_a_strength_in_metres_asks_for_the_strength_of_the_shaking() -> None:
    given = ("rho", "--period", "1s", "--hardening", "0.05", "--yield-displacement", "2cm")
    assert "--yield-displacement needs the strength of the shaking" in refused(*given)
    answered(*given, "--intensity", "0.01 m^2/s^3")


def test_a_warning_of_both_structures_is_shown_once() -> None:
    given = ("rho", "--period-1", "0.7s", "--period-2", "1s", "--hardening", "0.05")
    given += ("--yield-displacement", "5m", "--intensity", "0.01 m^2/s^3")
    output = answered(*given).output
    assert output.count("Warning: ") == output.count("usual are 0.005 to 1 m") == 1


def test_what_is_doubtful_is_shown_on_a_line(tmp_path: Path) -> None:
    case = recorded_example().replace('existing = "5 cm"', "#")
    (tmp_path / "case.toml").write_text(case, encoding="utf-8")
    np.savetxt(tmp_path / "taft.txt", 10 * np.sin(np.arange(400)))
    result = refused("pound", tmp_path / "case.toml")
    (line,) = [line for line in result.splitlines() if "10 g" in line]
    assert line.startswith("Warning: case.toml, line ")
    assert "taft.txt: its peak is 10 g, more than 3 g" in line
