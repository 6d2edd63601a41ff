"""The scatter from motion to motion in a case file: where it is from, what it does, what is wrong."""

from __future__ import annotations

from pathlib import Path

import pytest
from cases import example_case
from click.testing import CliRunner

import stochlin as sl
from stochlin.analyses.cases.reading.case import Case
from stochlin.analyses.cases.rows import motion_of
from stochlin.analyses.sites.motion_fit import USES
from stochlin.views.command import main
from stochlin.views.shared.words import scatter

pytestmark = pytest.mark.cli

EXAMPLE = example_case().replace("paths = 2048", "paths = 128")
SHORT = ('duration = "20 s"', 'duration = "5 s"')  # fits take as long
# Answers for an existing gap take long: none for the command gap, and for mitigate one that is enough.
GAPS = {"gap": "", "probability": 'existing = "5 cm"', "mitigate": 'existing = "80 cm"'}
CODE = 'spectrum = "eurocode_8"\nag = "0.25 g"\nsoil = "C"\nfilters = 1\n'


def write(folder: Path, line: str = "", site: str = "", command: str = "probability") -> Path:
    """The example with one more line in its motion, and another site."""
    text = EXAMPLE.replace('duration = "20 s"\n', f'duration = "20 s"\n{line}\n')
    text = text.replace('existing = "5 cm"', GAPS[command])
    if site:
        text = f"{text[: text.index('[site]')]}[site]\n{site}\n{text[text.index('[motion]') :]}"
        text = text.replace(*SHORT)
    path = folder / "case.toml"
    path.write_text(text, encoding="utf-8")
    return path


def read(folder: Path, line: str = "", site: str = "") -> Case:
    return sl.read_case(write(folder, line, site))


def test_the_usual_one_is_none_where_the_strength_of_the_ground_is_given(tmp_path):
    case = read(tmp_path)
    assert case.site.scatter == motion_of(case)["scatter"] == case.site.usual_scatter.scatter == 0
    assert not scatter(case)


def test_it_is_read_and_said(tmp_path):
    case = read(tmp_path, "scatter = 0.3")
    assert case.site.scatter == motion_of(case)["scatter"] == 0.3
    assert scatter(case).endswith("the standard deviation 0.3 (scatter in [motion]).")


@pytest.mark.slow
def test_of_a_spectrum_it_is_what_suites_show_and_can_be_left_out(tmp_path):
    case = read(tmp_path, site=CODE)
    assert case.site.scatter == case.site.usual_scatter.scatter == USES["spectrum"].scatter == 0.3
    assert case.site.usual_scatter.source in scatter(case)
    none = read(tmp_path, "scatter = 0", site=CODE)
    assert none.site.scatter == 0
    assert "records show a scatter of 0.3 (suites of records about a spectrum" in scatter(none)


@pytest.mark.slow
@pytest.mark.parametrize("command", GAPS)
def test_every_command_simulates_it(tmp_path, command):
    outputs = []
    for line in ("scatter = 0", "scatter = 0.5"):
        result = CliRunner().invoke(main, [command, str(write(tmp_path, line, command=command))])
        assert result.exit_code == 0, result.output
        outputs.append(result.output)
    assert outputs[0] != outputs[1]
