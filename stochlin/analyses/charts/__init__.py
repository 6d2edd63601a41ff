"""Data of the charts: the figures of the paper, and those of a record and its site."""
