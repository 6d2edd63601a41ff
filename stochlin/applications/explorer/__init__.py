"""The explorer's case: a form of its keys, the files that it names, and its correlations."""
