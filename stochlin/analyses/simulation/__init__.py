"""Nonlinear response of structures to simulated motions, stationary and finite."""
