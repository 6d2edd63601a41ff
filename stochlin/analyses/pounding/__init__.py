"""Pounding: response histories of buildings in a row, and estimates of impacts from energies."""
