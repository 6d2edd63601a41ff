"""Rigid walls at the ends of a row of buildings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
import xarray as xr

from stochlin.messages import brief
from stochlin.models.arguments import as_numbers, check_fields
from stochlin.models.parameters import Model, check_units

TO_GROUND: Final = "ground"
IN_SPACE: Final = "space"
ALLOWED_LEVELS = "levels above the ground, 0 < level, finite, in metres, each once"


@dataclass(frozen=True)
class Wall(Model):
    """Rigid wall at an end of a row of buildings in `pound`.

    It has no mass and no degree of freedom: contacts push the building alone.

    Parameters
    ----------
    fixed : {"ground", "space"}
        What the wall moves with. A wall that is fixed to the ground has no displacement relative to
        it; one that is fixed in space has that of the ground with the opposite sign.
    levels : sequence of float, optional
        Levels above the ground at which the wall touches the building [m], as a rigid slab does. A
        level within 0.05 m of a floor meets its slab, any other the column of the storey; no slab
        is met twice. By default the wall is plane and meets the slabs of all floors.

    Raises
    ------
    ValueError, TypeError
        If ``fixed`` is another word, or ``levels`` are not positive numbers that differ, or are in
        another unit by their attribute.

    References
    ----------
    Anagnostopoulos, S. A. (1988), Earthquake Eng. Struct. Dyn. 16, for buildings in a row that
    pound.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.Wall().describe()
    'Wall (fixed to the ground)'
    >>> sl.Wall("space", levels=[1.75]).describe()
    'Wall (fixed in space, levels 1.75 m)'
    """

    fixed: Literal["ground", "space"] = TO_GROUND
    levels: Sequence[float] | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        check_fields(self, "Wall: ")
        if self.levels is not None:
            if isinstance(self.levels, xr.DataArray):
                check_units("Wall: levels", self.levels.attrs.get("units"), "m")
            levels = as_numbers("Wall: levels", self.levels, ALLOWED_LEVELS)
            allowed = np.isfinite(levels) & (levels > 0)
            several = levels.ndim == 1 and levels.size > 0 and np.unique(levels).size == levels.size
            if not (several and allowed.all()):
                raise ValueError(f"Wall: levels = {brief(self.levels)}; allowed: {ALLOWED_LEVELS}")
            object.__setattr__(self, "levels", tuple(sorted(map(float, levels))))

    def further(self) -> list[str]:
        """What the wall moves with, and its levels."""
        place = "fixed to the ground" if self.fixed == TO_GROUND else "fixed in space"
        if self.levels is None:
            return [place]
        return [place, f"levels {', '.join(f'{level:g}' for level in self.levels)} m"]
