"""Models in words, as datasets and captions of pictures have them."""

import pytest
import xarray as xr

import stochlin as sl
from stochlin.models.grounds.base import GROUNDS
from stochlin.models.structures import Gap
from stochlin.views.shared.words import roles_in_words

pytestmark = pytest.mark.cli

FLOORS = (1, 0), (2, 1)
DAMPERS = [sl.Link(damping_constant=4e6, structures=(2, 2), floors=each) for each in FLOORS]
GROUND = [sl.CloughPenzien(period, 0.4, 5.0, 0.6, intensity=0.01) for period in (1.0, 0.2)]
STOREYS = sl.ShearBuilding([2e5] * 2, [1e8, 3e8], [3.0] * 2, 0.05, damping_modes=(1, 2), p_delta=True)
BETWEEN = sl.Uncertain.between(0.02, 0.03)
RANGE = xr.DataArray([0.02, 0.6], dims="cell")
SAID = [
    (
        sl.Bilinear(0.6, 0.05, 0.05, yield_displacement=0.02, mass=1.5e6),
        "Bilinear (period 0.6 s, damping 0.05, hardening 0.05, yield displacement 2 cm, peak factor 3, "
        "mass 1500 t)",
    ),
    (
        sl.Bilinear(
            sl.Uncertain(0.6, 0.2), 0.05, 0.1, yield_displacement=sl.Uncertain.between(0.02, 0.03)
        ),
        "Bilinear (period 0.6 s ± 20 %, damping 0.05, hardening 0.1, yield displacement 2 to 3 cm)",
    ),
    (
        sl.Bilinear(RANGE, 0.05, 0.1, yield_displacement=RANGE),
        "Bilinear (period 0.02 to 0.6 s over cell, damping 0.05, hardening 0.1, yield displacement "
        "0.02 to 0.6 m over cell, peak factor 3)",
    ),
    (
        STOREYS,
        "shear building (masses 2 times 200 t over storey, stiffnesses 100 to 300 MN/m over storey, "
        "heights 2 times 3 m over storey, damping 0.05, P-delta, damping of modes 1 and 2)",
    ),
    (
        sl.ParallelGround(GROUND),
        "parallel-filter (intensity 0.02 m²/s³, Clough-Penzien (period 1 s, damping 0.4, high pass "
        "period 5 s, high pass damping 0.6, intensity 0.01 m²/s³) + Clough-Penzien (period 0.2 s, "
        "damping 0.4, high pass period 5 s, high pass damping 0.6, intensity 0.01 m²/s³))",
    ),
    (sl.Link(damping_constant=5e6), "Link (damping constant 5 MN s/m)"),
    (DAMPERS[0], "Link (damping constant 4 MN s/m, floors 1 and ground, inside building 2)"),
    (
        sl.Measure(link=DAMPERS, contact=sl.LinearSpring(2e9), strengthening_1=1.5),
        "strengthening of building 1: 1.5, 2 times Link (damping constant 4 MN s/m, inside building 2) "
        "at floors 1 and ground, floors 2 and 1, contact Linear-Spring (stiffness 2000 MN/m)",
    ),
    (Gap(0.05), "gap 5 cm"),
]


@pytest.mark.parametrize(("model", "words"), SAID, ids=[words[:20] for _, words in SAID])
def test_numbers_have_their_units_and_usual_zeros_are_left_out(model, words):
    assert model.describe() == words


def test_a_caption_has_a_line_a_role():
    attrs = {"first": "Bilinear (period 1 s)", "gap": "gap 5 cm", "title": "not a role"}
    assert roles_in_words(attrs) == ["building 1: Bilinear (period 1 s)", "gap: 5 cm"]


def test_all_grounds_have_units():
    for kind in GROUNDS.values():
        values = dict.fromkeys(kind.parameter_names(), 0.5)
        assert "intensity 0.5 m²/s³" in kind(**values).describe()
