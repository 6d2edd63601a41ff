"""Formats of files with the modes of a building, one file each."""
