"""A building that is a wall: what its model leaves out is said, and no number depends on it."""

from itertools import pairwise

import numpy as np
import pytest
from cases import example_case, storeyed_building, with_buildings
from commands import answered

import stochlin as sl
from stochlin.analyses.cases.separation import answer_case
from stochlin.views.separation.report import report_page
from stochlin.views.shared.words import left_out

WALL = '[building_2]\nsystem = "wall"'


def case_of(folder, text):
    path = folder / "case.toml"
    path.write_text(text, encoding="utf-8")
    return sl.read_case(path)


def with_wall(text):
    assert "[building_2]" in text
    return text.replace("[building_2]", WALL, 1)


def cantilever(b):
    """A mode of a uniform cantilever in bending, over the height from 0 to 1."""
    share = (np.cosh(b) + np.cos(b)) / (np.sinh(b) + np.sin(b))
    return lambda x: np.cosh(b * x) - np.cos(b * x) - share * (np.sinh(b * x) - np.sin(b * x))


def test_a_wall_of_storeys_is_said_to_be_a_chain(tmp_path):
    text = with_buildings(*(storeyed_building(n, "period") for n in (1, 2)))
    assert left_out(case_of(tmp_path, text)) == []
    case = case_of(tmp_path, with_wall(text).replace("p_delta = true", ""))
    (caution,) = left_out(case)
    assert caution.startswith(f"Caution: {case.buildings[1].name} is a wall")
    assert "a chain of storeys deforms in shear only" in caution
    assert "Torsion and rocking of the foundation" in caution


def test_a_chain_with_the_first_mode_of_a_wall_has_not_its_second_period():
    """What the caution says of stiffnesses storey by storey."""
    first = cantilever(1.8751040687)
    n, w, mass = 20, 2 * np.pi, 1e5
    shape = first(np.arange(1, n + 1) / n)
    drifts = np.array([high - low for low, high in pairwise([0.0, *shape])])
    stiffnesses = w**2 * mass * np.cumsum(shape[::-1])[::-1] / drifts
    chain = sl.ShearBuilding([mass] * n, stiffnesses, [3.0] * n, 0.05)
    periods, moved = chain.periods().values, chain.participation().values
    assert periods[0] == pytest.approx(1.0, rel=1e-9)
    np.testing.assert_allclose(moved / moved[-1], shape / shape[-1], rtol=1e-9)
    assert moved[-1] == pytest.approx(1.57, rel=0.05)
    assert periods[0] / periods[1] < 2.5


@pytest.mark.slow
def test_the_screen_and_the_page_say_it_and_no_number_changes(tmp_path):
    text = example_case().replace("paths = 2048", "paths = 128")
    plain, wall = case_of(tmp_path, text), case_of(tmp_path, with_wall(text))
    (caution,) = left_out(wall)
    assert "one oscillator stands for it" in caution
    without, answer = map(answer_case, (plain, wall))
    assert without.separation.drop_attrs().identical(answer.separation.drop_attrs())
    page = report_page(answer)
    assert page.count("one oscillator stands for it") == 1
    assert "torsion of irregular plans" in page
    assert "is a wall" not in report_page(without)
    told = " ".join(answered("gap", tmp_path / "case.toml").output.split())
    assert " ".join(caution.split()) in told.replace("\N{NO-BREAK SPACE}", " ")
