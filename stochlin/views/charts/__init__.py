"""Pictures of the charts, and the commands ``stochlin charts`` and ``stochlin verify``."""
