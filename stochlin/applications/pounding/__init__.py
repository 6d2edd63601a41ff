"""Pounding: response histories of buildings in a row, and an impact estimated from energies."""
