"""Ground floor: arrays in, arrays out. No labels, no models."""
