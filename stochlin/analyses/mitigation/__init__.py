"""Measures against pounding: a comparison, and the least that is sufficient."""
