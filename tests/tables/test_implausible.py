"""Numbers that no building and no motion has are allowed, and asked about where they are written."""

import re
import warnings

import numpy as np
import pytest

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


STIFF = tower(base_shear_coefficient=None)
QUESTIONS = {
    "asce_7: sds = 1: usual are .* is it in g": lambda: sl.asce_7(sds=1.0, sd1=0.6, tl=8.0),
    "eurocode_8: ag = 0.3: usual are .* is it in g": lambda: sl.eurocode_8(0.3, "C"),
    "eurocode_8: ag = 250: usual are": lambda: sl.eurocode_8(250.0, "C"),
    "separation: intensity = 1: .* default": lambda: sl.separation(*PAIR, DEFAULT, **FEW),
    "existing_gap: intensity = 1: ": lambda: sl.existing_gap(*PAIR, DEFAULT, gap=0.1, **FEW),
    "mitigate: intensity = 1: ": lambda: sl.mitigate(*PAIR, DEFAULT, gap=0.1, measures={}, **FEW),
    "pounding_probability: intensity = 100": lambda: sl.pounding_probability(*PAIR, FIERCE, 0.1, **FEW),
    "fragility: intensity = 1: ": lambda: sl.pounding_fragility(*PAIR, DEFAULT, 0.1, 0.02, **FEW),
    "simulated_motions: intensity = 1: ": lambda: sl.simulated_motions(DEFAULT, 8.0),
    "existing_gap: gap = 5: .* in cm": lambda: sl.existing_gap(*PAIR, FIRM, gap=5.0, **FEW),
    "simulate: duration = 3: .* before its strong": lambda: sl.simulate(PAIR, FIRM, **SECONDS),
    "confidence = 0.1: .* is it the probab": lambda: sl.separation(*PAIR, FIRM, confidence=0.1, **FEW),
    "code_gaps: behaviour_1 = 40: ": lambda: sl.code_gaps(0.1, 0.1, behaviour_1=40.0, behaviour_2=3.0),
    "ShearBuilding.regular: storey_height = 3200: .* mm": lambda: tower(storey_height=3200.0),
    "ShearBuilding.regular: storey 1, 3.2 m high, yields at .* usual": lambda: tower(
        period=5.5, base_shear_coefficient=0.5
    ),
    "ShearBuilding: masses = 400: .* in t": lambda: sl.ShearBuilding([400.0], [1e8], [3.0], 0.05),
    "Bilinear: mass = 400: .* in t": lambda: sl.Bilinear(1.0, 0.05, mass=400.0),
    "Bilinear: period = 500: .* 20 s; is it in ms": lambda: sl.Bilinear(500.0, 0.05),
    "Bilinear: period = 501: ": lambda: sl.Bilinear(sl.Uncertain(501.0, 0.1), 0.05),
    "Bilinear: damping = 0.0005: ": lambda: sl.Bilinear(1.0, 0.0005),
    "reduction_factor = 40: usual are 1 to 8": lambda: sl.Bilinear(1.0, 0.05, 0.05, None, 40.0),
    "Bilinear: yield_displacement = 3: ": lambda: sl.Bilinear(1.0, 0.05, 0.05, 3.0),
    "KanaiTajimi: damping = 2: ": lambda: sl.KanaiTajimi(0.6, 2.0),
    "correlate: hardening = 0.05 has no effect without .* or red": lambda: sl.correlate(IDLE, ONE, FIRM),
    "simulate: hardening = 0.05 has no effect without yield_drifts": lambda: sl.simulate([STIFF], FIRM),
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
