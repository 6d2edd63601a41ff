"""Variables of the results on buildings, with unit and long name."""

from stochlin.solver.tables.labels import Variables

VARIABLES: Variables = {
    "base_shear": ("N", "base shear"),
    "displacement": ("m", "displacement of the roof"),
    "idealized_base_shear": ("N", "base shear of the idealization"),
    "idealized_displacement": ("m", "displacement of the roof in the idealization"),
    "yield_force": ("N", "base shear at yield"),
    "yield_displacement": ("m", "displacement of the roof at yield"),
    "hardening": ("1", "hardening ratio that is taken"),
    "initial_stiffness": ("N/m", "base shear over displacement of the roof where the curve begins"),
    "effective_stiffness": ("N/m", "base shear over displacement of the roof, up to yield"),
    "target_displacement": ("m", "displacement of the roof up to which the curve is idealized"),
    "period": ("s", "period of the mode"),
    "shape": ("1", "displacement of the floor in the mode, in the unit of the file"),
    "mass": ("kg", "mass of the floor"),
    "height": ("m", "height of the storey below the floor"),
    "level": ("m", "level of the floor above the ground"),
    "participation": ("1", "participation factor of the mode, in the unit of the shapes"),
    "modal_mass": ("kg", "effective modal mass along the direction"),
    "mass_share": ("1", "effective modal mass over the mass of all floors"),
    "floor_move": ("1", "displacement of the floor over that of the oscillator of the mode"),
}
