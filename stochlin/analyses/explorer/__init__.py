"""Scenes of the explorer: their parameters, results by formula and results by simulation."""
