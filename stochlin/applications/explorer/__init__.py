"""The explorer's case: a form of its keys, and the files that it names."""
