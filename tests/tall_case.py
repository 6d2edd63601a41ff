"""Case of two buildings with many storeys, for the tests of the page."""

SITE = """
title = "Tower and annex"
[site]
ground = "firm"
intensity = "0.01 m^2/s^3"
[motion]
duration = "{} s"
envelope = "none"
scatter = 0.3
[separation]
confidence = 0.9
existing = "8 cm"
"""
BUILDING = """
[building_{}]
name = "{}"
period = "{} s"
storeys = {}
storey_height = "3.2 m"
floor_mass = "400 t"
damping = 0.05
hardening = 0.05
base_shear_coefficient = 0.12
"""
SIMULATION = """
[simulation]
paths = {}
"""


def tower_and_annex(duration: int, paths: int | None = None) -> str:
    """The text of the case file, for a motion of this duration [s], simulated so many times."""
    buildings = BUILDING.format(1, "Tower", 1.1, 10) + BUILDING.format(2, "Annex", 0.7, 6)
    simulation = "" if paths is None else SIMULATION.format(paths)
    return SITE.format(duration) + simulation + buildings
