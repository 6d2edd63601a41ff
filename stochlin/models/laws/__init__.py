"""Hysteresis laws, one module each: their sympy expression, closures and time steps."""

from __future__ import annotations

from dataclasses import fields

from stochlin.models.structures import LAWS, Structure


def laws_in_numbers() -> dict[str, type[Structure]]:
    """Laws, by name, whose parameters are all numbers: a file or a command can describe them."""
    return {
        name: law for name, law in LAWS.items() if len(fields(law)) == len(law.parameter_names())
    }
