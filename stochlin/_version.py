"""The version of the package, below every floor."""

__version__ = "2.0.0"
