"""Stochlin explore."""
