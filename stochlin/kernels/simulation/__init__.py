"""Nonlinear simulation: normal random numbers, time steps of all laws, ensembles of motions."""
