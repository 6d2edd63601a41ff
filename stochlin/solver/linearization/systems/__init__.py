"""Linearization of systems: structures with any number of storeys, with or without links."""
