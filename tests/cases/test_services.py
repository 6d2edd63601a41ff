"""Cases as dictionaries, results as strict JSON, and the service of the documentation."""

import json
import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import stochlin as sl

pytestmark = pytest.mark.cli

PAGE = Path(__file__).parents[2] / "docs" / "services.md"
BUILDING = {"period": "0.6 s", "damping": "5 %", "elastic": True}
CASE = {
    "site": {"ground": "firm", "pga": "0.3 g"},
    "motion": {"duration": "20 s"},
    "building_1": BUILDING,
    "building_2": BUILDING | {"period": "1.0 s"},
    "separation": {"confidence": "90 %"},
}


def strictly(text: str) -> Any:
    """JSON without the constants that are none."""

    def refuse(constant: str) -> None:
        raise AssertionError(f"{constant} is no JSON")

    return json.loads(text, parse_constant=refuse)


def test_a_dictionary_is_the_case_that_its_file_is(tmp_path: Path) -> None:
    lines = [f"{name} = {{ {inline(table)} }}" for name, table in CASE.items()]
    path = tmp_path / "case.toml"
    path.write_text("\n".join(lines), encoding="utf-8")
    by_file, by_dictionary = sl.read_case(path), sl.read_case(CASE)
    assert by_file.site.ground == by_dictionary.site.ground
    assert [building.structure for building in by_file.buildings] == [
        building.structure for building in by_dictionary.buildings
    ]


def inline(table: dict[str, Any]) -> str:
    return ", ".join(f"{key} = {json.dumps(value)}" for key, value in table.items())


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        (
            {"building_1": BUILDING | {"period": "0.6"}},
            r"case: building_1.period = '0.6' has no unit",
        ),
        ({"building_1": None}, "case: building_1 = None is no table"),
        (
            {"site": CASE["site"] | {"records": [{"path": "/etc/passwd"}]}},
            "names a file; allowed in case",
        ),
        ({"site": {"spectrum": "/etc/passwd"}}, "names a file; allowed in case files alone"),
        ({"building_3x": BUILDING}, "building_3x is not a key"),
    ],
)
def test_a_mistake_in_a_dictionary_is_named(changes: dict[str, Any], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        _ = sl.read_case(CASE | changes).site.ground


def test_values_are_those_of_the_dataset_and_flags_are_words() -> None:
    flags = {"flag_values": np.array([0, 1], np.int8), "flag_meanings": "enough not_enough"}
    table = xr.Dataset(
        {
            "gap": (("rule", "case"), [[0.1, np.nan], [np.inf, -np.inf]], {"units": "m"}),
            "verdict": ("rule", np.array([1, 0], np.int8), flags),
        },
        {"rule": ["srss", "cqc"]},
        {"title": "Gaps", "gaps": np.array([0.1, np.nan]), "paths": np.int64(3)},
    )
    known = strictly(json.dumps(sl.as_dictionary(table), allow_nan=False))
    assert known["attributes"] == {"title": "Gaps", "gaps": [0.1, None], "paths": 3}
    gap = known["variables"]["gap"]
    assert gap["values"] == [[0.1, None], ["Infinity", "-Infinity"]]
    assert (gap["units"], gap["dims"]) == ("m", ["rule", "case"])
    assert known["variables"]["verdict"]["values"] == ["not_enough", "enough"]
    assert known["variables"]["rule"]["values"] == ["srss", "cqc"]


def test_every_kind_of_result_is_strict_json() -> None:
    pair = [sl.Bilinear(T, 0.05, 0.05, reduction_factor=4, mass=1e6) for T in (0.6, 1.0)]
    firm = sl.named_ground("firm", intensity=0.01)
    motion: dict[str, Any] = {"duration": 10.0, "paths": 64}
    shaken = sl.simulated_motions(firm, 5.0, paths=32, seed=1).isel(path=0)
    elastic = [sl.Bilinear(T, 0.05, mass=1e6) for T in (0.6, 1.0)]
    results = [
        sl.correlate(*pair, firm),
        sl.linearize(pair[0], firm),
        sl.separation(*pair, firm, **motion),
        sl.existing_gap(*pair, firm, 0.5, **motion),
        sl.mitigate(*pair, firm, 0.05, {}, **motion),
        sl.pounding_probability(*pair, firm, 0.05, **motion),
        sl.pound(elastic, [0.05], sl.Kelvin(1e9, restitution=0.65), shaken),
    ]
    for result in results:
        known = strictly(json.dumps(sl.as_dictionary(result), allow_nan=False))
        assert known["variables"].keys() == {*map(str, result.variables)}
    assert "Infinity" in json.dumps(sl.as_dictionary(results[3]))


@pytest.mark.slow
def test_the_service_of_the_documentation_answers(tmp_path: Path) -> None:
    program = PAGE.read_text(encoding="utf-8").partition("```python\n")[2].partition("```")[0]
    assert len([line for line in program.splitlines() if line]) <= 40
    path = tmp_path / "service.py"
    path.write_text(program, encoding="utf-8")
    done = subprocess.run([sys.executable, path], capture_output=True, text=True, check=True)
    good, bad = map(strictly, done.stdout.splitlines())
    gap = good["variables"]["gap"]["values"][0]
    assert math.isfinite(gap)
    assert 0.05 < gap < 0.2
    assert good["variables"]["verdict"]["values"][0] == "answer"
    assert 0 < good["variables"]["existing_no_pounding_probability"]["values"] < 1
    assert good["doubts"] == []
    assert 0 < good["seconds"] < 60
    assert 5e4 < good["memory_KiB"] < 4e6
    assert bad["error"].startswith("case: building_1.period = '0.6' has no unit; allowed: ")
