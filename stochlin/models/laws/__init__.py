"""Hysteresis laws, one file each: symbolic form, coefficients, closures."""
