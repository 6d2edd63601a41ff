"""Rigid walls at the ends of a row of buildings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from stochlin.messages import brief
from stochlin.models.arguments import as_numbers, check_fields
from stochlin.models.parameters import Model

GROUND: Final = "ground"
SPACE: Final = "space"
HEIGHTS = "heights above the ground, 0 < height, finite, in metres, each once"


@dataclass(frozen=True)
class Wall(Model):
    """Rigid wall at an end of a row of buildings in `pound`.

    It has no mass and no degree of freedom: contacts push the building alone.

    Parameters
    ----------
    fixed : {"ground", "space"}
        What the wall moves with. A wall that is fixed to the ground has no displacement relative to it;
        one that is fixed in space has that of the ground with the opposite sign.
    heights : sequence of float, optional
        Heights above the ground at which the wall touches the building [m], as a rigid slab does. A
        height within 0.05 m of a floor meets its slab, any other the column of the storey. By default
        the wall is plane and meets the slabs of all floors.

    Raises
    ------
    ValueError, TypeError
        If ``fixed`` is another word, or ``heights`` are not positive numbers that differ.

    References
    ----------
    Anagnostopoulos, S. A. (1988), Earthquake Eng. Struct. Dyn. 16, for buildings in a row and stops at
    its ends.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.Wall().describe()
    'Wall (fixed to the ground)'
    >>> sl.Wall("space", heights=[1.75]).describe()
    'Wall (fixed in space, heights 1.75 m)'
    """

    fixed: Literal["ground", "space"] = GROUND
    heights: Sequence[float] | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        check_fields(self, "Wall: ")
        if self.heights is not None:
            heights = as_numbers("Wall: heights", self.heights, HEIGHTS)
            allowed = np.isfinite(heights) & (heights > 0)
            if heights.ndim != 1 or not heights.size or not allowed.all():
                raise ValueError(f"Wall: heights = {brief(self.heights)}; allowed: {HEIGHTS}")
            levels = tuple(sorted(map(float, heights)))
            if len({*levels}) < len(levels):
                raise ValueError(f"Wall: heights = {brief(self.heights)}; allowed: {HEIGHTS}")
            object.__setattr__(self, "heights", levels)

    def further(self) -> list[str]:
        """What the wall moves with, and its heights."""
        place = "fixed to the ground" if self.fixed == GROUND else "fixed in space"
        if self.heights is None:
            return [place]
        return [place, f"heights {', '.join(f'{height:g}' for height in self.heights)} m"]
