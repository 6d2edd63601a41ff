"""A motion lasts a period of its structures at least, whoever asks for it."""

from collections.abc import Callable
from typing import Any

import pytest
import xarray as xr

import stochlin as sl

pytestmark = [pytest.mark.invariant, pytest.mark.extreme]

ONE, TWO = (sl.Bilinear(T, 0.05, 0.05, reduction_factor=3) for T in (0.6, 1.0))
GROUND = sl.named_ground("firm", intensity=0.01)
VERBS: dict[str, Callable[[Any], xr.Dataset]] = {
    "simulate": lambda d: sl.simulate([ONE, TWO], GROUND, duration=d),
    "separation": lambda d: sl.separation(ONE, TWO, GROUND, d),
    "existing_gap": lambda d: sl.existing_gap(ONE, TWO, GROUND, 0.05, duration=d),
    "mitigate": lambda d: sl.mitigate(ONE, TWO, GROUND, 0.05, {}, duration=d),
    "probability": lambda d: sl.pounding_probability(ONE, TWO, GROUND, 0.05, duration=d),
    "fragility": lambda d: sl.pounding_fragility(ONE, TWO, GROUND, 0.05, 0.01, duration=d),
    "transient": lambda d: sl.transient_response(TWO, GROUND, d),
}


@pytest.mark.parametrize("verb", VERBS)
@pytest.mark.parametrize("duration", [0.001, 0.05, 0.9])
def test_shorter_than_a_period_is_refused(verb: str, duration: float) -> None:
    """In the same words in every verb: nothing is known of structures that have not swung once."""
    with pytest.raises(ValueError, match=f"duration = {duration:g} s is shorter than the period"):
        VERBS[verb](duration)
