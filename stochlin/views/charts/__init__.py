"""Pictures of the charts, and the command ``stochlin charts``."""
