"""Sensitivity of the gap to each input."""
