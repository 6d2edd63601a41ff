"""What the explorer says beside its charts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from stochlin.views.explorer.pictures import told_by_height
from stochlin.views.shared.words import SPACE, centimetres, length, per_cent, rule_label

if TYPE_CHECKING:
    from stochlin.analyses.explorer.scene import Scene

UNKNOWN = 2  # of the flag ``caution``: outside of the map
CORRELATION = (
    "Building 1 stays; the period of building 2 changes. The line marks the ratio of the controls."
)
DRIFT = "The drift closure is an estimate too, where buildings yield."
STOREYS = (
    "Building 1 stays; the period of building 2 changes, all its stiffnesses in one proportion. The "
    "line marks the ratio of the controls; only there is anything simulated. Eq. (4) is of the first "
    "modes."
)
UNSAFE = "Caution: linearization alone is unsafe for buildings that yield."
ELASTIC = "Both buildings stay elastic: linearization is exact here."
SEEKING = "The ground of these values is being sought, by simulation ..."
SAVED_LAST = "Saved with the last values that could be read."
START = "No simulation of these values yet: the button asks the exact laws."


def caution(table: xr.Dataset) -> tuple[str, str]:
    """Whether linearization can be trusted at the scene's own ratio, in words; and why."""
    if "comment" not in table.attrs:
        return ELASTIC, ""
    own = table.sel(period_ratio=table.attrs["period_ratio"], method="nearest")
    biases = {n: float(own[f"bias_{n}"]) for n in (1, 2)}
    known = [
        f"{per_cent(abs(bias))} too {'small' if bias < 0 else 'large'} for building {n}"
        for n, bias in biases.items()
        if np.isfinite(bias) and bias
    ]
    rho = float(own.bias)
    words = UNSAFE
    if known:
        words += f" Here its displacements are {' and '.join(known)}"
        words += (
            f", its ρ off by {rho:+.2f}." if np.isfinite(rho) else ", its ρ off by an unknown amount."
        )
    elif int(own.caution) == UNKNOWN:
        words += " How far it is off here is unknown: the map of its bias does not reach this ground."
    return words, table.attrs["comment"].replace("Caution: a", "A")


def caution_of_storeys(scene: Scene) -> tuple[str, str]:
    """The same where storeys are linearized, of which there is no map."""
    if not any(structure.yields for structure in scene.structures()):
        return ELASTIC, ""
    return (
        f"{UNSAFE} How far it is off here is unknown: there is no map of its bias for storeys.",
        "Where it was compared, drifts of storeys that yield were 7 to 39 % too small, and the "
        "difference of two buildings 28 %. Simulations have no such error: the probability of no "
        "pounding comes from one of few motions, all else at the button.",
    )


def spectra(table: xr.Dataset) -> str:
    """Where the displacements are, if that is a question."""
    return f"Displacements {_where(table)}." if "height_m" in table.attrs else ""


def correlation(table: xr.Dataset) -> str:
    """What stays and what changes over the ratio."""
    if "rho_drift" in table:
        return f"{CORRELATION} {DRIFT}"
    return f"{STOREYS} All else is {_where(table)}."


def _where(table: xr.Dataset) -> str:
    return f"at the lower roof, {table.attrs['height_m']:.4g}{SPACE}m up"


def gaps(table: xr.Dataset) -> str:
    """The answer, if it was simulated, or what the rules are fed with; and what rules lack."""
    there = length(table.attrs["gap_m"])
    confidence = per_cent(table.attrs["confidence"])
    if table.attrs["peaks"] == "simulated":
        answer = table.sel(rule="simulation")
        low, high = (float(answer[f"gap_{end}"]) for end in ("lower", "upper"))
        words = (
            f"Simulated: {length(float(answer.gap))} ({centimetres(low)} to {length(high)}) for "
            f"{confidence}; there are {there}. The rules are fed with simulated peaks. Open: unsafe. "
            "The number beside a rule is its error."
        )
    elif table.attrs["peaks"] == "linearized":
        alone = float(table.gap.sel(rule="linearization"))
        words = (
            f"Linearization: {length(alone)} for {confidence}; there are {there}. Nothing is simulated: "
            "the peaks are those of linearization for all rules, too small where storeys yield."
        )
    else:
        drift = float(table.gap.sel(rule="eq_3_drift"))
        words = (
            f"Eq. (3) with the drift closure: {length(drift)} for {confidence}; there are {there}. "
            "Nothing is simulated: peaks are those of the drift closure, but for eq. (3) linearized and "
            "for linearization, which are linearized alone."
        )
    if rule := told_by_height(table):
        height = float(table.governing_height.sel(rule=rule))
        words += f" It is needed at {height:.4g}{SPACE}m; below, the gap by height would do."
    lacking = table[["missing"]].where(table.missing != "", drop=True)
    missing = [
        f"{rule_label(str(r))}{'' if m.startswith('needs') else ':'} "
        f"{m.replace('height_1, height_2', 'heights')}"
        for r, m in zip(lacking.rule.values, lacking.missing.values, strict=True)
    ]
    return words + (f" Not shown: {'; '.join(missing)} (a case file may say)." if missing else "")


def records(table: xr.Dataset | None) -> str:
    """In how many records the gap there is would have been enough."""
    if table is None or not table.separation.notnull().any():
        return ""
    gaps = table.separation.values
    most = str(table.record[int(np.nanargmax(gaps))].item())
    enough = int((gaps <= table.attrs["gap_m"]).sum())
    return (
        f"Records: the existing gap would have been enough in {enough} of {gaps.size}; {most} would "
        f"have taken {length(float(np.nanmax(gaps)))}."
    )


def probability(table: xr.Dataset) -> str:
    """The probability at the end of the motion, by every way to it."""
    last, stem = table.isel(time=-1), "confidence_of_no_pounding"
    corrected = float(last[f"{stem}_corrected"])
    known = np.isfinite(corrected)
    parts = [
        f"{per_cent(float(last[stem]))} by formula",
        f"{per_cent(corrected)} corrected for its bias" if known else "correction unknown here",
    ]
    if f"{stem}_simulated" in table:
        low, high = (float(last[f"{stem}_simulated_{end}"]) for end in ("lower", "upper"))
        share = per_cent(float(last[f"{stem}_simulated"]))
        parts.append(f"{share} simulated ({per_cent(low)} to {per_cent(high)})")
    words = f"No pounding to the end of the motion: {', '.join(parts)}."
    if "comment" in table.attrs:
        words += " The formula is linearized: too sure where buildings yield."
    return words
