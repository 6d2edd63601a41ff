"""Nonlinear simulation of structures under random ground motions, stationary or of finite duration."""
