"""Statistical linearization of a structure: response, peaks, strength, and bias by simulation."""
