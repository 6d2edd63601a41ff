"""The flags of the confidence by formula, as `docs/probability.md` states them."""

import numpy as np
import pytest
import xarray as xr

from stochlin.analyses.probability.confidence_errors import measured_cautions

pytestmark = pytest.mark.invariant


def test_a_simulation_beside_the_formulas_sets_their_flags():
    """0 up to 0.1 above the lower end of the interval, 1 beyond, and 2 without a confidence."""
    over = ("time", "gap")
    table = xr.Dataset(
        {
            "confidence_of_no_pounding": (over, [[0.95, 0.95, 0.6, 0.95]]),
            "confidence_of_no_pounding_corrected": (over, [[0.93, 0.87, 0.58, np.nan]]),
            "confidence_of_no_pounding_simulated_lower": (over, [[0.86, 0.84, 0.1, 0.9]]),
        },
        attrs={"paths": 64, "seed": 3},
    )
    found = measured_cautions(table)
    assert found["caution"].values.tolist() == [0, 1, 1, 0]
    assert found["caution_corrected"].values.tolist() == [0, 0, 1, 2]
    assert "64 motions, seed 3" in found["caution"].comment
