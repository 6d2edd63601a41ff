"""Scenes and what the explorer shows of them, without a page: round trips, agreement with the verbs."""

from __future__ import annotations

import dataclasses
import json
import tempfile

import numpy as np
import pytest
import xarray as xr

import stochlin as sl
from stochlin.analyses.explorer.buildings import REGULAR
from stochlin.analyses.explorer.case_scene import open_case, scene_of
from stochlin.analyses.explorer.case_text import case_text, files_named, left_out
from stochlin.analyses.explorer.formulas import RATIOS, correlation, gap_rules, probability, spectra
from stochlin.analyses.explorer.scene import ALLOWED, BY_DISPLACEMENT, SHAPES, SITES, WHOLE, Scene
from stochlin.analyses.explorer.simulations import SIMULATED_RATIOS, merge_tables, simulations
from stochlin.analyses.explorer.sites import CODES
from stochlin.analyses.linearization.equivalent_systems import INTERNAL, solve_structure
from stochlin.analyses.linearization.tolerance import USUAL
from stochlin.analyses.tables.storage import as_netcdf
from stochlin.kernels.linearization.covariance import EquivalentSystem
from stochlin.models.rules.codes import IN_COMMON
from stochlin.views.explorer import pictures as charts
from stochlin.views.explorer import words
from stochlin.views.explorer.controls import GROUPS, NUMBERS, SCALES, Control, counts

pytestmark = pytest.mark.invariant

LAKEBED = {"site": "kanai_tajimi", "ground_period": 2.0, "ground_damping": 0.05, "intensity": 1e-3}
ELASTIC = Scene(yields_1=False, yields_2=False, period_2=0.7)


def read_text(text, folder):
    path = folder / "case.toml"
    path.write_text(text, encoding="utf-8")
    return scene_of(sl.read_case(path))


GIVEN = [site for site in SITES if site not in CODES]  # no ground has to be sought


@pytest.mark.parametrize("seed", range(len(GIVEN) + len(SHAPES)))
def test_a_scene_survives_its_case_file(seed, tmp_path):
    """Every ground and envelope, and numbers with all their digits."""
    rng = np.random.default_rng(seed)
    drawn = {
        name: float(rng.uniform(*sorted((control.low, control.high))))
        for name, control in NUMBERS.items()
        if name not in (*WHOLE, "gap", "strong_end", "fast", "duration")
    }
    scene = Scene(
        **drawn,
        site=GIVEN[seed % len(GIVEN)],
        envelope=SHAPES[seed % len(SHAPES)],
        yields_1=bool(seed % 2),
        yields_2=bool(seed % 3),
        gap=float(rng.uniform(0.001, 1)),
        strong_end=drawn["rise_end"] + 1 / 3,
        fast=drawn["slow"] + 1 / 3,
        duration=60.1,
        paths=int(rng.integers(100, 5000)),
        seed=seed,
        title='A "quoted" \\ Häuser № 7',
        names=("Ω = 'left'", "right"),
        heights=(12.3, None),
        storeys=(None, 4),
        floors_align=bool(seed % 2),
        same_property=bool(seed % 3),
        same_system=bool(seed % 2),
        zone="II" if seed % 2 else None,
        unverified=bool(seed % 3),
    )
    again, notes = read_text(case_text(scene), tmp_path)
    assert not notes
    assert again.ground().describe() == scene.ground().describe()
    assert again.structures() == scene.structures()
    assert again.motion() == scene.motion()
    assert again.neighbours == scene.neighbours
    assert case_text(again) == case_text(scene)  # all that the file holds: unused sliders it does not


def test_of_the_example_nothing_is_lost(tmp_path):
    scene, notes = read_text(sl.example_case(), tmp_path)
    assert not notes
    assert (scene.title, scene.period_1, scene.period_2, scene.gap) == (
        "Office block and annex",
        1,
        0.6,
        0.05,
    )
    before = sl.read_case(tmp_path / "case.toml")
    moved = dataclasses.replace(scene, period_2=0.7)
    assert not left_out(moved)
    assert read_text(case_text(moved), tmp_path) == (moved, [])
    after = sl.read_case(tmp_path / "case.toml")
    assert after.second.structure == dataclasses.replace(before.second.structure, period=0.7)
    assert after.first == before.first
    for name in ("contact", "measures", "amplification_limit", "numbers", "zone", *IN_COMMON):
        assert getattr(after, name) == getattr(before, name), name


def test_measures_of_storeys_that_are_gone_are_left_out(tmp_path):
    tie = '[measures.tie]\nlink_floors = [1, 1]\nlink_stiffness = "9 MN/m"\n[mitigation]'
    scene, _ = read_text(sl.example_case().replace("[mitigation]", tie), tmp_path)
    storeys = dataclasses.replace(scene, description_1=REGULAR)
    assert not left_out(storeys)  # floor 1 is there
    (tmp_path / "case.toml").write_text(case_text(storeys), encoding="utf-8")
    assert "tie" in sl.read_case(tmp_path / "case.toml").measures
    text = case_text(storeys).replace("link_floors = [1, 1]", "link_floors = [8, 1]")
    scene, _ = read_text(text, tmp_path)
    lower = dataclasses.replace(scene, storey_count_1=5)
    (told,) = left_out(lower)
    assert "they do not fit the buildings: case.toml: measures.tie.link_floors = [8, 1]" in told
    (tmp_path / "case.toml").write_text(case_text(lower), encoding="utf-8")
    assert not sl.read_case(tmp_path / "case.toml").measures


def test_strength_by_yield_displacement_stays_so_whatever_the_intensity(tmp_path):
    text = sl.example_case().replace(
        "reduction_factor = 4\nheight", 'yield_displacement = "2 cm"\nheight'
    )
    scene, notes = read_text(text, tmp_path)
    assert not notes
    stronger = dataclasses.replace(scene, intensity=4 * scene.intensity)
    for one in (scene, stronger):
        assert [structure.yield_displacement for structure in one.structures()] == [0.02, 0.02]
    assert case_text(stronger).count('yield_displacement = "0.02 m"') == 2


def test_strength_the_other_way_is_the_same(tmp_path):
    scene = Scene()
    name, value = scene.equivalent_strength(2)
    assert name == "yield_displacement_2"
    other = dataclasses.replace(scene, strength_by_2=BY_DISPLACEMENT, yield_displacement_2=value)
    for one in (scene, other):
        found = sl.linearize(one.structure(2), scene.ground())
        assert float(found.yield_displacement) == pytest.approx(value, rel=1e-12)
    assert other.equivalent_strength(2) == ("reduction_factor_2", pytest.approx(4, rel=1e-12))
    # The strength by R goes with the square root of the intensity.
    stronger = dataclasses.replace(scene, intensity=4 * scene.intensity)
    assert stronger.equivalent_strength(2)[1] == pytest.approx(2 * value, rel=1e-12)


def test_uncertain_parameters_are_told(tmp_path):
    _, (note,) = read_text(sl.example_case().replace('"0.6 s"', '"0.6 s +- 10 %"', 1), tmp_path)
    assert note.startswith("Uncertain parameters (Annex) are taken at their medians here")


@pytest.mark.filterwarnings("ignore:.*times the energy of the record")  # of another envelope
def test_what_a_scene_cannot_hold_is_told(tmp_path):
    time = 0.01 * np.arange(4000)
    noise = np.random.default_rng(4).normal(size=time.size)
    motion = np.convolve(noise, np.exp(-2 * time) * np.sin(6 * time))[: time.size]
    np.savetxt(tmp_path / "a.txt", motion)
    site = (
        '[site]\nground = "fitted"\n[[site.records]]\npath = "a.txt"\nunits = "cm/s^2"\ndt = "0.01 s"\n'
    )
    text = sl.example_case()
    text = text[: text.index("[site]")] + site + text[text.index("[motion]") :]
    scene, notes = read_text(text.replace('existing = "5 cm"', ""), tmp_path)
    assert scene.site == "kanai_tajimi"
    assert [note for note in notes if "fitted" in note]
    assert list(scene.records) == ["a.txt"]
    assert files_named(scene) == ["a.txt"]
    assert [note for note in notes if "no existing gap" in note]


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"period_1": -1}, r"period_1 = -1 is out of range; allowed: 0.02 <= value <= 20"),
        ({"period_2": float("nan")}, "period_2 = nan"),
        ({"damping_1": 1}, "damping_1 = 1"),
        ({"hardening_1": 0}, "hardening_1 = 0"),
        ({"gap": 0}, "gap = 0"),
        ({"confidence": 1}, "confidence = 1"),
        ({"duration": 1e6}, "duration = 1e"),
        ({"duration": 5, "period_2": 6}, "shorter than the period of building 2, 6 s; allowed"),
        ({"rise_end": 16}, "strong_end >= rise_end"),
        ({"site": "moon"}, "site = 'moon' is not known; allowed: firm"),
        ({"envelope": "box"}, "envelope = 'box' is not known; allowed: amin_ang"),
        ({"paths": 3}, "paths = 3; allowed: a whole number from 100"),
        ({"paths": 10**9}, "to 20000"),
        ({"paths": 200.5}, "paths = 200.5"),
    ],
)
def test_bad_scenes_are_refused_and_say_what_is_allowed(changed, message):
    with pytest.raises(ValueError, match=message):
        dataclasses.replace(Scene(), **changed)


def test_text_is_no_number():
    with pytest.raises(TypeError, match="is not a real number"):
        Scene(period_1="1")  # type: ignore[arg-type]


@pytest.mark.parametrize("system", [(39.5, 0.6, 31.0, 0.4, 2.0), (39.5, 0.6, 0.0, 0.0, 6.3)])
def test_transfer_function_is_that_of_the_state_matrix(system):
    w2, d, h, p, k = system
    matrix = np.array([[0, 1, 0], [-w2, -d, h], [k, p, -k]])
    for frequency in (0.1, 3.0, 6.3, 40.0):
        state = np.linalg.solve(1j * frequency * np.eye(3) - matrix, [0, 1, 0])
        found = EquivalentSystem(*map(np.array, system)).transfer_squared(np.array(frequency))
        assert found == pytest.approx(abs(state[0]) ** 2, rel=1e-12)


@pytest.mark.parametrize("changed", [LAKEBED, {"site": "soft"}, {"site": "white_noise"}])
def test_spectra_hold_the_variance_of_elastic_buildings(changed):
    """But for less than 2 % of it, beyond the periods that are shown."""
    scene = Scene(yields_1=False, yields_2=False, **changed)
    table = spectra(scene)
    for number, structure in enumerate(scene.structures(), start=1):
        density = table[f"displacement_psd_{number}"]
        variance = 2 * np.trapezoid(density, table.frequency)
        sigma = float(sl.linearize(structure, scene.ground()).displacement_std)
        assert variance == pytest.approx(sigma**2, rel=0.02)


def test_transfer_function_holds_the_variance_of_a_building_that_yields():
    scene = Scene(**LAKEBED)
    frequency = np.geomspace(1e-4, 1e4, 40_001)
    side = solve_structure(scene.structure(1), scene.ground(), "gaussian", USUAL)
    system = EquivalentSystem(*(side[name].values for name in INTERNAL[:5]))
    density = scene.ground().psd(frequency).values * system.transfer_squared(frequency)
    variance = 2 * np.trapezoid(density * frequency, np.log(frequency))
    assert variance == pytest.approx(float(side.displacement_std) ** 2, rel=1e-3)


@pytest.mark.parametrize("scene", [Scene(**LAKEBED), Scene(yields_1=False), ELASTIC])
def test_correlation_is_that_of_correlate(scene):
    table = correlation(scene)
    assert float(table.period_ratio.min()) == pytest.approx(0.25)
    assert scene.period_2 / scene.period_1 in table.period_ratio
    for ratio in (scene.period_2 / scene.period_1, float(table.period_ratio[7])):
        one, other = scene.structure(1), scene.structure(2, period=scene.period_1 * ratio)
        cell = table.sel(period_ratio=ratio)
        ground = scene.ground()
        formula = float(sl.rho_white_noise(one.period, other.period, 0.05, 0.05).rho)
        linearized = sl.correlate(one, other, ground)
        drifting = sl.correlate(one, other, ground, closure="drift")
        assert float(cell.rho_white_noise) == pytest.approx(formula, rel=1e-12)
        assert float(cell.rho_linearized) == pytest.approx(float(linearized.rho), rel=1e-9)
        assert float(cell.rho_drift) == pytest.approx(float(drifting.rho), rel=1e-9)
        for name in ("bias", "bias_1", "bias_2", "caution"):
            np.testing.assert_allclose(cell[name], linearized[name], rtol=1e-9)


def test_linearization_as_a_rule_is_that_of_separation():
    scene = Scene(period_2=0.7)
    own = gap_rules(scene).gap
    theirs = sl.separation(*scene.structures(), scene.ground(), **scene.motion(), paths=128).gap
    rule = {"rule": "linearization"}
    assert float(own.sel(rule)) == pytest.approx(float(theirs.sel(rule)), rel=1e-12)


def test_elastic_rules_agree_with_simulation():
    """No drift; and Vanmarcke's peaks err by -1 to +4 %, eq. (3) by a few per cent more."""
    table = gap_rules(ELASTIC).gap
    linear, drift = (float(table.sel(rule=f"eq_3_{name}")) for name in ("linearized", "drift"))
    assert drift == pytest.approx(linear, rel=1e-9)
    pair = ELASTIC.structures()
    answer = sl.separation(*pair, ELASTIC.ground(), **ELASTIC.motion(), paths=1024).gap
    assert float(table.sel(rule="linearization")) == pytest.approx(float(answer[0]), rel=0.1)


def test_peaks_of_the_drift_closure_are_no_smaller_for_buildings_that_yield():
    table = gap_rules(Scene()).gap
    assert float(table.sel(rule="eq_3_drift")) > 1.2 * float(table.sel(rule="eq_3_linearized"))
    assert float(table.sel(rule="srss")) <= float(table.sel(rule="share_of_sum"))


def test_a_motion_too_short_for_a_peak_is_told():
    with pytest.raises(ValueError, match=r"duration = 1 s is too short .* allowed"):
        gap_rules(Scene(duration=1.0, period_1=0.8))


@pytest.fixture(scope="module")
def simulated():
    shares: list[float] = []
    return simulations(Scene(paths=128), shares.append), shares


def test_simulations_answer_the_same_questions(simulated):
    tables, shares = simulated
    scene = Scene(paths=128)
    assert shares == sorted(shares)
    assert 0 < shares[0] < 0.4
    assert shares[-1] == pytest.approx(1)
    assert tables["gaps"].rule[0] == "simulation"
    own = tables["correlation"].sel(period_ratio=scene.period_2 / scene.period_1)
    assert 0 < float(own.rho_standard_error) < 0.1
    formula = probability(scene)
    assert "confidence_of_no_pounding_simulated" not in formula
    first, second = scene.structures()
    both = sl.pounding_probability(first, second, scene.ground(), scene.gap, **scene.motion(), paths=128)
    for name, array in both.items():
        own = formula if name in formula else tables["probability"]
        xr.testing.assert_identical(own[name], array)


def test_what_progress_raises_stops_a_simulation():
    class Enough(Exception):  # noqa: N818
        pass

    def stop(share: float) -> None:
        raise Enough

    with pytest.raises(Enough):
        simulations(Scene(paths=128), stop)


def test_all_that_is_shown_becomes_one_file(simulated, tmp_path):
    scene, (tables, _) = Scene(paths=128), simulated
    whole = merge_tables(
        scene,
        {
            "spectra": spectra(scene),
            "correlation": correlation(scene),
            "gaps": tables["gaps"],
            "probability": tables["probability"],
            "simulation": tables["correlation"],
        },
    )
    path = tmp_path / "explored.nc"
    path.write_bytes(as_netcdf(whole))
    with xr.open_dataset(path, engine="scipy") as read:
        assert set(read.data_vars) == set(whole.data_vars)
        np.testing.assert_array_equal(read.gaps_gap, tables["gaps"].gap)
        np.testing.assert_array_equal(read.simulation_rho, tables["correlation"].rho)
        assert read.attrs["gap_m"] == scene.gap
        assert read.spectra_psd_ground.attrs["units"] == "m^2/s^3"
        assert list(read.gaps_rule.values) == list(tables["gaps"].rule.values)
    numbers = [v for v in whole.data_vars.values() if v.dtype.kind == "f"]
    assert all("units" in array.attrs and "long_name" in array.attrs for array in numbers)


def test_simulated_correlations_reach_as_far_as_the_curves():
    np.testing.assert_allclose(SIMULATED_RATIOS[[0, -1]], RATIOS[[0, -1]])


@pytest.mark.parametrize("name", ["..", "", ".", "a/b.csv", "a\\b.csv", "a\0.csv", f"{'a' * 300}.csv"])
def test_a_name_of_an_upload_that_no_file_can_have_is_told(name):
    with pytest.raises(ValueError, match=r"the file name .* allowed: a name of 1 to 255 bytes") as told:
        open_case({"case.toml": sl.example_case().encode(), name: b""})
    assert tempfile.gettempdir() not in str(told.value)


def test_a_scatter_is_said_to_be_of_the_file_only_if_it_is(tmp_path):
    text = (
        sl.example_case()
        .replace('ground = "firm"', 'spectrum = "eurocode_8"')
        .replace('intensity = "0.01 m^2/s^3"', 'ag = "0.25 g"\nsoil = "C"')
    )
    for scatter, said in (
        ("", "the usual scatter of records, since the file has none"),
        ("scatter = 0.2\n", "as in the file"),
    ):
        path = tmp_path / "case.toml"
        path.write_text(text.replace("[motion]\n", f"[motion]\n{scatter}"), encoding="utf-8")
        _, notes = scene_of(sl.read_case(path))
        assert f"Motions scatter by {0.2 if scatter else 0.3}, {said};" in notes[0]


def figures(scene, tables):
    yield charts.spectra_figure(spectra(scene), (scene.period_1, scene.period_2))
    for simulated_rho in (None, tables["correlation"]):
        yield charts.correlation_figure(correlation(scene), simulated_rho)
    for table in (gap_rules(scene), tables["gaps"]):
        yield charts.gaps_figure(table)
    for table in (probability(scene), tables["probability"]):
        yield charts.probability_figure(table)


def test_figures_are_plain_and_told_apart_without_colour(simulated):
    for figure in figures(Scene(paths=128), simulated[0]):
        json.dumps(figure, allow_nan=False)
        lines = [curve["line"]["dash"] for curve in figure["data"] if "dash" in curve.get("line", {})]
        assert len(set(lines)) == len(lines)
        assert figure["data"]


def test_errors_are_drawn_where_there_are_some(simulated):
    tables = simulated[0]
    rho = charts.correlation_figure(correlation(Scene()), tables["correlation"])["data"][-1]
    error = tables["correlation"].rho_standard_error.values
    np.testing.assert_allclose(rho["error_y"]["array"], 1.96 * error)
    star = charts.gaps_figure(tables["gaps"])["data"][0]
    interval = [100 * float(tables["gaps"][f"gap_{end}"][0]) for end in ("lower", "upper")]
    assert star["x"][0] - star["error_x"]["arrayminus"][0] == pytest.approx(interval[0])
    assert star["x"][0] + star["error_x"]["array"][0] == pytest.approx(interval[1])


def test_rules_of_a_kind_share_a_line_until_each_is_to_have_its_own(simulated):
    table, tables = gap_rules(Scene(paths=128)), simulated[0]
    for below in (None, tables["gaps"]):
        few, every = (charts.gaps_figure(table, None, below, one) for one in (False, True))
        lines, all_lines = (len(one["layout"]["yaxis"]["categoryarray"]) for one in (few, every))
        assert lines <= 7 < all_lines
        of_codes = few["data"][-1]
        assert len(set(of_codes["y"])) == 1
        assert "SRSS" in of_codes["hovertext"]
        assert not any(of_codes["text"])
        shown = table if below is None else below
        known = shown.gap.where((shown.kind == "code") & (shown.gap < 0.5), drop=True)  # not far off
        np.testing.assert_allclose(sorted(of_codes["x"]), np.sort(100 * known))
    assert "simulation" in few["layout"]["yaxis"]["categoryarray"]


def test_words_caution_where_linearization_is_unsafe():
    assert words.caution(correlation(ELASTIC)) == (
        "Both buildings stay elastic: linearization is exact here.",
        "",
    )
    known, why = words.caution(correlation(Scene(**LAKEBED, period_1=1.5, period_2=1.0)))
    assert "linearization alone is unsafe" in known
    assert "too small for building 1" in known
    assert "stochlin verify" in why
    assert "is not known here" in words.caution(correlation(Scene(site="firm")))[0]


def test_every_number_of_a_scene_has_a_control_whose_slider_is_allowed():
    assert set(NUMBERS) == {*ALLOWED, *WHOLE}
    names = [control.name for group in GROUPS for control in group.controls]
    assert len(set(names)) == len(names)
    for control in NUMBERS.values():
        for text in (f"{control.low}", f"{control.high}", control.text(Scene())):
            assert isinstance(control.read(text), (int, float))
        scale = SCALES.get(control.unit, 1.0)
        assert control.low <= scale * getattr(Scene(), control.name) <= control.high


@pytest.mark.parametrize("control", NUMBERS.values(), ids=NUMBERS)
@pytest.mark.parametrize(
    "text", ["", None, "abc", "-1", "nan", "inf", "1e400", "__import__('os')", "1 2"]
)
def test_entries_that_cannot_be_read_say_what_is_allowed(control: Control, text):
    with pytest.raises(ValueError, match="allowed"):
        control.read(text)


def test_controls_without_a_say_are_hidden():
    values = dataclasses.asdict(Scene())
    assert not counts("ground_period", values)
    assert counts("rise_end", values)
    assert not counts("power", values)
    assert counts("decay", values | {"envelope": "gamma"})
    assert counts("high_pass_period", values | {"site": "clough_penzien"})
    assert not counts("high_pass_period", values | {"site": "kanai_tajimi"})
    assert not counts("hardening_2", values | {"yields_2": False})
    assert counts("period_2", values | {"yields_2": False})
