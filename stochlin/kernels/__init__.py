"""First floor: numerical methods on plain arrays, without labels, units or models."""
