"""Stochlin gap."""
