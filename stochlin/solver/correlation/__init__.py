"""Correlation of the displacements of two structures, by every method, and related ratios."""
