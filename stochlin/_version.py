"""The version of the package, below every floor."""

__version__ = "0.1.0"
