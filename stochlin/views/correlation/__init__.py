"""The correlation of a pair: stochlin rho."""
