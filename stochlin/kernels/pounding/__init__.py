"""A row of buildings through a recorded motion, event by event; force of a contact."""
