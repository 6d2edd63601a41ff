"""A scene of the explorer: its numbers, its formulas, its simulations."""
