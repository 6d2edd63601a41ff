"""Stochlin probability."""
