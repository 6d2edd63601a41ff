"""Envelopes of motions of finite length: the amplitude of the shaking as a function of time."""

from stochlin.models.envelopes.amin_ang import AminAng
from stochlin.models.envelopes.envelope import (
    ENVELOPES,
    SHORTEST_STRONG_SHAKING,
    Envelope,
    envelope_at,
    strong_seconds,
)
from stochlin.models.envelopes.gamma import GammaEnvelope
from stochlin.models.envelopes.shinozuka_sato import ShinozukaSato

__all__ = [
    "ENVELOPES",
    "SHORTEST_STRONG_SHAKING",
    "AminAng",
    "Envelope",
    "GammaEnvelope",
    "ShinozukaSato",
    "envelope_at",
    "strong_seconds",
]
