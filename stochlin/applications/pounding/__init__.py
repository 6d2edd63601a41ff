"""Pounding: response histories of buildings in a row, and the estimate of an impact from energies."""
