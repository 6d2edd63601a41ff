"""Mitigation measures against pounding: comparison of measures, and the least sufficient ones."""
