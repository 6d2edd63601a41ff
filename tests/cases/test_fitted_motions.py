"""Case files with ground fitted to a record: motions carry its energy, or a warning says not."""

from __future__ import annotations

import math
import warnings
from pathlib import Path

import pytest
from cases import example_case
from motions import write_at2

import stochlin as sl
from stochlin.applications.cases.reading.case import Case
from stochlin.views.shared.words import scatter

pytestmark = pytest.mark.invariant

EXAMPLE = example_case()
SITE = '[site]\nground = "fitted"\n{more}[[site.records]]\npath = "wave.at2"\n\n'
FITTED = '[motion]\nenvelope = "fitted"\n'
ENVELOPE = sl.AminAng(3.0, 10.0, 0.3)


def read(folder: Path, motion: str, more: str = "") -> Case:
    """The example at the site of a record, with another motion."""
    whole = sl.simulated_motions(sl.named_ground("firm", 0.01), 25.0, ENVELOPE, paths=2)[0]
    write_at2(whole, folder / "wave.at2")
    start, end = EXAMPLE.index("[site]"), EXAMPLE.index("[building_1]")
    path = folder / "case.toml"
    text = f"{EXAMPLE[:start]}{SITE.format(more=more)}{motion}\n{EXAMPLE[end:]}"
    path.write_text(text.replace("paths = 2048", "paths = 128"), encoding="utf-8")
    return sl.read_case(path)


@pytest.fixture(scope="module")
def fitted(tmp_path_factory: pytest.TempPathFactory) -> Case:
    return read(tmp_path_factory.mktemp("fitted"), FITTED, "filters = 1\n")


@pytest.mark.slow
def test_a_fitted_envelope_brings_ground_and_duration_with_it(fitted: Case) -> None:
    (record,) = fitted.site.records.values()
    expected = sl.fit_motion(record, filters=1)
    course = fitted.site.course
    assert (fitted.site.ground, course.envelope) == (expected.ground, expected.envelope)
    assert course.duration == expected.duration == pytest.approx(25.0, rel=0.01)


def read_both(folder: Path, second: str, lines: str = "components = 2\n") -> Case:
    """The example at the site of two records; the second one is a change of the first."""
    read(folder, FITTED)
    wave = sl.read_record(folder / "wave.at2")
    write_at2(wave[:-20] if second == "short" else 1.5 * wave, folder / "other.at2")
    text = (folder / "case.toml").read_text(encoding="utf-8")
    text = text.replace(
        'path = "wave.at2"', 'path = "wave.at2"\n\n[[site.records]]\npath = "other.at2"'
    )
    text = text.replace(FITTED, f"{FITTED}{lines}")
    (folder / "case.toml").write_text(text, encoding="utf-8")
    return sl.read_case(folder / "case.toml")


@pytest.mark.filterwarnings("ignore:.*are the same motion")
@pytest.mark.slow
def test_ground_and_scatter_come_from_both_components(tmp_path: Path) -> None:
    case = read_both(tmp_path, "loud")
    motion = sl.fit_motion(list(case.site.records.values()), filters=2)
    assert (case.site.ground, case.site.course.envelope) == (motion.ground, motion.envelope)
    assert (
        case.site.scatter == motion.scatter == pytest.approx(math.log(1.5) / math.sqrt(2), rel=1e-6)
    )
    assert "between both components" in scatter(case)


def test_of_one_component_the_scatter_is_that_of_the_other(fitted: Case) -> None:
    assert fitted.site.scatter == 0.4
    assert "the other component of a station" in scatter(fitted)


def test_components_that_are_none_are_refused(tmp_path: Path) -> None:
    case = read_both(tmp_path, "short")
    with pytest.raises(
        ValueError, match=r"motion.envelope = 'fitted' .* sample counts 2501 and 2481"
    ):
        _ = case.site.course
    read(tmp_path, FITTED)
    path = tmp_path / "case.toml"
    text = path.read_text(encoding="utf-8").replace(FITTED, f"{FITTED}components = 2\n")
    path.write_text(text, encoding="utf-8")
    with pytest.raises(
        ValueError, match=r"site.ground = 'fitted' needs .*; allowed: 2 \[\[site.records\]\]"
    ):
        sl.read_case(path)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("duration", "envelope"),
    [
        ("25 s", 'envelope = "shinozuka_sato"\nslow = "0.2 1/s"\nfast = "1.5 1/s"\n'),  # too weak
        ("100 s", ""),  # stationary all along: too strong
    ],
)
def test_an_envelope_that_misses_the_energy_of_the_record_is_told(
    tmp_path: Path, duration: str, envelope: str
) -> None:
    text = f'[motion]\nduration = "{duration}"\n{envelope}'
    case = read(tmp_path, text)
    with pytest.warns(
        UserWarning, match=r"motion.envelope.* times the energy of the record"
    ) as found:
        _ = case.site.ground
    told = float(str(found[0].message).partition("motions with ")[2].partition(" times")[0])
    (record,) = case.site.records.values()
    course = case.site.course.duration, case.site.course.envelope
    motions = sl.simulated_motions(case.site.ground, *course, paths=256, scatter=0.0)
    ratio = float((motions**2).integrate("time").mean() / (record**2).integrate("time"))
    assert not 0.8 <= told <= 1.25
    assert ratio == pytest.approx(told, rel=0.08)  # 256 motions, two digits told


def test_an_envelope_like_that_of_the_record_is_not(tmp_path: Path) -> None:
    names = ("rise_end", "strong_end", "decay")
    lines = [
        f'{name} = "{getattr(ENVELOPE, name)} {"1/s" if name == "decay" else "s"}"'
        for name in names
    ]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        read(tmp_path, "\n".join(['[motion]\nduration = "25 s"', 'envelope = "amin_ang"', *lines]))
