"""What yielding leaves behind: residual drifts, dissipated energies, ductilities, damage indices."""
