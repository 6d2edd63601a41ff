"""The site of a case file by what an engineer knows, and the shaking that answers print."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
import scipy.stats
import xarray as xr
from cases import example_case, read_text
from motions import write_at2

import stochlin as sl
from stochlin.applications.cases.reading.case import Case
from stochlin.applications.cases.rows import motion_of
from stochlin.applications.cases.separation import answer_case
from stochlin.applications.cases.shaking import doubts, recorded_shaking, shaking_of
from stochlin.views.shared.words import files_taken, scatter

pytestmark = pytest.mark.invariant

G = 9.80665
EXAMPLE = example_case().replace("paths = 2048", "paths = 256")
# Fits take as long as the motion.
SHORT = EXAMPLE.replace('duration = "20 s"', 'duration = "5 s"').replace('"15 s"', '"4.5 s"')
ALONE = EXAMPLE.replace('existing = "5 cm"', "")
SHAPE = sl.AminAng(4.0, 15.0, 0.35)
QUAKE = {"duration": 20.0, "envelope": SHAPE}
FIRM = 'ground = "firm"\n'
HAZARD = f'{FIRM}return_period = "475 yr"\n[site.hazard]\nmeasure = "pga"\n'
MOTIONS = sl.simulated_motions(sl.named_ground("firm", 0.01), **QUAKE, paths=12, seed=3)


def test_intensity_of_a_sine_in_closed_form() -> None:
    """Of amplitude a: PGA a, rms a/sqrt(2), and a spectral acceleration a/(2 xi) at resonance."""
    time = 0.005 * np.arange(8001)
    record = xr.DataArray(
        3.0 * np.sin(2 * np.pi * time), dims="time", coords={"time": time}, attrs={"units": "m/s^2"}
    )
    table = recorded_shaking(record, [1.0, 0.02, 1.0])
    assert float(table["peak_ground_acceleration"]) == pytest.approx(3.0)
    assert float(table["rms_acceleration"]) == pytest.approx(3.0 / np.sqrt(2), rel=1e-2)
    # The start has died out to exp(-2 pi xi 40); a stiff structure follows the ground.
    np.testing.assert_allclose(table["spectral_acceleration"], [30.0, 3.0, 30.0], rtol=1e-2)


def read(folder: Path, site: str, text: str = EXAMPLE) -> Case:
    start, end = text.index("[site]"), text.index("[motion]")
    return read_text(folder, f"{text[:start]}[site]\n{site}\n{text[end:]}")


@pytest.fixture(scope="module")
def suite(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("suite")
    (folder / "records").mkdir()
    for number, motion in enumerate(MOTIONS):
        path = folder / "records" / f"m{number:02d}.at2"
        write_at2(motion, path)
        rest = path.read_text(encoding="utf-8").split("\n")[2:]
        title = f"Quake {number // 2}, 1/1/2000, Place, {number % 2 * 90:03d}"  # two of a station
        path.write_text("\n".join(["PEER STRONG MOTION", title, *rest]), encoding="utf-8")
    (folder / "bad.txt").write_text("1\ntwo\n", encoding="utf-8")
    listed = ["records/m00.at2", "bad.txt", "records/m01.at2"]
    (folder / "suite.csv").write_text(
        "\n".join(["file,units,dt", *(f"{n},g,0.01" for n in listed)])
    )
    return folder


@pytest.mark.oracle
@pytest.mark.parametrize("key", ["pga", "sa"])
def test_motions_are_as_strong_as_the_file_asks(tmp_path, key):
    asked = {"pga": 'pga = "0.3 g"', "sa": 'sa = "0.3 g"\nsa_period = "0.6 s"'}[key]
    case = read(tmp_path, f'ground = "kanai_tajimi"\nperiod = "2 s"\ndamping = 0.1\n{asked}')
    table = sl.simulated_spectrum(case.site.ground, [0.6], **QUAKE, paths=512, seed=5)
    name = {"pga": "peak_ground_acceleration", "sa": "pseudo_acceleration"}[key]
    found, error = (float(table[f"{name}{end}"].item()) for end in ("", "_standard_error"))
    assert abs(found - 0.3 * G) < 4 * np.sqrt(1.5) * error
    assert "of 0.3 g in motions of 20 s" in case.site.ground.source


def test_a_ground_fitted_to_a_record_is_scaled_with_its_shape_kept(suite):
    site = 'ground = "fitted"\n{}[[site.records]]\npath = "records/m00.at2"\n'
    plain, scaled = (read(suite, site.format(extra)) for extra in ("", 'pga = "0.5 g"\n'))
    assert scaled.site.ground.period == plain.site.ground.period
    assert scaled.site.ground == sl.scale_ground(plain.site.ground, **QUAKE, pga=0.5 * G)
    stronger = read(suite, site.format("") + "scale = 2\n")
    assert stronger.site.ground.intensity == pytest.approx(
        4 * plain.site.ground.intensity, rel=1e-6
    )
    np.testing.assert_allclose(stronger.site.records["m00.at2"], 2 * plain.site.records["m00.at2"])


@pytest.mark.slow
def test_a_suite_is_scaled_to_the_spectrum_of_a_file(suite):
    code = sl.eurocode_8(0.25 * G, "B")[5::5]
    rows = [f"{float(one.period):g},{float(one) / G:.6f}" for one in code]
    (suite / "site.csv").write_text("\n".join(["T,Sa [g]", *rows]), encoding="utf-8")
    site = 'spectrum = "site.csv"\nelastic = true\nscale = 1.5\n[site.suite]\npath = "records"\n'
    case = read(suite, f'{site}scale_to = "spectrum"\nband = ["0.3 s", "1.5 s"]\n', SHORT)
    spectrum = sl.read_spectrum(suite / "site.csv", elastic=True)
    np.testing.assert_allclose(case.site.spectrum, 1.5 * spectrum)
    records = {f"m{n:02d}.at2": sl.read_record(suite / f"records/m{n:02d}.at2") for n in range(12)}
    expected = sl.scale_records(records, spectrum=case.site.spectrum, band=(0.3, 1.5))
    assert list(case.site.records) == list(expected)
    for name, record in expected.items():
        np.testing.assert_allclose(case.site.records[name], record, rtol=1e-12)


@pytest.mark.oracle
def test_a_return_period_by_hand(tmp_path):
    law = 'k0 = 1e-4\nk = 2\nunits = "g"\n'  # 1 g once in 10 000 years
    wanted = np.sqrt(1e-4 * 475)
    case = read(tmp_path, HAZARD + law)
    by_hand = sl.scale_ground(sl.named_ground("firm", 1.0), **QUAKE, pga=wanted * G)
    assert case.site.ground.intensity == pytest.approx(by_hand.intensity, rel=1e-13)
    (tmp_path / "hazard.csv").write_text("pga [g],annual frequency\n0.1,1e-2\n1.0,1e-4\n")
    again = read(tmp_path, HAZARD + 'file = "hazard.csv"\n')
    assert again.site.ground.intensity == pytest.approx(case.site.ground.intensity, rel=1e-9)
    assert tmp_path / "hazard.csv" in again.files
    at_a_second = HAZARD.replace('"pga"', '"sa"\nsa_period = "1 s"') + law
    assert "Sa(1 s)" in read(tmp_path, at_a_second).site.ground.source


def test_beyond_the_hazard_is_refused_with_its_range(tmp_path):
    (tmp_path / "h.csv").write_text("pga [g],f\n0.1,0.01\n0.2,0.004\n")
    with pytest.raises(
        ValueError, match=r"return_period = '475 yr' is not in the hazard: .*100 to 250"
    ):
        read(tmp_path, HAZARD + 'file = "h.csv"\n')


# --- Suites ---


SUITE = f'{FIRM}intensity = "0.01 m^2/s^3"\n[site.suite]\npath = "{{}}"\n'


def test_a_record_that_cannot_be_read_is_named_and_those_of_a_suite_are_files_of_the_case(suite):
    with pytest.raises(
        ValueError,
        match=r"case.toml, line \d+: site.suite.path = 'suite.csv' .*csv, line 3, bad.txt: .*'two'",
    ):
        read(suite, SUITE.format("suite.csv"))
    table = suite / "suite.csv"
    lines = table.read_text().splitlines()
    table.write_text("\n".join(line for line in lines if "bad" not in line))
    case = read(suite, SUITE.format("suite.csv"))
    assert list(case.site.records) == ["records/m00.at2", "records/m01.at2"]
    assert {suite / "suite.csv", suite / "records/m00.at2"} <= set(case.files)


def test_a_suite_is_scaled_as_in_python_and_stands_after_the_records(suite):
    record = '[[site.records]]\npath = "records/m00.at2"\nname = "alone"\nscale = 1.5\n'
    with pytest.warns(sl.DoubtfulInput, match=r"alone and m00\.at2 are the same motion"):
        case = read(suite, SUITE.format("records") + f'pga = "0.4 g"\n{record}')
    assert list(case.site.records)[:2] == ["alone", "m00.at2"]
    assert len(case.site.records) == 13
    peaks = [float(abs(record).max()) / G for record in case.site.records.values()]
    assert peaks[1:] == pytest.approx([0.4] * 12)
    assert case.site.records["alone"].attrs["scale"] == 1.5
    sa = read(suite, SUITE.format("records") + 'sa = "0.5 g"\nsa_period = "0.8 s"\n')
    found = sl.response_spectrum(list(sa.site.records.values()), 0.8, 0.05).pseudo_acceleration
    np.testing.assert_allclose(found / G, 0.5, rtol=1e-9)


@pytest.mark.slow
@pytest.mark.oracle
def test_many_records_have_quantiles_and_a_share(suite):
    case = read(suite, SUITE.format("records"), ALONE)
    found = answer_case(case)
    pair = [sl.Bilinear(T, 0.05, 0.05, reduction_factor=4) for T in (1.0, 0.6)]
    solid = []
    for structure in pair:
        strength = float(sl.linearize(structure, case.site.ground).yield_displacement)
        solid.append(sl.Bilinear(float(structure.period), 0.05, 0.05, yield_displacement=strength))
    gaps = sl.recorded_gap(*solid, dict(case.site.records)).separation.values
    table = found.table()
    answer = float(table.gap[0])
    np.testing.assert_allclose(table.record_gap_quantile, np.quantile(gaps, [0.5, 0.84, 0.9]))
    held = float(table.record_no_pounding_probability)
    ends = [float(table[f"record_no_pounding_probability_{end}"]) for end in ("lower", "upper")]
    low, high = (float(table[f"record_gap_quantile_{end}"][0]) for end in ("lower", "upper"))
    assert held == pytest.approx((gaps <= answer).mean())
    of_events = gaps.reshape(6, 2)  # of which a median is above the first with 98 %
    assert (low, high) == (of_events.min(axis=1).min(), of_events.max(axis=1).max())
    within = [(of(axis=1) <= answer).sum() for of in (of_events.max, of_events.min)]
    exact = [scipy.stats.binomtest(int(n), 6).proportion_ci(0.95) for n in within]
    assert ends == pytest.approx([exact[0].low, exact[1].high])


@pytest.mark.filterwarnings("ignore::stochlin.messages.DoubtfulInput")
def test_shaking_that_no_record_has_is_doubted(tmp_path):
    (doubt,) = doubts(shaking_of(read(tmp_path, f'{FIRM}intensity = "1.5 m^2/s^3"\n', ALONE)))
    assert re.match(r"peak ground acceleration: [34]\S* g, and usual are 0.05 to 1 g", doubt)


# --- Design spectra, and the scatter of motions ---


CODE = 'spectrum = "eurocode_8"\nag = "0.25 g"\nsoil = "C"\n'


@pytest.mark.slow
def test_the_ground_delivers_the_spectrum_in_the_motion_of_the_file(tmp_path):
    case = read(tmp_path, CODE + "filters = 1\n", SHORT)
    motion = {"duration": case.site.course.duration, "envelope": case.site.course.envelope}
    assert case.site.ground == sl.fit_ground(sl.eurocode_8(0.25 * G, "C"), filters=1, **motion)
    assert case.site.name == "eurocode_8"
    assert case.site.ground.scatter == case.site.scatter


STATEMENTS = {
    "elastic = true": (1.0, "elastic as stated"),
    "divided_by = 4": (4.0, "divided by 4, multiplied back"),
    'divided_by = {periods = ["0 s", "5 s"], factors = [2, 4]}': (
        lambda period: 2 + 0.4 * period,
        "divided by 2 to 3.5 over the period, multiplied back",
    ),
}


def spectrum_file(folder, divided):
    """Elastic, from 0 to 3.75 s, and divided by a factor."""
    code = sl.eurocode_8(0.25 * G, "B")[0:376:5]
    period = code.period.values
    values = code.values / G / (divided(period) if callable(divided) else divided)
    rows = [f"{t:.12g},{sa:.12g}" for t, sa in zip(period, values, strict=True)]
    (folder / "site.csv").write_text("\n".join(["T,Sa [g]", *rows]), encoding="utf-8")
    return code


@pytest.mark.cli
@pytest.mark.parametrize("line", STATEMENTS)
def test_the_spectrum_of_a_file_is_taken_as_the_case_file_says(line, tmp_path):
    divided, said = STATEMENTS[line]
    elastic = spectrum_file(tmp_path, divided)
    case = read(tmp_path, f'spectrum = "site.csv"\n{line}\n', SHORT)
    np.testing.assert_allclose(case.site.spectrum, elastic, rtol=1e-9)
    assert files_taken(case) == f"The spectrum of site.csv: PGA 0.3 g, plateau 0.75 g, {said}."


@pytest.mark.parametrize("text", [SHORT, SHORT.replace('existing = "5 cm"', "")])
def test_the_progress_of_an_answer_grows_to_its_end(text, tmp_path):
    shares = []
    answer_case(read_text(tmp_path, text), shares.append)
    assert (np.diff(shares) >= 0).all()
    assert shares[-1] == pytest.approx(1.0)


def test_what_was_taken_of_other_files_is_said(tmp_path):
    """Columns by their numbers, and what the hazard has for a design."""
    (tmp_path / "hazard.csv").write_text("level,often\n0.1,1e-2\n0.3,1e-3\n0.5,1e-4\n", "utf-8")
    rows = "\n".join(f"{0.02 * n:.2f},{np.sin(n / 3):.6f},{np.cos(n / 4):.6f}" for n in range(60))
    (tmp_path / "shaken.csv").write_text(f"time,x,y\n{rows}\n", "utf-8")
    lines = (
        'measure = "pga"\nfile = "hazard.csv"\nunits = "g"\nfrequency_column = 2\n'
        '[[site.records]]\npath = "shaken.csv"\nunits = "m/s^2"\ncolumn = 3\n'
    )
    case = read(tmp_path, f'{FIRM}pga = "0.3 g"\n[site.hazard]\n{lines}', SHORT)
    curve = case.site.hazard
    of_hazard = (
        "The hazard of hazard.csv; column 2 'often' is an annual frequency; "
        "with a return period of "
        f"475 years PGA {curve.intensity(475.0) / G:.3g}\u00a0g."
    )
    of_record = (
        "The record shaken.csv: column 3 'y' is an acceleration; peak 0.102\u00a0g, "
        "1.2\u00a0s in steps of 0.02\u00a0s."
    )
    assert files_taken(case) == f"{of_hazard} {of_record}"


@pytest.mark.cli
@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (
            "",
            "does not say whether it is elastic; "
            "allowed: the line elastic = true, or divided_by = 4",
        ),
        ("elastic = false\n", "does not say whether it is elastic; allowed: the line"),
        (
            "elastic = true\ndivided_by = 4\n",
            "as well as elastic; allowed: one of elastic, divided_by",
        ),
        ("divided_by = 0.5\n", r"divided_by = 0\.5 is out of range; allowed: 1 <= value"),
        (
            'divided_by = {periods = ["0 s"], factors = [1, 2]}\n',
            "factors = .* as many as periods, 1",
        ),
        (
            'divided_by = {periods = ["0 s", "1 s"], factors = [1, 2]}\n',
            "0 to 1 s; allowed: a table",
        ),
    ],
)
def test_a_spectrum_of_a_file_says_whether_it_is_elastic(lines, message, tmp_path):
    spectrum_file(tmp_path, 1.0)
    with pytest.raises(ValueError, match=message):
        read(tmp_path, f'spectrum = "site.csv"\n{lines}', SHORT)


@pytest.mark.invariant
def test_a_design_acceleration_above_the_plateau_is_doubted(tmp_path):
    spectrum_file(tmp_path, 4.0)
    wanted = SHORT.replace("[separation]", '[separation]\ndesign_pga = "0.3 g"', 1)
    with pytest.warns(
        sl.DoubtfulInput, match=r"design_pga = '0\.3 g' is above the plateau .* 0\.188 g"
    ):
        read(tmp_path, 'spectrum = "site.csv"\nelastic = true\n', wanted)


@pytest.mark.parametrize(
    ("site", "more", "value", "said"),
    [
        (f'{FIRM}intensity = "0.01 m^2/s^3"\n', "", 0.0, ""),
        (
            f'{FIRM}intensity = "0.01 m^2/s^3"\n',
            "scatter = 0.4",
            0.4,
            "the standard deviation 0.4 (scatter in [motion]).",
        ),
        (
            CODE,
            "",
            0.3,
            "the standard deviation 0.3 (suites of records about a spectrum, on the safe side).",
        ),
        (CODE, "scatter = 0", 0.0, ""),
    ],
)
def test_the_scatter_is_that_of_the_file_or_what_suites_show(site, more, value, said, tmp_path):
    """None where the strength of the ground is given."""
    case = read(tmp_path, site, SHORT.replace("[motion]", f"[motion]\n{more}", 1))
    assert case.site.scatter == motion_of(case)["scatter"] == value
    assert scatter(case).endswith(said)
    assert bool(scatter(case)) == bool(said)
