"""Grounds from outside: calibrated as one of stochlin, they have its corrections; else no bias."""

from dataclasses import dataclass

import numpy as np
import pytest
import xarray as xr

import stochlin as sl
from stochlin.models.grounds import GROUNDS, Calibration, Filter, Fit, Ground
from stochlin.models.parameters import Parameter, Range, parameter

pytestmark = pytest.mark.invariant

FIRST = sl.Bilinear(xr.DataArray([0.3, 1.0, 3.0], dims="T"), 0.05, 0.05, reduction_factor=4)
SECOND = sl.Bilinear(1.2, 0.05, 0.05, yield_displacement=0.01)
CORNER = xr.DataArray([0.3, 3.0, 30.0], dims="corner")  # also beyond what was simulated


@dataclass(frozen=True)
class Flat(Ground):
    """White noise under another name."""

    name = "flat"
    intensity: Parameter = parameter("m^2/s^3", "PSD", Range(), 1.0)

    @staticmethod
    def filter(values):
        return Filter(values["intensity"])


@dataclass(frozen=True)
class Tone(Ground):
    """Kanai-Tajimi ground whose parameters have other names."""

    name = "tone"
    ratio: Parameter = parameter("1", "damping ratio", Range())
    length: Parameter = parameter("s", "period", Range())
    intensity: Parameter = parameter("m^2/s^3", "PSD", Range(), 1.0)

    @staticmethod
    def filter(values):
        frequency = 2 * np.pi / values["length"]
        return Filter.kanai_tajimi(values["intensity"], frequency, values["ratio"])


@dataclass(frozen=True)
class Corner(Tone):
    """Clough-Penzien ground whose parameters have other names."""

    name = "corner"
    corner: Parameter = parameter("s", "period of the high-pass filter", Range(), 4.0)
    width: Parameter = parameter("1", "damping ratio of the high-pass filter", Range(), 0.6)

    @staticmethod
    def filter(values):
        return Tone.filter(values).clough_penzien(2 * np.pi / values["corner"], values["width"])


def renamed(calibration, **names):
    """A calibration for a class that has other names of the parameters."""
    ranges = {names[name]: ends for name, ends in calibration.ranges.items()}
    soil = calibration.soil and tuple(names[name] for name in calibration.soil)
    high_pass = names.get(calibration.high_pass, "")
    return calibration._replace(soil=soil, ranges=ranges, high_pass=high_pass)


NAMES = {"period": "length", "damping": "ratio"}
OF_HIGH_PASS = NAMES | {"high_pass_period": "corner", "high_pass_damping": "width"}
SAME = [
    (sl.WhiteNoise(0.01), Flat(0.01), {}),
    (sl.KanaiTajimi(0.8, 0.3, 0.01), Tone(0.3, 0.8, 0.01), NAMES),
    (
        sl.CloughPenzien(0.8, 0.3, CORNER, 0.6, 0.01),
        Corner(0.3, 0.8, 0.01, CORNER, 0.6),
        OF_HIGH_PASS,
    ),
]
WAYS = [
    lambda ground: sl.linearize(FIRST, ground),
    lambda ground: sl.linearize(FIRST, ground, closure="drift"),
    lambda ground: sl.peak_response(FIRST, ground, 20.0, closure="drift"),
    lambda ground: sl.correlate(FIRST, SECOND, ground),
    lambda ground: sl.correlate(FIRST, SECOND, ground, closure="drift"),
]
OF_BIAS = "bias", "error", "caution"


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize(("ours", "other", "names"), SAME, ids=["white", "soil", "high_pass"])
def test_a_ground_has_corrections_by_what_it_declares(monkeypatch, way, ours, other, names):
    unknown = way(other)
    monkeypatch.setattr(type(other), "calibration", renamed(type(ours).calibration, **names))
    known, expected = way(other), way(ours)
    xr.testing.assert_equal(known, expected)
    assert known.attrs["comment"] == expected.attrs["comment"]
    judged = [name for name in unknown if name.rpartition("_")[2] in OF_BIAS]
    assert judged
    for name in judged:
        assert (unknown[name] == 2 if "caution" in name else np.isnan(unknown[name])).all(), name
    assert f"{other.name} ground: its bias is unknown" in unknown.attrs["comment"]
    assert "its bias is unknown" not in known.attrs["comment"]


def test_another_filter_is_not_calibrated_by_what_it_is_derived_from():
    class Shifted(sl.KanaiTajimi):
        filter = sl.KanaiTajimi.filter

    class Same(sl.KanaiTajimi):
        """No filter of its own."""

    assert Shifted.calibration is None
    assert Same.calibration == sl.KanaiTajimi.calibration
    assert sl.ParallelGround.calibration is None


@pytest.mark.parametrize(
    ("declared", "says"),
    [
        (
            Calibration((0.1,) * 4, soil=("length", "ratios")),
            "'ratios', which calibration.soil needs",
        ),
        (Calibration((0.1,) * 4, ranges={"a": (1, 2)}), "'a', which calibration.ranges needs"),
        (Calibration((0.1,) * 4, high_pass="b"), "'b', which calibration.high_pass needs"),
        (Calibration((0.1,) * 4, ranges={"ratio": (1, 2)}), "ranges and high_pass need a soil"),
        (Fit({"ratio": (1, 2)}, [(1.0,)]), "'period', which fit needs"),
    ],
)
def test_a_ground_that_declares_what_it_does_not_have_is_refused(declared, says):
    kind = type("Wrong", (Tone,), {type(declared).__name__.lower(): declared})
    with pytest.raises(ValueError, match=f"Wrong: .*{says}"):
        GROUNDS.register("wrong")(kind)
    assert "wrong" not in GROUNDS
