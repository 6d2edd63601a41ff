"""How far apart: eq. (3), codes, every rule, what an existing gap allows."""
