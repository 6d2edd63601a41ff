"""One structure on one ground, linearized: stationary, over time, peaks, strength, its known bias."""
