"""First floor: what a user describes. Frozen dataclasses, validated here, once."""
