"""The fit of motions to a spectrum in words, for screen, page and picture."""

from __future__ import annotations

from collections.abc import Sequence

import xarray as xr

from stochlin.applications.cases.separation import BAND
from stochlin.views.shared.words import per_cent

BAND_IN_WORDS = f"{BAND[0]:g} to {BAND[1]:g} times the periods of the buildings"


def fit_in_words(dataset: xr.Dataset, periods: Sequence[float] = ()) -> list[str]:
    """Sentences about what `simulated_spectrum` returned; none without a target.

    With the ``periods`` of buildings [s], the fit is that in their band, if the spectrum reaches it.
    """
    if "target" not in dataset:
        return []
    shown, where = dataset, ""
    if periods:
        low, high = BAND[0] * min(periods), BAND[1] * max(periods)
        inside = dataset.sel(period=slice(low, high))
        if inside.sizes["period"]:
            shown, where = inside, f" from {low:.2g} to {high:.2g} s, {BAND_IN_WORDS}"
    away = shown.ratio - 1
    worst = shown.isel(period=int(abs(away).argmax("period")))
    return [
        f"Response spectrum, mean of the motions relative to the target{where}: off by "
        f"{per_cent(float((away**2).mean() ** 0.5), 1)} (root mean square), at most by "
        f"{per_cent(float(worst.ratio) - 1, 1, '+')}, at {float(worst.period):.2g} s."
    ]
