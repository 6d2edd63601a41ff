"""Second floor: linearization, tables of rho, and simulation beside them. Models in, datasets out."""
