"""Random motions: normal numbers, time steps of every law, ensembles."""
