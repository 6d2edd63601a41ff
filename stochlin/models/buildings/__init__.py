"""Buildings with floors: as a row of storeys, or by their modes."""

from stochlin.models.buildings.base import GRAVITY, MOST_STOREYS, MultistoreyBuilding
from stochlin.models.buildings.modal import ModalBuilding
from stochlin.models.buildings.shear import OF_STOREYS, STOREYS, RegularBuilding, ShearBuilding

__all__ = [
    "GRAVITY",
    "MOST_STOREYS",
    "OF_STOREYS",
    "STOREYS",
    "ModalBuilding",
    "MultistoreyBuilding",
    "RegularBuilding",
    "ShearBuilding",
]
