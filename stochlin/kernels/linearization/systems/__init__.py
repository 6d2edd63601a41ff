"""Linearization of systems: state space, Lyapunov equation, response, and iteration of coefficients."""
