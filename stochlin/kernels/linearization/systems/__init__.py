"""Linearization of systems: state space, Lyapunov equation, response, iteration of coefficients."""
