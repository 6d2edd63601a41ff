"""The fit of motions to a spectrum or a record in words, for screen, page and picture."""

from __future__ import annotations

import xarray as xr

from stochlin.views.shared.words import per_cent


def fit_in_words(dataset: xr.Dataset) -> list[str]:
    """Sentences about what `simulated_spectrum` or `compare_motions` returned; none without a target."""
    if "target" not in dataset:
        return []
    away = dataset.ratio - 1
    worst = dataset.isel(period=int(abs(away).argmax("period")))
    wanted = "the record" if "energy_ratio" in dataset else "the target"
    sentences = [
        f"Response spectrum, mean of the motions relative to {wanted}: off by "
        f"{per_cent(float((away**2).mean() ** 0.5), 1)} (root mean square), at most by "
        f"{per_cent(float(worst.ratio) - 1, 1, '+')}, at {float(worst.period):.2g} s."
    ]
    if "energy_ratio" in dataset:
        energy, error = (float(dataset[f"energy_ratio{end}"]) for end in ("", "_standard_error"))
        sentences.append(
            f"Energy of the motions relative to the record: {energy:.2f} (standard error {error:.2f}). "
            f"Significant duration: {float(dataset.significant_duration):.3g} s, record "
            f"{float(dataset.record_significant_duration):.3g} s."
        )
    return sentences
