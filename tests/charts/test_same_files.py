"""Files of charts: six digits, no version, and the same bytes on other processors."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import stochlin as sl
from stochlin.applications.figures.charts import rounded

pytestmark = pytest.mark.invariant

FIGURES = sorted((Path(__file__).parents[2] / "figures").glob("*.nc"))
SMALL = [
    "charts",
    "--points",
    "9",
    "--simulated-points",
    "3",
    "--paths",
    "16",
    "--reduction-factors",
    "2,4",
    "--out",
]
# Kernels of linear algebra that add in other orders; both run on any x86-64 processor with AVX2.
PROCESSORS = (
    {"OPENBLAS_CORETYPE": "Haswell", "OPENBLAS_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"},
    {"OPENBLAS_CORETYPE": "Prescott", "OPENBLAS_NUM_THREADS": "2", "NUMBA_NUM_THREADS": "2"},
)


@pytest.mark.slow
def test_files_are_the_same_on_other_processors_and_with_more_threads(tmp_path):
    runs = [
        subprocess.Popen(
            [sys.executable, "-m", "stochlin", *SMALL, str(tmp_path / str(number))],
            env=os.environ | processor,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        for number, processor in enumerate(PROCESSORS)
    ]
    assert [run.wait() for run in runs] == [0, 0]
    files = sorted((tmp_path / "0").iterdir())
    assert len(files) == 28
    for path in files:
        assert path.read_bytes() == (tmp_path / "1" / path.name).read_bytes(), path.name


@pytest.mark.parametrize("path", FIGURES, ids=lambda path: path.stem)
def test_data_have_six_digits_and_neither_version_nor_history(path):
    with xr.open_dataset(path) as chart:
        for name, array in chart.variables.items():
            if array.dtype.kind == "f":
                values = array.values[np.isfinite(array.values)]
                assert all(float(f"{value:.5e}") == value for value in values.ravel()), name
                assert not (
                    (values != 0) & (np.abs(values) < 0.9e-9 * np.abs(values).max())
                ).any(), name
        assert not {"stochlin_version", "history"} & set(chart.attrs)
        assert sl.__version__ not in str(chart.attrs)
    picture = path.with_suffix(".png").read_bytes()
    assert b"Software" not in picture
    assert b"tEXt" not in picture


def test_noise_is_rounded_away_and_six_digits_stay():
    told = rounded(np.array([1.0, 1 / 3, -2e-7 / 3, 4e-17, -3e-11, np.nan, 123456.789e-5]))
    np.testing.assert_array_equal(told, [1.0, 0.333333, -6.7e-8, 0.0, 0.0, np.nan, 1.23457])
    assert not np.signbit(told[4])
    np.testing.assert_array_equal(rounded(np.array([2.34567891e7, 3.0])), [2.34568e7, 3.0])
    np.testing.assert_array_equal(rounded(np.zeros(2)), [0, 0])
