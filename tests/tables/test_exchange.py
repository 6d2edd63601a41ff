"""Results as JSON and as workbooks: read again they are what was computed, with units and names."""

import json
import sys

import cases
import numpy as np
import pytest
import xarray as xr
from commands import answered, invoke

import stochlin as sl
from stochlin.analyses.tables.storage import save_table

pytestmark = pytest.mark.oracle

CASE = f"""\
{cases.FIRM_SITE}[building_1]
name = "=1+1"
period = "0.7 s"
damping = "5 %"
elastic = true
[building_2]
period = "1.1 s"
damping = "5 %"
elastic = true
[separation]
confidence = 0.9
[simulation]
paths = 128
"""


@pytest.fixture(scope="module")
def table():
    """Numbers, a missing one, one without a limit, flags and texts."""
    table = sl.linearize(sl.Bilinear([0.5, 1.0, -1.0], 0.05), sl.WhiteNoise(0.01))
    table["name"] = ("case", ["=SUM(A1:A9)", "é", "a\tb"])
    return table.assign_attrs(limit=np.inf, sizes=np.array([1, 2]))


def strict(text):
    """The content of a JSON text without NaN and Infinity, which Python reads but JSON does not have."""
    return json.loads(text, parse_constant=lambda sign: pytest.fail(f"{sign} is no JSON"))


def test_json_gives_the_dataset_again(table, tmp_path):
    save_table(table, tmp_path / "table.json")
    again = xr.Dataset.from_dict(strict((tmp_path / "table.json").read_text(encoding="utf-8")))
    assert set(again.variables) == set(table.variables)
    assert np.isnan(table.displacement_std).any()
    for name, written in table.variables.items():
        variable = written.where(np.isfinite(written)) if written.dtype.kind == "f" else written
        assert again[name].dims == variable.dims
        values = again[name].to_numpy()
        if variable.dtype.kind == "f":
            values = values.astype(float)  # null is NaN, also where an elastic structure never yields
        np.testing.assert_array_equal(values, variable)
        for key in ("units", "long_name", "flag_meanings"):
            assert again[name].attrs.get(key) == variable.attrs.get(key)
    assert again.attrs["history"] == table.attrs["history"]
    assert again.attrs["limit"] is None
    assert again.attrs["sizes"] == [1, 2]


def test_a_workbook_has_rows_units_and_run_information(table, tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    save_table(table, tmp_path / "table.xlsx")
    book = openpyxl.load_workbook(tmp_path / "table.xlsx")
    assert book.sheetnames == ["results", "variables", "about"]
    head, *rows = book["results"].values
    column = head.index("displacement_std [m]")
    read = [row[column] for row in rows]
    np.testing.assert_allclose(read[:2], table.displacement_std[:2], rtol=1e-15)  # 16 digits
    assert read[2] is None  # not a number
    assert [row[head.index("status")] for row in rows] == [
        "elastic_limit",
        "elastic_limit",
        "invalid_input",
    ]
    names = head.index("name")
    assert [row[names] for row in rows] == ["=SUM(A1:A9)", "é", "a\\tb"]
    assert {cell.data_type for cell in book["results"].columns.__next__()} <= {"s", "n"}
    assert book["results"].cell(2, names + 1).data_type == "s"  # no formula
    about = dict(list(book["about"].values)[1:])
    assert about["history"] == table.attrs["history"]
    words = {name: rest for name, *rest in book["variables"].values}
    assert words["displacement_std"] == ["m", table.displacement_std.long_name]


def test_one_cell_alone_is_one_row(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    alone = sl.linearize(sl.Bilinear(0.5, 0.05), sl.WhiteNoise(0.01))
    save_table(alone, tmp_path / "alone.xlsx")
    head, row = openpyxl.load_workbook(tmp_path / "alone.xlsx")["results"].values
    read, exact = row[head.index("displacement_std [m]")], float(alone.displacement_std)
    assert read == pytest.approx(exact, rel=1e-15)
    save_table(alone, tmp_path / "alone.json")
    again = xr.Dataset.from_dict(strict((tmp_path / "alone.json").read_text()))
    assert float(again.displacement_std) == float(alone.displacement_std)


def test_the_gap_of_a_case_in_all_formats(tmp_path):
    pytest.importorskip("openpyxl")
    case = tmp_path / "case.toml"
    case.write_text(CASE)
    for ending in ("nc", "json"):
        answered("gap", case, "--out", tmp_path / f"gap.{ending}")
    with xr.open_dataset(tmp_path / "gap.nc", engine="scipy") as table:
        again = xr.Dataset.from_dict(strict((tmp_path / "gap.json").read_text()))
        np.testing.assert_array_equal(again.gap.astype(float), table.gap)
        assert list(again.rule.values) == list(table.rule.values)
        assert again.gap.attrs["units"] == "m"
    answered("gap", case, "--out", tmp_path / "gap.xlsx")


def test_a_workbook_without_openpyxl_is_refused_before_the_work(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    done = invoke("rho", "--period", "1s", "--out", tmp_path / "t.xlsx")
    assert done.exit_code == 1
    assert done.output == "Error: a file .xlsx needs openpyxl: pip install 'stochlin[tables]'\n"
    assert not list(tmp_path.iterdir())
