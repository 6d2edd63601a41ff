"""Probability of pounding: level crossings, random phases, and growth of the plastic drift."""
