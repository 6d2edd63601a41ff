"""Ground floor: files that a user names, those of the package, and those that it writes."""
