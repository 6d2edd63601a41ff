"""Stochlin mitigate."""
