"""One oscillator through a recorded motion, exact."""
