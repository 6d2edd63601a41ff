"""Specifications of an atlas: what is wrong is said before any work."""

import numpy as np
import pytest

from stochlin.analyses.atlases.specification import read_specification, specification
from stochlin.analyses.atlases.store import block_shape, largest_bytes

pytestmark = pytest.mark.invariant

GOOD = {"period_1": [0.5, 1.0], "period_2": 0.8, "damping": 0.05, "ground_damping": 0.2}
STRONG = GOOD | {"hardening": 0.05, "reduction_factor": [2, 4]}
SWEEP = {"start": 0.1, "stop": 10, "count": 5}


def given(changes, **keys):
    return keys | {"parameters": STRONG | changes}


def without(name):
    return {"parameters": {key: value for key, value in STRONG.items() if key != name}}


BAD = [
    ({}, r"\[parameters\] is missing"),
    (given({}, colour="red"), "colour unknown in the specification; allowed: title"),
    (given({"perid_1": 1.0}), r"perid_1 unknown in \[parameters\]; allowed: period_1"),
    (given({"period_1": []}), "period_1 is an empty axis"),
    (given({"period_1": SWEEP | {"count": 0}}), "period_1: count = 0 is an empty axis"),
    (given({"period_1": SWEEP | {"count": 10**9}}), "allowed: 1 to 1000000"),
    (given({"period_1": SWEEP | {"count": 2.5}}), "count = 2.5"),
    (given({"period_1": SWEEP | {"step": 2}}), "step unknown in period_1"),
    (given({"period_1": SWEEP | {"spacing": "cubic"}}), "spacing = 'cubic' is not known"),
    (given({"period_1": SWEEP | {"start": -1}}), "0 < start <= stop"),
    (given({"period_1": {"start": 1}}), "period_1: stop, count missing"),
    (given({"period_1": "0.1:2:9"}), "allowed: a number, a list"),
    (given({"period_1": [1, "two"]}), "allowed: a number, a list"),
    (given({"period_1": [1.0, float("nan")]}), "allowed: a number, a list"),
    (given({"period_1": [1.0, 0.5]}), "must increase"),
    (given({"period_1": [-1.0, 0.5]}), "first: period from -1 to 0.5; allowed: 0 < value"),
    (given({"period_2": -1.0}), r"\[parameters\]: Bilinear: period = -1 is out of range"),
    (given({"damping": 5}), "damping = 5 is out of range"),
    (given({"hardening": [0.0, 0.1]}), "stationary displacement"),
    (given({"damping_1": 0.02}), "damping and damping_1 are given"),
    (given({}, ground="moon"), "ground = 'moon' is not known; allowed: kanai_tajimi"),
    (given({}, ground="white_noise"), "ground_damping unknown"),
    (given({}, ground="clough_penzien"), "high_pass_period, high_pass_damping missing"),
    (given({}, closure="drifting"), "closure = 'drifting' is not known"),
    (given({}, title=3), "title = 3"),
    (given({}, block_cells=0), "block_cells = 0"),
    (without("period_1"), "period_1 missing"),
    (without("damping"), "damping_1, damping_2 missing"),
    (without("hardening"), "hardening is not given"),
    ({"parameters": GOOD | {"period_1": 1.0}}, "no parameter is swept"),
]


@pytest.mark.parametrize(("data", "says"), BAD, ids=[says[:30] for _, says in BAD])
def test_what_is_wrong_is_said(data, says):
    with pytest.raises(ValueError, match=says):
        specification(data)


def test_files_that_are_no_specification(tmp_path):
    path = tmp_path / "spec.toml"
    path.write_text("[parameters\n")
    with pytest.raises(ValueError, match="is no TOML file"):
        read_specification(path)
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ValueError, match="is no TOML file"):
        read_specification(path)
    with pytest.raises(OSError, match="nowhere"):
        read_specification(tmp_path / "nowhere.toml")


def test_sweeps_are_the_axes(tmp_path):
    path = tmp_path / "spec.toml"
    path.write_text(
        "[parameters]\n"
        'period_1 = { start = 0.1, stop = 10, count = 5, spacing = "log" }\n'
        "period_2 = { start = 1, stop = 2, count = 3 }\n"
        "damping_1 = 0.02\ndamping_2 = [0.03, 0.05]\nground_damping = 0.2\n"
    )
    chosen = read_specification(path)
    assert list(chosen.axes) == ["period_1", "period_2", "damping_2"]
    np.testing.assert_allclose(chosen.axes["period_1"], [0.1, 10**-0.5, 1, 10**0.5, 10])
    assert chosen.axes["period_2"] == (1.0, 1.5, 2.0)
    assert chosen.cells == 30
    first, second, ground = chosen.models()
    assert (first.damping, ground.period) == (0.02, 1.0)
    assert second.damping.dims == ("damping_2",)


@pytest.mark.parametrize("cells", [1, 7, 40, 1000, 10**9])
def test_blocks_keep_their_size(cells):
    data = {"parameters": STRONG | {"period_1": SWEEP | {"count": 31}, "period_2": SWEEP}}
    chosen = specification(data | {"block_cells": cells})
    shape = block_shape(chosen)
    sizes = {name: len(values) for name, values in chosen.axes.items()}
    assert all(1 <= shape[name] <= sizes[name] for name in sizes)
    assert np.prod(list(shape.values())) <= cells
    if cells == 10**9:
        assert shape == sizes


def test_size_is_estimated_without_building_the_table():
    axes = {f"period_{n}": SWEEP | {"count": 10**5} for n in (1, 2)}
    chosen = specification({"parameters": STRONG | axes})
    assert chosen.cells == 2 * 10**10
    assert largest_bytes(chosen) > 18 * 2 * 10**10
