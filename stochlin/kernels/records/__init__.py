"""Response of oscillators to recorded motions, without error of discretization in time."""
