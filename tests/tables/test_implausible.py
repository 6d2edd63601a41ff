"""Numbers that no building and no motion has are allowed, and asked about where written."""

import re
import warnings

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from motions import motion

import stochlin as sl
from stochlin.messages import ImplausibleInput

pytestmark = pytest.mark.invariant

PAIR = ONE, _ = [sl.Bilinear(T, 0.05, 0.05, reduction_factor=3) for T in (0.6, 1.0)]
FIRM, FIERCE = (sl.named_ground("firm", intensity=intensity) for intensity in (0.01, 100.0))
DEFAULT, IDLE = sl.named_ground("firm"), sl.Bilinear(0.5, 0.05, 0.05)
FEW = {"duration": 8.0, "paths": 32}
SECONDS = {"duration": 3.0, "paths": 32, "envelope": sl.AminAng(4.0, 15.0, 0.35)}


def tower(**given):
    usual = {"period": 0.8, "storeys": 8, "storey_height": 3.2, "mass": 4e5, "damping": 0.05}
    return sl.ShearBuilding.regular(
        **usual | {"hardening": 0.05, "base_shear_coefficient": 0.15} | given
    )


SOLID = [sl.Bilinear(T, 0.05) for T in (0.6, 1.0)]
SHAKEN = motion(2.682 * np.sin(np.arange(750) * 0.2), 0.02)
MODES = {
    "periods": [0.4],
    "shapes": [[1.0, 1.0]],
    "masses": [2e5] * 2,
    "heights": [3.0] * 2,
    "damping": 0.05,
}
STIFF = tower(base_shear_coefficient=None)
QUESTIONS = {
    "asce_7: sds = 1: usual are .* is it in g": lambda: sl.asce_7(sds=1.0, sd1=0.6, tl=8.0),
    "eurocode_8: ag = 0.3: usual are .* is it in g": lambda: sl.eurocode_8(0.3, "C"),
    "eurocode_8: ag = 250: usual are": lambda: sl.eurocode_8(250.0, "C"),
    "separation: intensity = 1: .* default": lambda: sl.separation(*PAIR, DEFAULT, **FEW),
    "existing_gap: intensity = 1: ": lambda: sl.existing_gap(*PAIR, DEFAULT, gap=0.1, **FEW),
    "mitigate: intensity = 1: ": lambda: sl.mitigate(*PAIR, DEFAULT, gap=0.1, measures={}, **FEW),
    "pounding_probability: intensity = 100": lambda: sl.pounding_probability(
        *PAIR, FIERCE, 0.1, **FEW
    ),
    "fragility: intensity = 1: ": lambda: sl.pounding_fragility(*PAIR, DEFAULT, 0.1, 0.02, **FEW),
    "simulated_motions: intensity = 1: ": lambda: sl.simulated_motions(DEFAULT, 8.0),
    "existing_gap: gap = 5: .* in cm": lambda: sl.existing_gap(*PAIR, FIRM, gap=5.0, **FEW),
    "simulate: duration = 3: .* before its strong": lambda: sl.simulate(PAIR, FIRM, **SECONDS),
    "confidence = 0.1: .* is it the probab": lambda: sl.separation(
        *PAIR, FIRM, confidence=0.1, **FEW
    ),
    "code_gaps: behaviour_1 = 40: ": lambda: sl.code_gaps(
        0.1, 0.1, behaviour_1=40.0, behaviour_2=3.0
    ),
    "ShearBuilding.regular: storey_height = 3200: .* mm": lambda: tower(storey_height=3200.0),
    "ShearBuilding.regular: storey 1, 3.2 m high, yields at .* usual": lambda: tower(
        period=3.4, base_shear_coefficient=0.69
    ),
    "pounding_probability: gap = 8: .* in cm": lambda: sl.pounding_probability(
        *PAIR, FIRM, np.array([8.0, 10.0]), **FEW
    ),
    "separation: first and second are the same": lambda: sl.separation(ONE, ONE, FIRM, **FEW),
    "recorded_gap: a and b are the same motion": lambda: sl.recorded_gap(
        *SOLID, {"a": SHAKEN, "b": SHAKEN}
    ),
    "recorded_gap: a and b are the same motion; ": lambda: sl.recorded_gap(
        *SOLID, {"a": SHAKEN, "b": (1.3 * SHAKEN).round(4)}
    ),
    "recorded_gap: UD is vertical by its name": lambda: sl.recorded_gap(*SOLID, {"UD": SHAKEN}),
    "recorded_gap: record: its peak is 2.683 g": lambda: sl.recorded_gap(*SOLID, 9.81 * SHAKEN),
    "recorded_gap: record: its velocity reaches": lambda: sl.recorded_gap(*SOLID, SHAKEN + 0.8),
    "simulate: duration = 8: its strong shaking has 0.55 s": lambda: sl.simulate(
        PAIR, FIRM, duration=8.0, paths=32, envelope=sl.AminAng(0.5, 0.7, 2.0)
    ),
    "Link: its spring yields and has no stiffness": lambda: sl.Link(
        hardening=0.02, yield_displacement=0.005
    ),
    "ModalBuilding: all modes together move its floors by 1.5": lambda: sl.ModalBuilding(
        **MODES, participation=[1.5], modal_masses=[3.6e5]
    ),
    "ShearBuilding: the mass of storeys falls upwards, 0.25 times": lambda: sl.ShearBuilding(
        [8e5, 6e5, 4e5, 2e5], [4e8] * 4, [3.0] * 4, 0.05
    ),
    "ShearBuilding: masses = 400: .* in t": lambda: sl.ShearBuilding([400.0], [1e8], [3.0], 0.05),
    "Bilinear: mass = 400: .* in t": lambda: sl.Bilinear(1.0, 0.05, mass=400.0),
    "Bilinear: period = 500: .* 20 s; is it in ms": lambda: sl.Bilinear(500.0, 0.05),
    "Bilinear: period = 501: ": lambda: sl.Bilinear(sl.Uncertain(501.0, 0.1), 0.05),
    "Bilinear: damping = 0.0005: ": lambda: sl.Bilinear(1.0, 0.0005),
    "reduction_factor = 40: usual are 1 to 8": lambda: sl.Bilinear(1.0, 0.05, 0.05, None, 40.0),
    "Bilinear: yield_displacement = 3: ": lambda: sl.Bilinear(1.0, 0.05, 0.05, 3.0),
    "KanaiTajimi: damping = 2: ": lambda: sl.KanaiTajimi(0.6, 2.0),
    "correlate: hardening = 0.05 has no effect without .* or red": lambda: sl.correlate(
        IDLE, ONE, FIRM
    ),
    "simulate: hardening = 0.05 has no effect without yield_drifts": lambda: sl.simulate(
        [STIFF], FIRM
    ),
}


@pytest.mark.parametrize("words", QUESTIONS)
def test_what_nobody_has_is_asked_about_once_and_where_it_is_written(words):
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", ImplausibleInput)
        QUESTIONS[words]()
    (warning,) = told
    assert warning.filename == __file__
    assert re.search(words, str(warning.message))


def test_what_is_usual_or_scanned_or_dimensionless_is_not_asked_about():
    """Warnings are errors in tests."""
    for period in (0.05, 0.5, 3.0, 10.0):
        for factor in (1.0, 2.5, 8.0):
            sl.Bilinear(period, 0.02, 0.05, reduction_factor=factor, mass=2e4)
    sl.Bilinear(np.geomspace(1e-3, 1e3, 5), 0.05, 0.05, [1e-3, 1.0, 10.0, 100.0, 200.0])
    sl.correlate(*PAIR, DEFAULT)
    sl.linearize(ONE, sl.WhiteNoise())
    sl.strength_for_ductility(IDLE, DEFAULT, 4.0)
    for coefficient, height in ((0.05, 2.5), (0.4, 6.0)):
        tower(base_shear_coefficient=coefficient, storey_height=height).oscillator()
    sl.asce_7(2.0, 1.0, 8.0)
    sl.eurocode_8(0.6, "A")


def test_units_of_arrays_are_known_and_of_the_quantity():
    """Those of another quantity pass, since arithmetic keeps the attributes of the first array."""
    for unit in ("s", "", "-", "1", "N", "m"):
        sl.Bilinear(xr.DataArray([0.6, 1.0], dims="n", attrs={"units": unit}), 0.05)
    for unit in ("Hz", "rad/s", "1/s", "min", "ms", "seconds since"):
        with pytest.raises(
            ValueError, match=f"period is in '{unit}', by its attribute units; allowed: s"
        ):
            sl.Bilinear(xr.DataArray([0.6, 1.0], dims="n", attrs={"units": unit}), 0.05)


def test_columns_of_pandas_agree_in_their_labels():
    """Labels in another order are not taken by their places; they come back with the results."""
    table = pd.DataFrame({"period": [0.6, 1.0], "damping": [0.05, 0.02]}, index=["Hall", "Annex"])
    made = sl.Bilinear(table["period"], table["damping"])
    assert sl.linearize(made, FIRM).case.values.tolist() == ["Hall", "Annex"]
    with pytest.raises(ValueError, match="share a dimension whose coordinates"):
        sl.Bilinear(table["period"], table["damping"].iloc[::-1])
