"""Linearization of one oscillator: covariances, ground filters, closures, fixed point, drift."""
