"""Case files: reading them, and the separation, probability, mitigation and pounding of a case."""
