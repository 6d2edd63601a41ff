"""Case files for pounding: contacts, measures, rows of buildings, storeys; what is wrong."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from cases import example_case, recorded_example, with_buildings
from cases import read_text as read

import stochlin as sl
from stochlin.applications.cases.pounding import pound_case
from stochlin.applications.cases.rows import gap_of, pair_of
from stochlin.views.shared.words import centimetres

pytestmark = pytest.mark.invariant

EXAMPLE = example_case()
CONTACT = EXAMPLE[EXAMPLE.index("[contact]") : EXAMPLE.index("# Measures")]
MEASURES = EXAMPLE[EXAMPLE.index("# Measures") :]
GAP = 'existing = "5 cm" '
THIRD = """[building_3]
name = "Garage"
period = "0.35 s"
damping = 0.05
elastic = true
mass = "600 t"

"""
STOREYS = """[building_{}]
masses = ["300 t", "250 t"]
stiffnesses = ["500 MN/m", "4e5 kN/m"]
heights = ["4 m", "300 cm"]
damping = "5 %"
{}

"""


def row(gaps: str) -> str:
    return EXAMPLE.replace("[separation]", f"{THIRD}[separation]").replace(
        GAP, f"existing = {gaps} "
    )


# --- Contacts -------------------------------------------------------------------------------------

STIFF = {"stiffness": "2e6 kN/m"}
CASES = [
    ("kelvin", STIFF | {"restitution": 0.65}, sl.Kelvin(2e9, restitution=0.65)),
    ("impact_kelvin", STIFF | {"damping_ratio": "30 %"}, sl.ImpactKelvin(2e9, damping_ratio=0.3)),
    ("hertz", {"stiffness": "3 MN/m^1.5"}, sl.Hertz(3e6)),
    ("hertz", {"stiffness": "3 kN/m²", "exponent": 2}, sl.Hertz(3e3, 2.0)),
    ("stereomechanical", {"restitution": 0}, sl.Stereomechanical(0.0)),
]


@pytest.mark.parametrize(("model", "values", "expected"), CASES)
def test_a_contact_is_the_one_that_python_makes(model, values, expected, tmp_path: Path) -> None:
    lines = [f"{name} = {json.dumps(value)}" for name, value in {"model": model, **values}.items()]
    text = EXAMPLE.replace(CONTACT, "\n".join(["[contact]", *lines, ""]))
    assert read(tmp_path, text).contact == expected


# --- Measures -------------------------------------------------------------------------------------


@pytest.mark.filterwarnings("ignore:.*is the same as that before")
def test_devices_stand_in_storeys(tmp_path: Path) -> None:
    both = [STOREYS.format(1, "elastic = true"), STOREYS.format(2, "elastic = true")]
    lines = """[measures.Fluid]
link.damping_constant = "3 MN (s/m)^0.3"
link.damping_exponent = 0.3
added_damping_2 = "15 %"
[measures.Fluid.dampers_1]
damping_constant = "2000 kN (s/m)^0.5"
damping_exponent = 0.5
[measures.Fluid.dampers_2]
storeys = [2]
stiffness = "5 MN/m"
damping_constant = "1 MN s/m"
"""
    case = read(tmp_path, with_buildings(*both).replace(MEASURES, lines))
    measure = case.measures["Fluid"]
    assert (measure.added_damping_1, measure.added_damping_2) == (0.0, 0.15)
    between, *devices = measure.links
    assert between == sl.Link(0.0, 3e6, damping_exponent=0.3, structures=(1, 2))
    assert devices == [
        sl.Link(0.0, 2e6, damping_exponent=0.5, structures=(1, 1), floors=(1, 0)),
        sl.Link(0.0, 2e6, damping_exponent=0.5, structures=(1, 1), floors=(2, 1)),
        sl.Link(5e6, 1e6, structures=(2, 2), floors=(2, 1)),
    ]


# --- Buildings ------------------------------------------------------------------------------------


def test_a_row_of_three(tmp_path: Path) -> None:
    case = read(tmp_path, row('["5 cm", "30 mm"]').replace('title = "Office block and annex"', ""))
    assert case.wanted.existing == [0.05, 0.03]
    assert [building.name for building in case.buildings] == ["Office block", "Annex", "Garage"]
    assert case.title == "Office block, Annex and Garage"
    assert case.buildings[2].structure == sl.Bilinear(0.35, 0.05, mass=6e5)
    for of_two in (pair_of, gap_of):
        with pytest.raises(ValueError, match="describes 3 buildings; allowed: two"):
            of_two(case)


@pytest.mark.parametrize("gap", ['"0 cm"', '["0 m"]'])
def test_buildings_may_touch(gap: str, tmp_path: Path) -> None:
    """Formulas need a gap; a micrometre is closed by any motion, and shown as 0."""
    case = read(tmp_path, EXAMPLE.replace(GAP, f"existing = {gap} "))
    assert (case.wanted.existing, gap_of(case), centimetres(gap_of(case))) == ([0], 1e-6, "0")


# --- What pounding asks of a case -----------------------------------------------------------------


def wave(folder: Path) -> None:
    time = 0.01 * np.arange(400)
    np.savetxt(folder / "taft.txt", 0.3 * np.sin(8 * time) * np.sin(0.8 * time))


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        (recorded_example(), EXAMPLE, "needs a record;.*site.records"),
        (GAP, "# ", 'needs the existing gap; write existing = "5 cm" in .separation'),
        (
            'mass = "1500 t"',
            "",
            r"line \d+: building_2.mass is missing: a contact needs it; write it as",
        ),
        (CONTACT, "", r"needs the contact between the buildings; write \[contact\]"),
    ],
)
def test_what_a_case_lacks_for_pounding(old: str, new: str, says: str, tmp_path: Path) -> None:
    wave(tmp_path)
    text = recorded_example()
    assert old in text
    case = read(tmp_path, text.replace(old, new))
    with pytest.raises(ValueError, match=rf"^case\.toml.*{says}"):
        pound_case(case)


def test_strengths_by_the_ground_become_yield_displacements(tmp_path: Path) -> None:
    wave(tmp_path)
    text = recorded_example().replace("\nreduction_factor = 4\nheight", "\nductility = 3\nheight")
    case = read(tmp_path, text)
    table = pound_case(case)
    expected = [
        float(sl.linearize(b.structure, case.site.ground).yield_displacement) for b in pair_of(case)
    ]
    np.testing.assert_allclose(table.yield_displacement, expected, rtol=1e-9)
    np.testing.assert_allclose(table.peak_ductility, table.peak / expected, rtol=1e-12)
