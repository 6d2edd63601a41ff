"""Statistical linearization of one structure: response, peaks, strength, and its bias by simulation."""
