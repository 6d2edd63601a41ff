"""Sensitivity of the gap to each input: slopes, elasticities and ranges."""
