"""Buildings with floors: as a row of storeys, or by their modes."""

from stochlin.models.buildings.base import GRAVITY, MOST_STOREYS, MultistoreyBuilding
from stochlin.models.buildings.damping import MODELS as DAMPING_MODELS
from stochlin.models.buildings.damping import OF_RAYLEIGH, ONE_PER_MODE
from stochlin.models.buildings.modal import ModalBuilding
from stochlin.models.buildings.shear import OF_STOREYS, STOREYS, RegularBuilding, ShearBuilding

__all__ = [
    "DAMPING_MODELS",
    "GRAVITY",
    "MOST_STOREYS",
    "OF_RAYLEIGH",
    "OF_STOREYS",
    "ONE_PER_MODE",
    "STOREYS",
    "ModalBuilding",
    "MultistoreyBuilding",
    "RegularBuilding",
    "ShearBuilding",
]
