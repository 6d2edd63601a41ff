"""The words beside the charts of the explorer."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from stochlin.analyses.explorer.pair import structures_of
from stochlin.messages import listed
from stochlin.views.explorer.pictures import (
    label_without_simulation,
    simulations,
    told_by_height,
)
from stochlin.views.shared.words import SPACE, interval, length, per_cent, rule_label

if TYPE_CHECKING:
    from collections.abc import Sequence

    from stochlin.analyses.cases.case import Case

PEAKS = {  # that rules use without simulation
    "drift closure": "Rules with linearized peaks use those of the drift closure; eq. (3), linearized, "
    "uses those of the Gaussian closure, as linearization does.",
    "linearized": "Rules with linearized peaks use those of linearization, which are too small where "
    "storeys yield.",
}
UNKNOWN = 2  # of the flag ``caution``: outside of the map
CORRELATION = (
    "Building 1 stays; the period of building 2 changes. The line marks the ratio of the controls."
)
DRIFT = "For buildings that yield, the drift closure is an estimate as well."
STOREYS = (
    "Building 1 stays; the period of building 2 changes, all its stiffnesses in one proportion. The "
    "line marks the ratio of the controls, the only one that is simulated. Eq. (4) uses the first "
    "modes."
)
UNSAFE = "Caution: linearization alone is unsafe for buildings that yield."
ELASTIC = "Both buildings stay elastic: linearization is exact here."
TOGETHER = "Where several rules share a line, a marker shows the name of its rule when pointed at."
DOING = {  # of each question to the process beside the page
    "ground": "Finding the ground for these values by simulation ...",
    "spectra": "Linearizing all storeys ...",
    "gaps": "Linearizing all storeys ...",
    "correlation": "Linearizing at each ratio of the periods ...",
    "motions": "Simulating some motions ...",
    "probability": "Computing the curves by formula ...",
    "records": "Running the records ...",
}
BUSY = "Waiting for another page of this server ..."
STOPPED = "Stopped. Another value of any control starts it again."
SAVED_LAST = "Saved with the last valid values."
START = "Press Simulate to run the nonlinear simulation for every chart."


def caution(table: xr.Dataset) -> tuple[str, str]:
    """The error of linearization at the case's own ratio, in words, and its reason."""
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
            f", and its ρ is off by {rho:+.2f}."
            if np.isfinite(rho)
            else ", and the error of its ρ is unknown."
        )
    elif int(own.caution) == UNKNOWN:
        words += " Its error is not known here: the map of its bias does not cover this ground."
    return words, table.attrs["comment"].replace("Caution: compared", "Compared")


def caution_of_storeys(case: Case) -> tuple[str, str]:
    """The same where storeys are linearized, for which there is no map."""
    if not any(structure.yields for structure in structures_of(case)):
        return ELASTIC, ""
    return (
        f"{UNSAFE} Its error is not known here: there is no map of its bias for storeys.",
        "In comparisons, drifts of yielding storeys were 7 to 39 % too small, and the difference of "
        "two buildings 28 %. Simulation has no such error: the probability of no pounding comes from "
        "a simulation of few motions; press Simulate for all other results.",
    )


def spectra(table: xr.Dataset) -> str:
    """The height of the displacements, for buildings with storeys."""
    return f"Displacements {_where(table)}." if "height_m" in table.attrs else ""


def correlation(table: xr.Dataset) -> str:
    """What stays and what changes over the ratio."""
    if "rho_drift" in table:
        return f"{CORRELATION} {DRIFT}"
    return f"{STOREYS} All other results are {_where(table)}."


def _where(table: xr.Dataset) -> str:
    return f"at the lower roof, {table.attrs['height_m']:.4g}{SPACE}m up"


def gaps(table: xr.Dataset, simulated: xr.Dataset | None = None, every: bool = True) -> str:
    """The gap by the simulation and without it, and the rules that are not shown."""
    parts = [] if simulated is None else [_simulated_gap(simulated)]
    parts += [_linearized_gap(table), f"The existing gap is {length(table.attrs['gap_m'])}."]
    if simulated is None:
        parts.append("No gap is simulated yet: press Simulate.")
    if simulated is None or every:
        parts.append(PEAKS[table.attrs["peaks"]])
    if simulated is not None:
        parts.append(
            f"{'All other' if every else 'The'} rules use the simulated peaks. Open markers are unsafe. "
            "The number beside a rule is its error."
        )
    if not every:
        parts.append(TOGETHER)
    shown = table if simulated is None else simulated
    if rule := told_by_height(shown):
        height = float(shown.governing_height.sel(rule=rule))
        parts.append(
            f"It is needed at {height:.4g}{SPACE}m; at lower heights the gap by height is sufficient."
        )
    lacking = shown[["missing"]].where(shown.missing != "", drop=True)
    missing = [
        f"{rule_label(str(r))}{'' if m.startswith('needs') else ':'} "
        f"{m.replace('height_1, height_2', 'heights')}"
        for r, m in zip(lacking.rule.values, lacking.missing.values, strict=True)
    ]
    if missing:
        parts.append(f"Not shown: {'; '.join(missing)} (a case file can give these).")
    return " ".join(parts)


def _simulated_gap(table: xr.Dataset) -> str:
    answer = table.sel(rule="simulation")
    return (
        f"Simulated: {length(float(answer.gap))} ({interval(answer, 'gap')}) for "
        f"{per_cent(table.attrs['confidence'])}."
    )


def _linearized_gap(table: xr.Dataset) -> str:
    rule = "eq_3_drift" if "eq_3_drift" in table.rule else "linearization"
    gap, share = float(table.gap.sel(rule=rule)), per_cent(table.attrs["confidence"])
    return f"{label_without_simulation(rule, '').capitalize()}: {length(gap)} for {share}."


def records(table: xr.Dataset | None) -> str:
    """The number of records for which the existing gap would have been enough."""
    if table is None or not table.separation.notnull().any():
        return ""
    gaps = table.separation.values
    most = str(table.record[int(np.nanargmax(gaps))].item())
    enough = int((gaps <= table.attrs["gap_m"]).sum())
    return (
        f"Records: the existing gap would have been enough in {enough} of {gaps.size}; {most} would "
        f"have needed {length(float(np.nanmax(gaps)))}."
    )


def probability(table: xr.Dataset, simulated: xr.Dataset | None = None) -> str:
    """The probability at the end of the motion, by every method."""
    last, stem, parts = table.isel(time=-1), "confidence_of_no_pounding", []
    if stem in table:
        corrected = float(last[f"{stem}_corrected"])
        parts = [
            f"{per_cent(float(last[stem]))} by formula",
            f"{per_cent(corrected)} corrected for its bias"
            if np.isfinite(corrected)
            else "correction unknown here",
        ]
    for data in simulations(table, simulated):
        low, high = (float(data[f"{stem}_simulated_{end}"][-1]) for end in ("lower", "upper"))
        share = per_cent(float(data[f"{stem}_simulated"][-1]))
        parts.append(
            f"{share} simulated by {data.attrs['paths']} motions ({per_cent(low)} to {per_cent(high)})"
        )
    words = f"No pounding to the end of the motion: {', '.join(parts)}."
    if stem in table and "comment" in table.attrs:
        words += " The formula is linearized and therefore in error where buildings yield."
    return words


def after(charts: Sequence[str]) -> str:
    """What a chart says that is not asked for yet, while these are computed."""
    before = listed([chart for chart in charts if chart])
    return f"Waiting for: {before} ..." if before else "Waiting ..."


def beside(files: Sequence[str]) -> str:
    """Where a case file has to be that refers to other files."""
    return f"Keep the saved case file beside the files that it names: {listed(files)}." if files else ""
