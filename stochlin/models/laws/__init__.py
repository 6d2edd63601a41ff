"""Hysteresis laws, one file each: symbolic form, closures in closed form, time steps."""

from stochlin.models.structures import LAWS as LAWS
