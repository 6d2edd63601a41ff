"""Nonlinear simulation of structures in random ground motions, stationary or of finite duration."""
