"""Any number of structures with any number of storeys, linked or not, as one linear system."""
