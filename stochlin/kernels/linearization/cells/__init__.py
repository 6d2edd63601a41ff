"""Compiled loops over the cells of a table: grounds, and the steps to a fixed point."""
