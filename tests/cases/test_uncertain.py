"""Case files with parameters that are not known exactly: what is read, and what cannot be."""

from __future__ import annotations

import pytest
from cases import FIRM_SITE
from cases import read_text as read

import stochlin as sl
from stochlin.applications.cases.pairs import judge_gap
from stochlin.applications.cases.separation import answer_case

pytestmark = pytest.mark.invariant

SECOND = '[building_2]\nperiod = "0.6 s"\ndamping = 0.05\nelastic = true\n'
WANTED = '[separation]\nconfidence = "90 %"\nfloors_align = false\n[simulation]\npaths = 100\n'
OSCILLATOR = """\
name = "Old block"
period = "1.0 s"
damping = "5 %"
hardening = 0.05
reduction_factor = 4
"""
REGULAR = """\
period = "0.8 s"
storeys = 3
storey_height = "3 m"
floor_mass = "400 t"
base_shear_coefficient = 0.15
damping = "5 %"
hardening = 0.05
"""
STOREYS = """\
masses = ["800 t", "600 t"]
stiffnesses = ["1200 MN/m", "1000 MN/m"]
heights = ["4 m", "3 m"]
yield_drifts = "1 cm"
dampers = "2 MN s/m"
damping = "5 %"
hardening = 0.05
"""
GROUND = 'ground = "firm"\nintensity = "0.01 m^2/s^3"\n'


def case_text(building: str, site: str = FIRM_SITE) -> str:
    return f"{site}[building_1]\n{building}{SECOND}{WANTED}"


def changed(text: str, key: str, value: str) -> str:
    """The lines with another value of a key."""
    lines = [
        f"{key} = {value}" if line.startswith(f"{key} =") else line for line in text.splitlines()
    ]
    assert f"{key} = {value}" in lines
    return "\n".join([*lines, ""])


@pytest.mark.parametrize(
    ("text", "uncertain"),
    [
        ('"1.0 s +- 20 %"', sl.Uncertain(1.0, 0.2)),
        ('"1.0 s ± 20 %"', sl.Uncertain(1.0, 0.2)),
        ('"0.8 to 1.2 s"', sl.Uncertain.between(0.8, 1.2)),
    ],
)
def test_a_period_that_is_not_known_exactly_is_read(text, uncertain, tmp_path):
    case = read(tmp_path, case_text(changed(OSCILLATOR, "period", text)))
    assert case.buildings[0].sampled.uncertain == {"period": uncertain}
    assert case.buildings[0].structure == sl.Bilinear(1.0, 0.05, 0.05, reduction_factor=4)
    assert case.uncertain.keys() == {"Old block"}


@pytest.mark.parametrize("text", ['"3 to 7 %"', '"0.03 to 0.07"', '"3 % to 7 %"'])
def test_a_ratio_that_is_not_known_exactly_is_read(text, tmp_path):
    case = read(tmp_path, case_text(changed(OSCILLATOR, "damping", text)))
    found = case.buildings[0].sampled.uncertain["damping"]
    assert [float(found.at(share)) for share in (0.0, 1.0)] == pytest.approx([0.03, 0.07])


@pytest.mark.parametrize(
    ("building", "key", "text", "name"),
    [
        (REGULAR, "floor_mass", '"400 t +- 10 %"', "mass"),
        (STOREYS, "stiffnesses", '["900 to 1500 MN/m", "750 to 1250 MN/m"]', "stiffnesses"),
        (STOREYS, "yield_drifts", '["1 cm +- 20 %", "8 mm +- 20 %"]', "yield_drifts"),
        (STOREYS, "dampers", '"2 MN s/m +- 30 %"', "dampers"),
    ],
)
def test_every_parameter_of_a_building_may_be_uncertain(building, key, text, name, tmp_path):
    case = read(tmp_path, case_text(changed(building, key, text)))
    assert case.buildings[0].sampled.uncertain.keys() == {name}


@pytest.mark.parametrize(
    ("site", "name"),
    [
        ('ground = "firm"\nintensity = "0.01 m^2/s^3 +- 30 %"\n', "intensity"),
        (
            'ground = "kanai_tajimi"\nperiod = "0.4 s +- 20 %"\ndamping = 0.6\n'
            'intensity = "0.01 m^2/s^3"\n',
            "period",
        ),
        (
            'ground = "clough_penzien"\nperiod = "0.4 s"\ndamping = "0.5 to 0.7"\n'
            'high_pass_period = "4 s"\nhigh_pass_damping = 0.6\npga = "0.3 g"\n',
            "damping",
        ),
    ],
)
def test_the_ground_may_be_uncertain(site, name, tmp_path):
    text = case_text(OSCILLATOR, FIRM_SITE.replace(GROUND, site))
    case = read(tmp_path, text)
    assert case.site.sampled_ground.uncertain.keys() == {name}
    median = case.site.sampled_ground.median().arrays()
    for key, value in case.site.ground.arrays().items():
        assert float(median[key]) == pytest.approx(float(value), rel=1e-12)


@pytest.mark.slow
def test_answers_contain_what_is_not_known(tmp_path):
    building = changed(changed(OSCILLATOR, "period", '"1.0 s +- 20 %"'), "damping", '"3 to 7 %"')
    answer = answer_case(read(tmp_path, case_text(building)))
    assert answer.separation.input.values.tolist() == ["structure_1.period", "structure_1.damping"]
    assert (
        answer.matters.attrs["paths"] == answer.separation.attrs["paths"] == 128
    )  # as many, not 512
    assert "input_factor" in judge_gap(answer.case, 0.05)
