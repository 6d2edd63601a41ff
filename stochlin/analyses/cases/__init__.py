"""A case file: read it, and put each of the four questions to it."""
