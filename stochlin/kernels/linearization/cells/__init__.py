"""Compiled loops over the cells of a table: grounds, fixed point iterations, drift."""
