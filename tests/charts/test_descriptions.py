"""Models in words, as datasets and captions of pictures have them."""

import pytest
import xarray as xr

import stochlin as sl
from stochlin.models.descriptions import roles_in_words
from stochlin.models.grounds import GROUNDS

pytestmark = pytest.mark.cli

RANGE = xr.DataArray([0.02, 0.6], dims="cell")
STOREYS = sl.ShearBuilding(
    [2e5] * 2, [1e8, 3e8], [3.0] * 2, 0.05, damping_modes=(1, 2), p_delta=True
)
SAID = [
    (
        sl.Bilinear(
            sl.Uncertain(0.6, 0.2), 0.05, 0.1, yield_displacement=sl.Uncertain.between(0.02, 0.03)
        ),
        "Bilinear (period 0.6 s ± 20 %, damping 0.05, hardening 0.1, yield displacement 2 to 3 cm)",
    ),
    (
        sl.Bilinear(RANGE, 0.05, 0.1, yield_displacement=RANGE, mass=1.5e6),
        "Bilinear (period 0.02 to 0.6 s over cell, damping 0.05, hardening 0.1, yield displacement "
        "0.02 to 0.6 m over cell, peak factor 3, mass 1500 t)",
    ),
    (
        STOREYS,
        "shear building (masses 2 times 200 t over storey, "
        "stiffnesses 100 to 300 MN/m over storey, "
        "heights 2 times 3 m over storey, damping 0.05, P-delta, damping of modes 1 and 2)",
    ),
    (
        sl.Link(damping_constant=4e6, structures=(2, 2), floors=(1, 0)),
        "Link (damping constant 4 MN s/m, floors 1 and ground, inside building 2)",
    ),
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
