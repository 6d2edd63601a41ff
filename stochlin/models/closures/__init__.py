"""Closures of linearization, one module each, besides the Gaussian one, which every law has."""
