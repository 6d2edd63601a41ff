"""Peaks of structures, of the distances between them, and of links."""

from __future__ import annotations

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.models.buildings.base import FLOOR
from stochlin.solver.simulation.results import EndedMotions, register_result
from stochlin.solver.simulation.structures_in_motion import HEIGHT, STRUCTURE
from stochlin.solver.tables.labels import ELEMENT, LINK

STRUCTURE_PAIR = STRUCTURE, f"{STRUCTURE}_2"
LINK_PEAKS = "peak_link_force", "peak_link_stroke", "link_energy"


@register_result("peak_positive", [FLOOR], mean=True, place=1)
def peak_positive(motions: EndedMotions) -> Array:
    """Largest displacements of floors."""
    return motions.largest["floors"][0]


@register_result("peak_negative", [FLOOR], place=2)
def peak_negative(motions: EndedMotions) -> Array:
    """Largest displacements of floors in the other direction."""
    return motions.largest["floors"][1]


@register_result("peak", [FLOOR], mean=True, place=3)
def peak(motions: EndedMotions) -> Array:
    """Largest absolute displacements of floors."""
    return motions.either("floors")


@register_result("separation", STRUCTURE_PAIR, mean=True, place=4)
def separation(motions: EndedMotions) -> Array:
    """Peak relative displacements, over all heights."""
    largest: Array = np.fmax.reduce(motions.separations, axis=-1, initial=0.0)
    return largest


@register_result("separation_at_height", [*STRUCTURE_PAIR, HEIGHT], place=5)
def separation_at_height(motions: EndedMotions) -> Array | None:
    """Peak relative displacements at each height, of buildings with storeys."""
    count = motions.moving.heights.size
    return motions.separations[..., :count] if count else None


@register_result("peak_drift", [ELEMENT], mean=True, place=6)
def peak_drift(motions: EndedMotions) -> Array | None:
    """Largest absolute drifts, of buildings with storeys."""
    return motions.either("drifts") if motions.moving.system.has_storeys else None


@register_result("peak_at_height", [STRUCTURE, HEIGHT], place=7)
def peak_at_height(motions: EndedMotions) -> Array | None:
    """Peaks of the structures at the heights at which they could meet another."""
    if not motions.moving.places:
        return None
    structures, levels = zip(*motions.moving.places, strict=True)
    heights = motions.moving.heights
    peaks = motions.either("places")
    values = np.full((len(peaks), len(motions.moving.system.sticks), heights.size), np.nan)
    values[:, structures, np.searchsorted(heights, levels)] = peaks
    return values


@register_result("peak_link_force", [LINK], mean=True, place=8)
def peak_link_force(motions: EndedMotions) -> Array | None:
    """Largest forces of links, as means of steps."""
    return motions.links.get("force")


@register_result("peak_link_stroke", [LINK], mean=True, place=9)
def peak_link_stroke(motions: EndedMotions) -> Array | None:
    """Largest absolute extensions of links."""
    return motions.links.get("stroke")


@register_result("link_energy", [LINK], mean=True, place=10)
def link_energy(motions: EndedMotions) -> Array | None:
    """Energies that links dissipate."""
    return motions.links.get("energy")
