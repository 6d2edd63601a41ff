"""The clipped closure of the bilinear law and the drift closure, which adds the plastic drift."""

from __future__ import annotations

from stochlin.kernels.linearization.gaussian import Closure, clipped
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.structures import CLOSURES, DRIFT, Structure


@CLOSURES.register("clipped", place=1)
@CLOSURES.register(DRIFT, place=2)
def of_bilinear(law: type[Structure]) -> Closure | None:
    """The clipped closure, which bilinear structures alone have."""
    return clipped if issubclass(law, Bilinear) else None
