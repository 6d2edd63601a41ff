"""Pictures of chart datasets: stochlin charts, verify."""
