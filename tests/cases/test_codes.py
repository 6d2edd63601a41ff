"""Building codes as an engineer applies them, beside what they make of simulated peaks."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scipy.linalg
from cases import read_text
from commands import answered

import stochlin as sl
from stochlin.applications.cases.codes import design_displacements, with_applied_codes
from stochlin.applications.cases.reading.buildings import Building, OscillatorForm
from stochlin.applications.cases.rows import of_codes
from stochlin.applications.cases.separation import CaseAnswer, answer_case
from stochlin.models.rules.codes import CODE_RULES
from stochlin.views.separation.words import rows

G = 9.80665
WORKED = Path(__file__).parents[2] / "docs" / "worked_case.toml"
STOREYS = """\
[site]
ground = "firm"
intensity = "0.01 m^2/s^3"
[motion]
duration = "12 s"
[building_1]
name = "Hall"
period = "0.6 s"
storeys = 3
storey_height = "3 m"
floor_mass = "300 t"
damping = "5 %"
hardening = "5 %"
base_shear_coefficient = 0.15
displacements = ["0.5 cm", "1.1 cm", "1.6 cm"]
behaviour_factor = 3
displacement_factor = 2.5
[building_2]
name = "Shed"
period = "0.4 s"
storeys = 2
storey_height = "4 m"
floor_mass = "200 t"
damping = "5 %"
hardening = "5 %"
base_shear_coefficient = 0.2
displacements = ["0.4 cm", "0.9 cm"]
behaviour_factor = 2
displacement_factor = 2
importance_factor = 1.25
[separation]
confidence = "90 %"
codes = ["Greece", "asce_7"]
[simulation]
paths = 128
"""


@pytest.fixture(scope="module")
def storeyed(tmp_path_factory: pytest.TempPathFactory) -> CaseAnswer:
    return answer_case(read_text(tmp_path_factory.mktemp("storeyed"), STOREYS))


def first_mode(masses: np.ndarray, stiffnesses: np.ndarray) -> tuple[float, np.ndarray]:
    """Period [s] and shares of the floors of the first mode, from its matrices."""
    count = masses.size
    drifts = np.eye(count) - np.eye(count, k=-1)
    mass = np.diag(masses)
    squares, shapes = scipy.linalg.eigh(drifts.T @ np.diag(stiffnesses) @ drifts, mass)
    shape = shapes[:, 0]
    return 2 * np.pi / np.sqrt(squares[0]), shape * (shape @ masses) / (shape @ mass @ shape)


@pytest.mark.oracle
def test_the_first_mode_of_storeys_by_plain_numpy(storeyed: CaseAnswer) -> None:
    """Under the spectrum, divided by the behaviour factor 3 of Hall."""
    spectrum, hall = sl.eurocode_8(0.25 * G, "C"), storeyed.case.buildings[0]
    case = replace(storeyed.case, site=replace(storeyed.case.site, spectrum=spectrum))
    bare = replace(hall, form=replace(hall.form, displacements=()))
    arrays = hall.structure.arrays()
    period, shape = first_mode(arrays["masses"].values, arrays["stiffnesses"].values)
    assert period == pytest.approx(0.6, rel=1e-9)
    # on the plateau, to 0.6 s
    by_hand = shape * 0.25 * G * 1.15 * 2.5 * (period / 2 / np.pi) ** 2 / 3
    found = design_displacements(case, bare, CODE_RULES["is_1893"])
    np.testing.assert_allclose(found, by_hand, rtol=1e-9)
    # ASCE 7 multiplies forces by the importance factor, by which it divides displacements later.
    important = replace(bare, form=replace(bare.form, importance_factor=1.25))
    for rule, factor in (("asce_7", 1.25), ("is_1893", 1.0)):
        found = design_displacements(case, important, CODE_RULES[rule])
        np.testing.assert_allclose(found, factor * by_hand, rtol=1e-9)


@pytest.mark.oracle
def test_displacements_of_ones_own_at_every_height_by_hand(storeyed: CaseAnswer) -> None:
    """Floors at 3, 6 and 9 m beside 4 and 8 m, two properties: sums, linear between floors."""
    table = storeyed.separation
    np.testing.assert_array_equal(table.height, [3, 4, 6, 8])
    hall = np.array([0.5, 0.5 + 0.6 / 3, 1.1, 1.1 + 2 * 0.5 / 3])
    shed = np.array([0.75 * 0.4, 0.4, 0.65, 0.9])
    np.testing.assert_allclose(
        100 * table.gap_at_height.sel(rule="eurocode_8_applied"), 3 * hall + 2 * shed, rtol=1e-12
    )
    np.testing.assert_allclose(
        100 * table.gap_at_height.sel(rule="asce_7_applied"),
        2.5 * hall + 2 / 1.25 * shed,
        rtol=1e-12,
    )
    np.testing.assert_allclose(
        table.gap_at_height.sel(rule="eurocode_8"), table.peak_at_height_1 + table.peak_at_height_2
    )
    told = table.assumptions.sel(rule="asce_7_applied").item()
    assert "displacements given" in told
    assert "deflection amplification factor Cd: 2.5 and 2; importance factor Ie: 1 and 1.25" in told


@pytest.mark.invariant
def test_the_verdict_belongs_to_the_code_as_applied(storeyed: CaseAnswer) -> None:
    table = storeyed.separation
    samples, meanings = table.separation_samples, table.verdict.attrs["flag_meanings"].split()
    for code in ("eurocode_8", "asce_7"):
        applied, combined = table.sel(rule=f"{code}_applied"), table.sel(rule=code)
        assert applied.kind == "applied"
        assert float(applied.no_pounding_probability) == float((samples <= applied.gap).mean())
        assert float(applied.error) == pytest.approx(
            float(applied.gap / table.gap[0]) - 1, abs=1e-12
        )
        low, high = (float(applied[f"no_pounding_probability_{end}"]) for end in ("lower", "upper"))
        word = "at_least_the_answer" if low >= 0.9 else "less_than_the_answer"
        word = word if low >= 0.9 or high < 0.9 else "within_error"
        assert meanings[int(applied.verdict)] == word
        assert meanings[int(combined.verdict)] == "no_verdict"
        assert np.isnan(combined.no_pounding_probability)


@pytest.mark.invariant
def test_without_codes_it_is_that_of_the_spectrum_if_nothing_is_missing(tmp_path: Path) -> None:
    """ASCE 7 needs two factors of a building beside its spectrum, Eurocode 8 none."""
    text = re.sub("(?m)^(displacements|.*_factor|codes) = .*\n", "", STOREYS).replace(
        "12 s", "20 s"
    )
    american = 'spectrum = "asce_7"\nsds = "1 g"\nsd1 = "0.6 g"\ntl = "8 s"'
    factors = "behaviour_factor = 3\ndisplacement_factor = 2.5\n"
    for site, more, codes in (
        (EC8, "", ("eurocode_8",)),
        (american, "", ()),
        (american, factors, ("asce_7",)),
    ):
        by_code = text.replace('ground = "firm"\nintensity = "0.01 m^2/s^3"', site)
        by_code = by_code.replace("storeys = ", f"{more}storeys = ")
        assert read_text(tmp_path, by_code).codes == codes


@pytest.mark.invariant
def test_a_period_beyond_the_spectrum_is_told_in_the_row(storeyed: CaseAnswer) -> None:
    """Eurocode 8 needs no factor of its own spectrum; the periods are 0.4 and 0.6 s."""
    nothing = {"displacements": (), "behaviour_factor": None, "displacement_factor": None}
    bare = tuple(replace(b, form=replace(b.form, **nothing)) for b in storeyed.case.described)
    case = replace(storeyed.case, described=bare, codes=("eurocode_8",))
    for known, told in (
        (spectrum := sl.asce_7(9.8, 6.0, 8.0), ""),
        (spectrum[41:], ""),
        (spectrum[42:], "its period of 0.4"),
        (spectrum[:30], "its period of 0.6"),
    ):
        case = replace(case, site=replace(case.site, spectrum=known))
        row = with_applied_codes(case, storeyed.separation.isel(rule=slice(0, 24))).isel(rule=-1)
        assert told in row.missing.item()
        assert np.isnan(row.gap) == bool(told)


@pytest.mark.invariant
def test_one_building_keeps_its_own_displacement_from_the_line(tmp_path: Path) -> None:
    start, end = STOREYS.index("[building_2]"), STOREYS.index("[separation]")
    text = STOREYS[:start] + STOREYS[end:].replace('"Greece"', '"Greece", "canada"')
    table = answer_case(read_text(tmp_path, text)).separation
    own = np.array([0.5, 1.1, 1.6])
    for rule, factor in (("eurocode_8_applied", 3), ("asce_7_applied", 2.5)):
        np.testing.assert_allclose(
            100 * table.gap_at_height.sel(rule=rule), factor * own, rtol=1e-12
        )
    canada = table.sel(rule="canada_applied")
    assert np.isnan(canada.gap)
    assert "second building" in canada.missing.item()


@pytest.mark.invariant
def test_a_code_without_displacements_has_one_row(tmp_path: Path) -> None:
    text = re.sub("(?m)^(displacements|.*_factor) = .*\n", "", STOREYS)
    answer = answer_case(read_text(tmp_path, text.replace('["Greece", "asce_7"]', '"China"')))
    (line,) = (line for line in rows(answer) if "china" in line.rule)
    assert line.cells[0] == "china_gb_50011 as you apply it"
    assert line.group == "the code as you apply it"
    assert line.verdict in ("at least the answer", "less than the answer", "within error")


EC8 = 'spectrum = "eurocode_8"\nag = "0.25 g"\nsoil = "C"\nfilters = 1'


@pytest.mark.oracle
@pytest.mark.parametrize(
    ("period", "damping", "behaviour", "share"),
    [
        (0.1, 0.05, 1.0, 1.0 * (2 / 3 + 0.5 * (2.5 / 1.0 - 2 / 3))),  # below TB: less than 1.75
        (0.1, 0.05, 3.0, 1 + 0.5 * 1.5),  # 3 * 0.75 is more than the elastic spectrum
        (0.4, 0.02, 3.0, 2.5),  # q includes the damping: 2.5, not 2.99
        (1.2, 0.05, 3.0, 2.5 * 0.5),
        (
            2.0,
            0.02,
            4.5,
            4.5 * 0.2 / 1.15,
        ),  # lower bound, more than 2.5 * 0.3 = 0.75; elastic 0.896
        (2.0, 0.02, 8.0, 2.5 * (10 / 7) ** 0.5 * 0.3),  # 1.39 is more than the elastic spectrum
    ],
)
def test_the_design_spectrum_of_eurocode_8_by_hand(
    period: float,
    damping: float,
    behaviour: float,
    share: float,
    storeyed: CaseAnswer,
) -> None:
    """EN 1998-1, 3.2.2.5, 4.3.4, ground C: displacements over ag S (T/2 pi)^2.

    TB is 0.2 s, TC 0.6 s and TD 2 s.
    """
    spectrum = sl.eurocode_8(0.25 * G, "C", damping=damping)
    rule, first = CODE_RULES["eurocode_8"], storeyed.case.buildings[0]
    case = replace(storeyed.case, site=replace(storeyed.case.site, spectrum=spectrum))
    table = replace(first.form.table, values={"elastic": True})
    form = OscillatorForm(table=table, period=period, damping=damping, height=3.0, storeys=1)
    structure = sl.Bilinear(period, damping)
    building = Building("Hut", structure, replace(form, behaviour_factor=behaviour))
    unit = 0.25 * G * 1.15 * (period / 2 / np.pi) ** 2
    displacement = behaviour * design_displacements(case, building, rule)
    assert displacement == pytest.approx(share * unit, rel=1e-4)  # between points of the spectrum
    other = design_displacements(case, building, CODE_RULES["is_1893"])
    elastic = np.interp(period, spectrum.period, spectrum) * (period / 2 / np.pi) ** 2
    assert behaviour * other == pytest.approx(elastic, rel=1e-4)
    unknown = replace(building, form=form)
    assert design_displacements(case, unknown, rule) == pytest.approx(elastic, rel=1e-4)
    case = replace(case, described=(building, first), codes=("eurocode_8",))
    table = with_applied_codes(case, storeyed.separation.isel(rule=slice(0, 9)))
    assert "3.2.2.5" in table.assumptions.sel(rule="eurocode_8_applied").item()


@pytest.mark.invariant
def test_countries_have_their_code_with_its_factors(tmp_path: Path) -> None:
    """``ag S`` of Italy is missing, or is the spectrum at 0 s."""
    codes = '["Turkey", "Italy", "Iran", "Colombia", "New Zealand"]'
    text = STOREYS.replace('["Greece", "asce_7"]', codes)
    case = read_text(tmp_path, text)
    assert case.codes == ("tbdy_2018", "ntc_2018", "iran_2800", "nsr_10", "nzs_1170_5")
    assert of_codes(case)["design_pga"] is None
    site = 'ground = "firm"\nintensity = "0.01 m^2/s^3"'
    of_spectrum = read_text(tmp_path, text.replace(site, EC8).replace("12 s", "20 s"))
    assert of_codes(of_spectrum)["design_pga"] == pytest.approx(0.25 * 1.15 * G, rel=1e-12)


@pytest.mark.extreme
@pytest.mark.paper
def test_factors_of_every_code_by_hand() -> None:
    """Displacements of 1 and 2 cm under design forces, of two properties with unaligned floors."""
    given = {"behaviour_1": 3.0, "behaviour_2": 5.0, "deflection_1": 2.0, "deflection_2": 4.0}
    level = {"height_1": 10.0, "height_2": 10.0, "zone": "I"}
    level |= {"storeys_1": 4, "storeys_2": 10, "design_pga": 3.0}
    table = sl.code_gaps(0.01, 0.02, **given, **level, importance_1=1.25, importance_2=1.5)
    by_hand = {
        "eurocode_8": 3 * 1 + 5 * 2,
        "asce_7": 2 * 1 / 1.25 + 4 * 2 / 1.5,
        "canada": np.hypot(3 * 1 / 1.25, 5 * 2 / 1.5),
        "ubc_97": 0.7 * (3 * 1 + 5 * 2),
        "mexico_city": max(3 + 1, 5) + max(10 + 1, 5),
        "is_1893": 5 * (1 + 2),
        "taiwan": 0.6 * (2 * 1 + 4 * 2),
        "peru_e030": max(2 * 2 / 3, 3) + max(8 * 2 / 3, 3),
        "asce_41": 40,
        "mexico_city_simplified": 2 * 7,
        "china_gb_50011": 10,
        "tbdy_2018": max(0.5 * np.hypot(3 * 1 / 1.25, 5 * 2 / 1.5), 3 + 1 * (10 - 6) / 3),
        "ntc_2008": max(2 * 1 + 4 * 2, 10 * 3.0 / (0.5 * G)),
        "ntc_2018": max(2 * 1 + 4 * 2, 10 * 3.0 / (0.5 * G)),
        "iran_2800": max(5, 2 * 1) + max(5, 4 * 2),  # important buildings
        "nsr_10": 3 * 10,
        "nzs_1170_5": 2 * 1 + 4 * 2,
    }
    assert {*by_hand, "srss", "share_of_sum"} <= {*table.rule.values}
    for rule, gap in by_hand.items():
        assert 100 * float(table.gap.sel(rule=rule)) == pytest.approx(gap, rel=1e-12), rule
    for family in ("srss", "share_of_sum"):
        assert np.isnan(table.gap.sel(rule=family))
        assert "multiplied already" in table.missing.sel(rule=family).item()
    level_floors = sl.code_gaps(0.01, 0.02, **given, floors_align=True)
    assert float(level_floors.gap.sel(rule="is_1893")) == pytest.approx(0.03 + 0.10)
    assert "under design forces" in table.comment
    plain = sl.code_gaps(0.01, 0.02)
    assert "as each code defines them" in plain.comment


@pytest.mark.invariant
def test_factors_are_refused_with_their_cure() -> None:
    with pytest.raises(ValueError, match="deflection_2 is given, of a second building"):
        sl.code_gaps(0.01, None, deflection_1=2.0, deflection_2=2.0)


@pytest.mark.cli
@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("NTC-2023", "the edition of 2023 of Mexico City has no rule here, and mexico_city is"),
        ("NTC-Sismo 2023", "the edition of 2023 of Mexico City has no rule here"),
        ("NTC2017", "; mexico_city is the NTC-Sismo of Mexico City of 2017; allowed: "),
        ("NTC-Sismo", "; mexico_city is the NTC-Sismo"),
        (
            "NTC",
            "; mexico_city is the NTC-Sismo of Mexico City of 2017, "
            "and ntc_2018 is the code of Italy",
        ),
        ("DS 61", "Chile (NCh 433, DS 61) has no rule here; allowed: "),
        ("NCh433.Of1996", "Chile (NCh 433, DS 61) has no rule here"),
        ("BSL", "Japan (Building Standard Law) has no rule here"),
        ("Japan", "Japan (Building Standard Law) has no rule here"),
        ("EC8", "; eurocode_8 is EN 1998-1; allowed: "),
        ("EN 1998-1", "; eurocode_8 is EN 1998-1; allowed: "),
        ("IBC 2021", "; asce_7 is that of ASCE 7, to which IBC refers; allowed: "),
        ("ASCE 7-16", "; asce_7 is that of ASCE 7, to which IBC refers; allowed: "),
        ("Atlantis", "'Atlantis', which is not known; allowed: "),
    ],
)
def test_a_code_without_a_rule_is_answered_with_what_is_known(tmp_path, name, said):
    with pytest.raises(ValueError, match=re.escape(said)) as refused:
        read_text(tmp_path, STOREYS.replace('["Greece", "asce_7"]', f'["{name}"]'))
    assert "or a rule of your own, which is one file (docs/extending.md)" in str(refused.value)
    named = set(re.findall(r"\b[a-z]+_[a-z0-9_]+", said))
    assert named <= {*CODE_RULES}


@pytest.mark.invariant
def test_a_name_that_several_rules_have_without_their_year_is_refused():
    for name, allowed in {"NTC": "ntc_2008, ntc_2018", "asce": "asce_7, asce_41"}.items():
        with pytest.raises(ValueError, match=f"allowed: {allowed}$"):
            sl.rules.code_rule(name)
    assert sl.rules.code_rule("NTC 2018").name == "ntc_2018"
    assert sl.rules.effective_rule("iwan").name == "iwan_1980"


@pytest.mark.parametrize(
    ("same_property", "combination"),
    [
        ("true", "(SRSS), since both buildings stand on one property."),
        ("false", "the sum of both displacements, since the buildings stand on two properties"),
    ],
)
def test_it_is_said_which_combination_a_code_asks_for_and_why(tmp_path, same_property, combination):
    text = WORKED.read_text(encoding="utf-8")
    text = re.sub(r"(?s)\[site\.hazard\].*?(?=\[motion\])", "", text)
    text = text.replace('risk = "10 % in 50 years"', "")  # which takes longest
    path = tmp_path / "case.toml"
    path.write_text(
        text.replace("same_property = true", f"same_property = {same_property}"), "utf-8"
    )
    page = tmp_path / "gap.html"
    screen = " ".join(answered("gap", path, "--report", page).stdout.split())
    assert screen.count(combination) == 2
    assert page.read_text(encoding="utf-8").count(combination) == 2
