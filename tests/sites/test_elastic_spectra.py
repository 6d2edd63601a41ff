"""What a spectrum is, elastic or divided: spectra of codes by their formulas, and gaps by hand."""

import warnings
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from cases import with_slow

import stochlin as sl
from stochlin.applications.sites.elastic_spectra import doubt_of_pga, pga_of, taken_in_words
from stochlin.kernels.basics.arrays import Array

G = 9.80665
EVEN = np.round(0.05 * np.arange(81), 2)
RECORD = sl.simulated_motions(sl.named_ground("firm", 0.01), 8.0, paths=2)[0]
GROUND = sl.named_ground("firm", 0.01)


def written(folder: Path, period: Array, in_g: Array, name: str = "site.csv") -> Path:
    path = folder / name
    rows = [f"{t:.12g},{sa:.12g}" for t, sa in zip(period, in_g, strict=True)]
    path.write_text("\n".join(["T [s],Sa [g]", *rows]), encoding="utf-8")
    return path


def in_g(period: Array) -> Array:
    """Eurocode 8, type 1, ground B: PGA 0.4 g, plateau 1 g from 0.15 to 0.5 s, written out."""
    falling = np.minimum(1, 0.5 / np.maximum(period, 0.1)) * np.minimum(
        1, 2 / np.maximum(period, 0.1)
    )
    return np.where(period < 0.15, 0.4 + 4 * period, falling)


def peru(period: Array) -> Array:
    """E.030 (2018), article 28, without R: Z U C S, TP = 0.6 and TL = 2 s, from its plateau on."""
    after = np.maximum(period, 0.6)
    return 0.45 * 1.05 * 2.5 * 0.6 / after * np.minimum(1, 2 / after)


def colombia(period: Array) -> Array:
    """NSR-10, A.2.6: Aa = Av = 0.25, Fa = 1.15, Fv = 1.55, I = 1, from its plateau on."""
    corner, long = 0.48 * 1.55 / 1.15, 2.4 * 1.55
    after = np.maximum(period, corner)
    return 2.5 * 0.25 * 1.15 * corner / after * np.minimum(1, long / after)


def india(period: Array) -> Array:
    """IS 1893-1 (2016), 6.4.2, medium soil, without R: Z/2 times Sa/g, constant from 4 s on."""
    shape = np.where(period < 0.1, 1 + 15 * period, np.minimum(2.5, 1.36 / np.maximum(period, 0.1)))
    return 0.18 * np.where(period < 4, shape, 0.34)


LONG = np.round(0.05 * np.arange(121), 2)
OF_CANADA = np.array([0.0, 0.2, 0.5, 1.0, 2.0])
CANADA_2015 = np.array([*OF_CANADA, 5.0, 10.0]), np.array([0.9, 0.9, 0.5, 0.26, 0.12, 0.03, 0.01])
CANADA_2010 = np.array([*OF_CANADA, 4.0, 10.0]), np.array([0.9, 0.9, 0.5, 0.26, 0.12, 0.06, 0.06])
CODES = {
    "Peru": (LONG, peru(LONG)),
    "Colombia": (LONG, colombia(LONG)),
    "India": (LONG, india(LONG)),
    "Canada, NBC 2015, 4.1.8.4": CANADA_2015,
    "Canada, NBC 2010, 4.1.8.4, constant from 4 s on": CANADA_2010,
}


@pytest.mark.oracle
@pytest.mark.parametrize("name", CODES)
def test_elastic_spectra_of_codes_are_read_without_a_doubt(name: str, tmp_path: Path) -> None:
    period, ordinates = CODES[name]
    spectrum = sl.read_spectrum(
        written(tmp_path, period, ordinates), elastic=True, between="linear"
    )
    np.testing.assert_allclose(spectrum.sel(period=period) / G, ordinates, rtol=1e-9)
    begins = pga_of(spectrum)
    assert (begins is None) == (name != "India")
    assert begins is None or begins == pytest.approx(0.18 * G)


TABLE = xr.DataArray([1.0, 4.0, 4.0, 2.0], dims="period", coords={"period": [0.0, 0.15, 2.0, 4.0]})
WAYS = {
    "elastic": (1.0, {"elastic": True}, "elastic as stated"),
    "by a number": (4.0, {"divided_by": 4}, "divided by 4, multiplied back"),
    "by a table": (
        np.interp(EVEN, TABLE.period, TABLE),
        {"divided_by": TABLE},
        "divided by 1 to 4 over the period, multiplied back",
    ),
}


@pytest.mark.oracle
@pytest.mark.parametrize("way", WAYS)
def test_the_gap_is_that_of_both_elastic_displacements_by_hand(way: str, tmp_path: Path) -> None:
    """Sa (T/2 pi)^2 at 0.4 and 1 s, 1 g and 0.5 g: whatever divided the file, if that is said."""
    divided, said, words = WAYS[way]
    spectrum = sl.read_spectrum(written(tmp_path, EVEN, in_g(EVEN) / divided), **said)
    assert taken_in_words(spectrum) == f"PGA 0.4 g, plateau 1 g, {words}"
    pair = {"modes_1": sl.Bilinear(0.4, 0.05), "modes_2": sl.Bilinear(1.0, 0.05)}
    table = sl.code_gaps(**pair, spectrum=spectrum)
    by_hand = np.hypot(G * (0.4 / (2 * np.pi)) ** 2, 0.5 * G * (1.0 / (2 * np.pi)) ** 2)
    assert float(table.gap.sel(rule="srss")) == pytest.approx(by_hand, rel=1e-9)
    assert by_hand == pytest.approx(0.130406, rel=1e-5)  # m
    assert table.attrs["spectrum"] == f"site.csv (PGA 0.4 g, plateau 1 g, {words})"


def spectrum_of(
    period: Array = EVEN, divided: float | Array = 1.0, **attrs: object
) -> xr.DataArray:
    """An array that says nothing itself."""
    values = G * in_g(period) / divided
    about = {"units": "m/s^2", "damping": 0.05, "source": "mine"} | attrs
    return xr.DataArray(values, dims="period", coords={"period": period}, attrs=about)


@pytest.mark.invariant
def test_what_contradicts_an_elastic_spectrum_is_asked_about() -> None:
    code = sl.eurocode_8(0.25 * G, "C")
    with pytest.warns(
        sl.DoubtfulInput, match=r"its ordinates are 0.333 of those .* is it divided by 3"
    ):
        sl.code_gaps(modes_1=sl.Bilinear(0.4, 0.05), spectrum=code / 3, elastic=True)
    with pytest.warns(sl.DoubtfulInput, match="at 0 s is exactly 1 g; are ordinates divided by"):
        sl.code_gaps(modes_1=sl.Bilinear(0.4, 0.05), spectrum=spectrum_of() / 0.4, elastic=True)


@pytest.mark.invariant
@pytest.mark.parametrize(
    "title",
    ["Sa/PGA", "Se/ag [-]", "Sa/R [g]", "Sa design q=3 [g]", "Sa SRSS [g]", "Sa vertical [g]"],
)
def test_a_title_of_another_spectrum_is_not_taken_by_itself(title: str, tmp_path: Path) -> None:
    path = written(tmp_path, EVEN, in_g(EVEN))
    text = path.read_text().splitlines()
    path.write_text("\n".join([f"T [s],{title}", *text[1:]]))
    with pytest.raises(ValueError, match=r"column") as refused:
        sl.read_spectrum(path, units="g", elastic=True)
    assert title in str(refused.value)


USES = {
    "fit_ground": lambda spectrum, **said: sl.fit_ground(spectrum, duration=8.0, filters=1, **said),
    "simulated_spectrum": lambda spectrum, **said: (
        sl.simulated_spectrum(GROUND, spectrum, 8.0, paths=32, **said).target
    ),
    "scale_records": lambda spectrum, **said: sl.scale_records(
        {"a": RECORD}, spectrum=spectrum, **said
    ),
    "code_gaps": lambda spectrum, **said: (
        sl.code_gaps(modes_1=sl.Bilinear(0.4, 0.05), spectrum=spectrum, **said).peak_1
    ),
}


@pytest.mark.invariant
@pytest.mark.parametrize("use", with_slow(USES, {"fit_ground"}))
def test_an_array_says_once_what_it_is(use: str) -> None:
    with pytest.warns(
        sl.DoubtfulInput, match=r"mine: nothing says that it is elastic \(PGA 0.4 g, pl"
    ):
        USES[use](spectrum_of())
    whole, quarter = (
        USES[use](spectrum_of(), elastic=True),
        USES[use](spectrum_of(divided=4), divided_by=4),
    )
    if use == "fit_ground":
        assert whole == quarter
        assert "PGA 0.4 g, plateau 1 g, divided by 4, multiplied back" in quarter.source
        return
    whole, quarter = (each["a"] if isinstance(each, dict) else each for each in (whole, quarter))
    np.testing.assert_allclose(whole, quarter, rtol=1e-12)


@pytest.mark.invariant
@pytest.mark.parametrize("store", ["netcdf", "zarr"])
def test_what_a_spectrum_is_survives_files_and_is_not_said_twice(
    store: str, tmp_path: Path
) -> None:
    spectrum = sl.read_spectrum(written(tmp_path, EVEN, in_g(EVEN) / 4), divided_by=4).rename("sa")
    if store == "netcdf":
        spectrum.to_netcdf(tmp_path / "kept.nc")
        loaded = xr.load_dataarray(tmp_path / "kept.nc")
    else:
        spectrum.to_dataset().to_zarr(tmp_path / "kept", consolidated=False)
        loaded = xr.open_zarr(tmp_path / "kept", consolidated=False).sa.load()
    assert loaded.attrs["elastic"] == "divided by 4, multiplied back"
    USES["code_gaps"](loaded)
    with pytest.raises(
        ValueError, match="divided_by is given, and spectrum says that it is divided by 4"
    ):
        USES["code_gaps"](loaded, divided_by=4)


@pytest.mark.invariant
def test_a_code_spectrum_that_is_divided_in_python_no_longer_counts_as_elastic() -> None:
    """Arithmetic keeps attributes; a least behaviour factor of 1.5 is seen."""
    for code in (sl.eurocode_8(2.0, "C"), sl.asce_7(10.0, 6.0, 8.0)):
        assert code.attrs["elastic"] == "elastic by its code"
        for elastic in (code, 1.4 * code, code[::20], code.sel(period=slice(1, 3))):
            USES["code_gaps"](elastic.sel(period=slice(0.0, 3)))
        reduced = code / 1.5
        with pytest.warns(
            sl.DoubtfulInput, match=r"its ordinates are 0\.667 of those that were elastic"
        ):
            USES["code_gaps"](reduced)
        same = USES["code_gaps"](reduced, divided_by=1.5)
        np.testing.assert_allclose(same, USES["code_gaps"](code), rtol=1e-12)


@pytest.mark.invariant
@pytest.mark.parametrize(
    ("divisor", "level", "said"),
    [
        (
            np.interp(EVEN, [0, 0.15], [1, 4]),
            0.0,
            "plateau of 0.4 g is 1 times its ordinate of 0.4 g at 0 s",
        ),
        (
            np.interp(EVEN, [0, 0.15], [1, 2]),
            0.0,
            r"1\.25 times .* rise to 2\.12 times \(Newmark and Hall",
        ),
        (2.0, 0.1, r"level at 0\.1 g from 2\.25 s on"),
    ],
)
def test_a_shape_that_no_elastic_spectrum_has_is_doubted(divisor, level, said, tmp_path) -> None:
    """Also where the file is said to be elastic."""
    path = written(tmp_path, EVEN, np.maximum(in_g(EVEN) / divisor, level))
    with pytest.warns(sl.DoubtfulInput, match=said):
        sl.read_spectrum(path, elastic=True)


@pytest.mark.invariant
def test_a_plateau_below_the_peak_ground_acceleration_is_doubted() -> None:
    divided = spectrum_of(divided=4)
    assert "above the plateau of the spectrum, 0.25 g; is that divided" in doubt_of_pga(
        divided, 0.4 * G
    )
    assert doubt_of_pga(spectrum_of(), 0.4 * G) == ""
    with pytest.warns(sl.DoubtfulInput, match=r"design_pga = 3\.92266 is above the plateau"):
        USES["code_gaps"](divided, elastic=True, design_pga=0.4 * G)


@pytest.mark.invariant
@pytest.mark.parametrize(
    ("said", "message"),
    [
        ({"elastic": False}, "elastic = False is given alone; allowed: divided_by="),
        ({"elastic": True, "divided_by": 4}, "elastic = True is given beside divided_by"),
        (
            {"divided_by": 0.25},
            r"divided_by = 0\.25 is out of range; allowed: a number of at least 1",
        ),
        (
            {"divided_by": TABLE[:3]},
            "divided_by has 0 to 2 s; allowed: a table for all periods .*, 0 to 4 s",
        ),
        (
            {"divided_by": TABLE[::-1]},
            "divided_by is not such a table; allowed: numbers of at least 1",
        ),
        ({"divided_by": TABLE.rename(period="time")}, r"dimensions \('time',\); allowed"),
    ],
)
def test_what_contradicts_itself_is_refused(said, message, tmp_path) -> None:
    with pytest.raises(ValueError, match=message):
        sl.read_spectrum(written(tmp_path, EVEN, in_g(EVEN)), **said)


@pytest.mark.invariant
def test_no_spectrum_takes_no_statement() -> None:
    for call in (
        lambda: sl.fit_ground(RECORD, elastic=True),
        lambda: sl.simulated_spectrum(GROUND, [0.5], 8.0, divided_by=4),
        lambda: sl.scale_records({"a": RECORD}, pga=1.0, elastic=True),
        lambda: sl.code_gaps(0.1, 0.2, elastic=True),
    ):
        with pytest.raises(ValueError, match=r"(elastic|divided_by) = .* does not apply"):
            call()


@pytest.mark.invariant
@pytest.mark.parametrize(
    ("remark", "said", "asked"),
    [
        ("# damping 2 %", {}, "line 1: '# damping 2 %'; is damping=0.02, and not 0.05"),
        ("# damping 2 %", {"damping": 0.02}, ""),
        ("# xi = 0.05, damped", {}, ""),
        ("% design spectrum, q = 3,9", {}, "are its ordinates divided by it, divided_by=3.9"),
        ("Zone Z2 soil S1 R: 8", {}, "are its ordinates divided by it, divided_by=8"),
        ("# q = 3", {"divided_by": 3.0}, ""),
        ("# 10 % in 50 years, R = 475 years", {}, ""),
        ("# probability 10 %", {}, ""),
    ],
)
def test_what_a_remark_says_of_damping_and_factor_is_asked_about(tmp_path, remark, said, asked):
    path = written(tmp_path, EVEN, in_g(EVEN))
    path.write_text(f"{remark}\n{path.read_text(encoding='utf-8')}", encoding="utf-8")
    said = said if "divided_by" in said else said | {"elastic": True}
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", sl.DoubtfulInput)
        sl.read_spectrum(path, **said)
    texts = [str(each.message) for each in caught]
    assert len(texts) == bool(asked)
    assert asked in "".join(texts)
