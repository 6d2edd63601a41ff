"""Tables of a case file: their keys, how they are read, and how they are written."""
