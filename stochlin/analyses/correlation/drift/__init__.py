"""Correlation by the drift closure."""
