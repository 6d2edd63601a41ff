"""Stochlin atlas, lookup."""
