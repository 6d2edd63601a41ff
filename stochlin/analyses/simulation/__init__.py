"""Structures on simulated motions, exact laws: stationary and finite."""
