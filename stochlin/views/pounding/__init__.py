"""Stochlin pound."""
