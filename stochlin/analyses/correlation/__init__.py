"""Two structures together: rho by every method."""
