"""Compiling everything before it is needed."""
