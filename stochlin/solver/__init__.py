"""Second floor: linearization, tables of rho, simulation beside them. Models in, datasets out."""
