"""Uploaded case files: kept with the files that they name, and refused in their reader's words."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from cases import example_of_short_motion
from uploads import open_case

import stochlin as sl
from stochlin.applications.cases.examples import example_record, short_example
from stochlin.applications.explorer.uploads import of_file, read_upload, uploaded

pytestmark = pytest.mark.invariant

SITE = 'ground = "firm"\nintensity = "0.01 m^2/s^3"\n'


def with_site(site: str) -> str:
    text = example_of_short_motion()
    start, end = text.index("[site]"), text.index("[motion]")
    return f"{text[:start]}[site]\n{site}\n{text[end:]}"


def record_in(folder: Path) -> Path:
    folder.mkdir(exist_ok=True)
    (folder / "a.at2").write_text(example_record(), encoding="utf-8")
    return folder / "a.at2"


def test_a_case_is_opened_with_the_files_that_it_names(tmp_path):
    record = record_in(tmp_path / "records").read_bytes()
    text = with_site(f'{SITE}[[site.records]]\npath = "records/a.at2"\n')
    (tmp_path / "case.toml").write_text(text, encoding="utf-8")
    original = sl.read_case(tmp_path / "case.toml")
    files = {"case.toml": text.replace("records/", "").encode(), "a.at2": record}
    case, doubts = open_case(files)
    assert doubts == []
    np.testing.assert_array_equal(case.site.records["a.at2"], original.site.records["a.at2"])
    there = of_file(tmp_path / "case.toml")
    assert there.text == text
    again, _ = read_upload(there.folder, there.name, there.text)
    np.testing.assert_array_equal(again.site.records["a.at2"], original.site.records["a.at2"])
    there.remove()
    assert record_in(tmp_path / "records").exists()
    del files["a.at2"]
    with pytest.raises(
        ValueError, match=r"line \d+: site.records.path = .*choose the case file together"
    ) as refusal:
        open_case(files)
    assert "tmp" not in str(refusal.value)


@pytest.mark.parametrize(
    ("files", "message"),
    [
        ({}, "0 case files are chosen; allowed: one"),
        ({"a.toml": b"", "b.toml": b""}, "2 case files are chosen"),
        ({"a.toml": b"\xff\xfe"}, "a.toml is no TOML file"),
        ({"a.toml": b"[site"}, "a.toml, line 1: '.site' is no TOML file's text"),
        ({"a.toml": b'x = "' + b"a/" * 1500 + b'b"', "b": b""}, "line 1: x = 'a/a.* is not a key"),
    ],
)
def test_what_is_no_case_is_refused_in_the_words_of_its_reader(files, message):
    with pytest.raises(ValueError, match=message):
        open_case(files)


def test_a_case_stays_in_its_folder(tmp_path):
    upload = uploaded({"a/../../case.toml": short_example().encode(), "/b/../../a.csv": b""})
    assert sorted(each.name for each in Path(upload.folder).iterdir()) == ["a.csv", "case.toml"]
    upload.remove()
    for name in ("../a.at2", "/etc/hostname", ".."):
        text = with_site(f'{SITE}[[site.records]]\npath = "{name}"\n')
        (tmp_path / "case.toml").write_text(text, encoding="utf-8")
        for opened, named in (
            (of_file, tmp_path / "case.toml"),
            (open_case, {"case.toml": text.encode()}),
        ):
            with pytest.raises(ValueError, match="is outside of the folder of the case file"):
                opened(named)


def test_a_file_that_changes_is_read_again(tmp_path):
    """Also when the text of site and motion stays; the strength grows with the motion squared."""

    def strength(text):
        case, _ = read_upload(str(tmp_path), "case.toml", text)
        return case.site.ground.intensity

    record = tmp_path / "a.csv"
    samples = sl.read_record(record_in(tmp_path))
    of_record = f'path = "a.csv"\ndt = "{float(samples.time[1])} s"\n'
    text = with_site(f'ground = "fitted"\n[[site.records]]\n{of_record}')
    fitted = []
    for factor, other in ((1, text), (10, text), (10, text.replace("5 cm", "6 cm")), (1, text)):
        record.write_text(
            "acc [m/s2]\n" + "\n".join(f"{factor * each:.9f}" for each in samples.values)
        )
        fitted.append(strength(other))
    assert fitted[1] == pytest.approx(100 * fitted[0], rel=1e-3)
    assert fitted[2:] == [fitted[1], fitted[0]]


def test_what_is_fitted_to_a_site_is_fitted_once(tmp_path):
    """And a warning on the site is given with each text, with that on the file."""
    text = with_site('spectrum = "eurocode_8"\nag = "4 g"\nsoil = "C"\nfilters = 1\n')
    before, doubts = read_upload(str(tmp_path), "case.toml", text)
    assert ["site.ag = '4 g' is doubtful" in doubt for doubt in doubts] == [True]
    other = text.replace('existing = "5 cm"', 'existing = "4 m"')
    case, doubts = read_upload(str(tmp_path), "case.toml", other)
    assert case.site is before.site
    assert "separation.existing = '4 m' is doubtful" in doubts[0]
    assert "site.ag" in doubts[1]
    firm, doubts = read_upload(str(tmp_path), "case.toml", with_site(SITE))
    assert doubts == []
    assert firm.site is not before.site
