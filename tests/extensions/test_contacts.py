"""A contact element from outside: the one of the documentation, through ``stochlin pound``."""

import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from cases import example_case
from scipy.integrate import solve_ivp

pytestmark = pytest.mark.oracle

RESTITUTION = 0.6
CASE = """
[[site.records]]
path = "record.txt"
name = "noise"
units = "g"
dt = "0.02 s"

[motion]"""
CONTACT = """[contact]
model = "{}"
stiffness = "900 GN/m^1.5"
restitution = 0.6
"""


def case_file(folder: Path, model: str) -> Path:
    text = example_case().replace("[motion]", CASE, 1)
    text = text[: text.index("[contact]")] + CONTACT.format(model).replace("900 G", "900000 M")
    noise = np.convolve(np.random.default_rng(3).normal(size=419), np.hanning(20), "valid")
    np.savetxt(folder / "record.txt", 1.5 * noise / abs(noise).max())
    (folder / "case.toml").write_text(text, encoding="utf-8")
    return folder / "case.toml"


def integrated_restitution(xi: float) -> float:
    """Of two free masses, the law written down again; in scales in which k, m and v0 are 1."""

    def rates(_, state):
        d, v = max(state[0], 0.0), state[1]
        return v, -(d**1.5) - 2 * xi * d**0.25 * v

    def parted(_, state):
        return state[0]

    parted.terminal, parted.direction = True, -1
    run = solve_ivp(rates, (0, 100), (0.0, 1.0), events=parted, rtol=1e-10, atol=1e-13)
    return -run.y_events[0][0, 1]


@pytest.mark.slow
def test_an_element_from_outside_pounds_as_its_force_law_says(toy, tmp_path):
    case = case_file(tmp_path, "tsuji")
    done = toy("pound", case, "--out", "p.nc")
    assert done.returncode == 0, done.stderr
    assert re.search(r"noise: \d+ impacts", done.stdout)
    with xr.open_dataset(tmp_path / "p.nc") as table:
        assert table.sizes["impact"] > 3
        assert float(table.energy_balance_error.max()) < 1e-6
        xi = float(
            re.search(
                r"^Tsuji \(stiffness 9e\+11 N/m\^1.5, damping (.*)\)$", table.attrs["contact"]
            )[1]
        )
        assert integrated_restitution(xi) == pytest.approx(
            RESTITUTION, abs=1e-5
        )  # damping is rounded

    refused = toy("pound", case_file(tmp_path, "rubber"))
    assert refused.returncode != 0
    assert (
        "contact.model = 'rubber' is not known; allowed: linear_spring, kelvin," in refused.stderr
    )
    assert "stereomechanical, tsuji" in " ".join(refused.stderr.split())
