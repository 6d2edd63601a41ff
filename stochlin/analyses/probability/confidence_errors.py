"""Where the confidence of no pounding by formula is accurate: by a simulation beside it."""

from __future__ import annotations

import numpy as np
import xarray as xr

STEM, ENDINGS = "confidence_of_no_pounding", ("", "_corrected")
OFF = 0.1  # most by which a confidence with the flag 0 is too large
MEANINGS = ("too_large_by_0.1_at_most", "may_be_larger_than_that", "unknown")


def measured_cautions(table: xr.Dataset) -> dict[str, xr.DataArray]:
    """Flags of the confidence by formula at the end of the motion, and of the corrected one.

    They are 0 where it is above the lower end of the interval of the simulated confidence by `OFF` at
    most, 1 where by more, and 2 where it is NaN. There are none without a formula.
    """
    last = table.isel(time=-1, drop=True)
    most = last[f"{STEM}_simulated_lower"] + OFF
    flags = {}
    for ending in ENDINGS:
        if f"{STEM}{ending}" not in last:
            continue
        confidence = last[f"{STEM}{ending}"]
        flag = (confidence > most).astype(np.int8).where(confidence.notnull(), 2)
        flag = flag.transpose(*confidence.dims).astype(np.int8)
        flags[f"caution{ending}"] = confidence.copy(data=flag.values)
        flags[f"caution{ending}"].attrs = {
            "long_name": "caution flag of the confidence at the end of the motion",
            "flag_values": np.arange(len(MEANINGS), dtype=np.int8),
            "flag_meanings": " ".join(MEANINGS),
            "comment": "by the simulation beside it: "
            f"{table.attrs['paths']} motions, seed {table.attrs['seed']}",
        }
    return flags
