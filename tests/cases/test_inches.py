"""Cases with lengths in inches or feet: inches and feet stand beside centimetres and metres."""

from pathlib import Path

import pytest
from cases import example_case
from commands import answered

import stochlin as sl
from stochlin.views.shared.blocks import Items, TableBlock, TextBlock, ViewSection
from stochlin.views.shared.inches import inches, sections_with_inches, with_inches

pytestmark = pytest.mark.cli


@pytest.fixture
def american(tmp_path: Path) -> Path:
    path = tmp_path / "case.toml"
    text = example_case().replace('existing = "5 cm"', 'existing = "2 in"')
    path.write_text(text.replace('height = "15 m"', 'height = "50 ft"'), encoding="utf-8")
    return path


def test_only_a_case_with_such_units_has_them(american: Path, tmp_path: Path) -> None:
    metric = tmp_path / "metric.toml"
    text = example_case().replace("Annex", "12 in the yard")
    metric.write_text(text, encoding="utf-8")
    assert not sl.read_case(metric).in_inches
    assert with_inches(sl.read_case(metric), "5.1 cm") == "5.1 cm"
    assert sl.read_case(american).in_inches


@pytest.mark.parametrize(
    ("metric", "both"),
    [
        ("5.1 cm apart", "5.1 cm / 2.0 in apart"),
        ("10.8 to 11.1 cm.", "10.8 to 11.1 cm / 4.3 to 4.4 in."),
        ("8.9 and 5.1 cm at 15.24 m", "8.9 and 5.1 cm / 3.5 and 2.0 in at 15.24 m / 50 ft"),
        ("0.5 cm", "0.5 cm / 0.2 in"),
        ("2 MN s/m, 0.5 m/s, 0.01 m²/s³, building 2 moves", None),
    ],
)
def test_lengths_in_a_text(american: Path, metric: str, both: str | None) -> None:
    found = with_inches(sl.read_case(american), metric)
    assert found.replace("\N{NO-BREAK SPACE}", " ") == (both or metric)


def test_tables_have_a_column_or_a_row_more_and_texts_of_the_user_stay(american: Path) -> None:
    case = sl.read_case(american)
    of_columns = TableBlock.of(
        ("rule", "gap [cm]", "apart"), [("srss", "13.6 (2.54 to 25.4)", "98 %")]
    )
    of_rows = TableBlock.of(
        ("", "mean"), [("  displacement [cm]", "8.3 +- 0.28"), ("impacts", "3")]
    )
    title = TextBlock("Wall 5 cm from the line", "title")
    blocks = [title, Items(["5.08 cm"]), of_columns, of_rows]
    (section,) = sections_with_inches(case, [ViewSection("", blocks)])
    same, _, columns, rows = section.blocks
    assert same == title
    assert isinstance(columns, TableBlock)
    assert columns.heads == ["rule", "gap [cm]", "gap [in]", "apart"]
    assert columns.rows[0].cells[1:3] == ["13.6 (2.54 to 25.4)", "5.4 (1.0 to 10.0)"]
    assert isinstance(rows, TableBlock)
    assert [row.cells[0] for row in rows.rows] == [
        "  displacement [cm]",
        "  displacement [in]",
        "impacts",
    ]
    assert rows.rows[1].cells[1] == "3.3 +- 0.11"


def test_commands_show_them(american: Path, tmp_path: Path) -> None:
    page = tmp_path / "gap.html"
    screen = answered("gap", american, "--report", page).stdout
    assert "The existing gap of 5.1 cm / 2.0 in keeps" in screen
    assert "gap [cm]  gap [in]" in screen
    assert "Gap [in]" in page.read_text(encoding="utf-8")
    assert inches(0.0508) == "2.0\N{NO-BREAK SPACE}in"
    assert "gap 5.1 cm / 2.0 in" in answered("probability", american).stdout
