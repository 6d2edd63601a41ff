"""Correlation of two oscillators: eqs. (3) and (4), compiled tables of pairs, signatures."""
