"""Contacts of pounding structures: elements with a force law, and the stereomechanical impact.

Every element owns the relation between its damping and its coefficient of restitution. Eq. (15) of
the paper is that of `Kelvin` and of no other.
"""

from stochlin.models.contacts.base import Contact, Element
from stochlin.models.contacts.hertzian import Hertz, HertzDamp, Jankowski
from stochlin.models.contacts.linear import ImpactKelvin, Kelvin, LinearSpring, NoTensionKelvin
from stochlin.models.contacts.stereomechanical import Stereomechanical

__all__ = [
    "Contact",
    "Element",
    "Hertz",
    "HertzDamp",
    "ImpactKelvin",
    "Jankowski",
    "Kelvin",
    "LinearSpring",
    "NoTensionKelvin",
    "Stereomechanical",
]
