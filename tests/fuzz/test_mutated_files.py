"""Case files, records and hazards, mutated: a result, or one line that says what is wrong.

A minute or so; with ``FUZZ_TIMES=60`` in the environment an hour, with other examples each time.
"""

import gzip
import os
import re
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import samples
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import stochlin as sl
from stochlin.applications.cases.examples import short_example
from stochlin.messages import LONGEST_MESSAGE

pytestmark = [pytest.mark.invariant, pytest.mark.slow]

ANSWERS = Path(__file__).parents[1] / "answers"
LONGEST = 10.0  # s of computing for one file
TIMES = int(os.environ.get("FUZZ_TIMES", "1"))  # as many examples as usual
INNER = re.compile(
    r"Traceback|YieldingPair|LinearPair|DuctilityTarget| object at 0x|NoneType|numpy\.|ufunc"
)
WAVE = 0.1 * np.sin(np.arange(60) / 3)

RECORDS = {
    "one.txt": "\n".join(f"{value:.5f}" for value in WAVE),
    "two.csv": "time,acc [g]\n"
    + "\n".join(f"{0.02 * n:.2f},{value:.5f}" for n, value in enumerate(WAVE)),
    "tab.txt": "# a record\n"
    + "\n".join(f"{0.02 * n:.2f}\t{value:.3E}" for n, value in enumerate(WAVE)),
    "peer.at2": "PEER\nSomewhere\nACCELERATION IN UNITS OF G\nNPTS= 60, DT= .0200 SEC\n"
    + "\n".join("".join(f"{value:15.6E}" for value in row) for row in WAVE.reshape(-1, 5)),
    "old.at2": "A\nB\nC\n 60 0.0200 NPTS, DT\n" + " ".join(f"{value:.6f}" for value in WAVE),
}
CHANNELS = {"90 Deg": WAVE, "Up": WAVE}
FORMATS = [
    samples.knet(np.round(1e4 * WAVE)),
    samples.esm(WAVE),
    samples.unam([WAVE, WAVE], "/V/N00E"),
    samples.csmip(CHANNELS),
    samples.cosmos(CHANNELS),
    "t [s];acc [g]\n"
    + "\n".join(f"{0.02 * n:.2f};{x:.5f}" for n, x in enumerate(WAVE)).replace(".", ","),
]
OPTIONS = (
    {},
    {"dt": 0.02, "units": "g"},
    {"units": "g", "column": 2, "time_column": 1},
    {"component": 1},
)


CASES = [path.read_text(encoding="utf-8") for path in sorted(ANSWERS.glob("*/*.toml"))]
CASES = [short_example(), *(text for text in CASES if "[separation]" in text)]

# What is put in the place of a value, of a word, or between two; and lines.
VALUES = """nan|inf|0|-1|1e999|-1e-320|0x10|true|""|"1"|"5 cm"|"1e999 s"|"nan s"|"5 furlong"
"fitted"|[]
[1, 2]|["5 cm", "3 cm"]|{}|{ model = "hertz" }|[[1], [1, 2]]|1979-05-27|"none"|"clough_penzien"
"kelvin"
"bouc_wen"|"hertz_damp"|"../../etc/passwd"|"a\\u001b[2J"|=|#|[|]]|.|,|;|NPTS|DT|E|D"""
SIGNS = ["'''", '"' * 3, "\r\n", "\x1b[2J", *"\n\x00\ufeff\u2028\u202eé\U0001f3e2"]
PIECES = [
    *re.split(r"[|\n]", VALUES),
    *SIGNS,
    " ",
    "\t",
    "1" + "0" * 400,
    "9" * 5000,
    f'"{"A" * 5000}"',
]
LINES = """elastic = true|law = "bouc_wen"|beta = 1e-9|exponent = 200|ductility = 1e9|seed = -1
paths = 1|existing = 5|storys = 8|[building_3]|[[site.records]]|[site]|storey_height = "3 m"
zone = "II"
heights = ["4 m", "3 m"]|floor_mass = "400 t"|base_shear_coefficient = 1e9
yield_drifts = ["9 m", "1 mm"]
dampers = ["1 MN s/m"]|p_delta = true|beta = [0.5, 0.5]|link.floors = [9, 1]|[measures.x]
a.b.c = 1"""


@st.composite
def mutated(draw: st.DrawFn, texts: list[str]) -> str:
    """One of the texts with a few changes."""
    text = draw(st.sampled_from(texts))
    for _ in range(draw(st.integers(1, 4))):
        lines = text.split("\n")
        here = draw(st.integers(0, len(lines) - 1))
        kind = draw(st.integers(0, 8))
        if kind <= 2:  # another value
            key, equals, _ = lines[here].partition("=")
            lines[here] = f"{key}{equals} {draw(st.sampled_from(PIECES))}"
        elif kind == 3:
            lines[here : here + draw(st.integers(1, 3))] = []
        elif kind == 4:
            lines.insert(here, draw(st.sampled_from(re.split(r"[|\n]", LINES))))
        elif kind == 5:
            lines.insert(draw(st.integers(0, len(lines))), lines[here])
        else:  # within a line
            start = draw(st.integers(0, len(lines[here])))
            end = start + draw(st.integers(0, 3))
            new = draw(st.one_of(st.sampled_from(PIECES), st.text(max_size=3)))
            lines[here] = lines[here][:start] + new + lines[here][end:]
        text = "\n".join(lines)
    return text


def written(path: Path, text: str) -> Path:
    path.write_bytes(text.encode("utf-8", errors="surrogatepass"))
    return path


def check(call: Callable[[], object]) -> None:
    """A result, or an error that says in a line what is wrong."""
    began = time.process_time()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)
            call()
    except (ValueError, TypeError, ArithmeticError, OSError) as error:
        said = str(error)
        assert said
        assert said.isprintable(), said
        assert len(said) < LONGEST_MESSAGE
        assert not INNER.search(said), said
    assert time.process_time() - began < LONGEST


def examples(count: int) -> settings:
    """So many of them, the same each time; in a longer run more, and others each time."""
    return settings(
        max_examples=count * TIMES,
        derandomize=TIMES == 1,
        deadline=None,
        database=None,
        suppress_health_check=list(HealthCheck),
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the records of the cases lie."""
    place = tmp_path_factory.mktemp("fuzz")
    written(place / "wave.txt", RECORDS["one.txt"])
    return place


@examples(1500)
@given(text=mutated(CASES))
def test_mutated_case_files_are_read_or_refused_in_words(folder: Path, text: str) -> None:
    check(lambda: sl.read_case(written(folder / "case.toml", text)))


@examples(4000)
@given(
    text=mutated([*RECORDS.values(), *FORMATS]),
    options=st.sampled_from(OPTIONS),
    cut=st.integers(0, 60),
)
def test_mutated_records_are_read_or_refused_in_words(
    folder: Path, text: str, options: dict[str, Any], cut: int
) -> None:
    """Also if they are packed, and cut off."""
    path = written(folder / "record.txt", text)
    check(lambda: sl.read_record(path, **options))
    if cut < 20:
        packed = gzip.compress(path.read_bytes())
        (folder / "record.gz").write_bytes(packed[: len(packed) - cut])
        check(lambda: sl.read_record(folder / "record.gz", **options))
