"""Models in words, as captions of pictures have them."""

import pytest

import stochlin as sl
from stochlin.models.grounds.base import GROUNDS
from stochlin.models.structures import Gap
from stochlin.views.shared.descriptions import in_words, roles_in_words

pytestmark = pytest.mark.cli
SPACE = "\N{NO-BREAK SPACE}"


def plain(text):
    return text.replace(SPACE, " ")


def test_numbers_have_their_units_and_zeros_are_left_out():
    building = sl.Bilinear(0.6, 0.05, 0.05, yield_displacement=0.02, mass=1.5e6)
    told = "Bilinear, period 0.6 s, damping 0.05, hardening 0.05, yield displacement 2 cm, "
    told += "peak factor 3, mass 1500 t"
    assert plain(in_words(building.describe())) == told
    damper = sl.Link(stiffness=0.0, damping_constant=5e6)
    assert plain(in_words(damper.describe())) == "Link, damping constant 5 MN s/m"


def test_what_the_role_says_is_not_said_twice():
    assert plain(in_words(Gap(0.05).describe(), "gap")) == "5 cm"
    attrs = {"first": "Bilinear(period=1)", "gap": "Gap(gap=0.05)", "title": "not a role"}
    assert list(map(plain, roles_in_words(attrs))) == [
        "building 1: Bilinear, period 1 s",
        "gap: 5 cm",
    ]


def test_models_within_models_are_in_words():
    one, other = (sl.CloughPenzien(period, 0.4, 5.0, 0.6, intensity=0.01) for period in (1.0, 0.2))
    told = plain(in_words(sl.ParallelGround([one, other]).describe(), "ground"))
    assert told.startswith("filters in parallel, (Clough-Penzien, period 1 s, damping 0.4, ")
    assert told.endswith("intensity 0.01 m²/s³), intensity 0.02 m²/s³")
    floors = (1, 0), (2, 1)
    dampers = [sl.Link(damping_constant=4e6, structures=(2, 2), floors=each) for each in floors]
    assert plain(in_words(sl.Measure(link=dampers).describe(), "measure")) == (
        "link 2 times (damping constant 4 MN s/m, inside building 2) at floors (1, 0), (2, 1)"
    )


def test_uncertain_numbers_and_places_have_units_and_words():
    period, strength = sl.Uncertain(0.6, 0.2), sl.Uncertain.between(0.02, 0.03)
    told = in_words(sl.Bilinear(period, 0.05, 0.05, yield_displacement=strength).describe())
    assert "period 0.6 s ± 20 %" in plain(told)
    assert "yield displacement 2 to 3 cm" in plain(told)
    brace = sl.Link(stiffness=1e8, structures=(1, 1), floors=(1, 0))
    assert plain(in_words(brace.describe())).endswith("floors 1 and the ground, inside building 1")


def test_storeys_and_tables_keep_their_ranges():
    text = "ShearBuilding(masses=[3 times 2e+05 over storey], stiffnesses=[1e+08 to 3e+08 over storey])"
    told = "shear building, masses 3 times 200 t over the storeys, stiffnesses 100 to 300 MN/m over "
    told += "the storeys"
    assert plain(in_words(text)) == told


@pytest.mark.parametrize("text", ["Taft 1952, 111", "", "f(", "16 motions (with seeds)"])
def test_what_is_no_model_stays_as_it_is(text):
    assert in_words(text) == text


def test_all_grounds_have_units():
    for kind in GROUNDS.values():
        assert "m²/s³" in in_words(f"{kind.__name__}(intensity=0.02)")
