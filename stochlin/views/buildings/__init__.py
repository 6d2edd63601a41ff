"""Buildings as they were read from files of other programs."""
