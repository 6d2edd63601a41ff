"""The version of the package, below every floor."""

__version__ = "1.0.0"
