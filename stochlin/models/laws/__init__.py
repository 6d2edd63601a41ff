"""Hysteresis laws, one file each: symbolic form, closures in closed form, time steps."""

from __future__ import annotations

from dataclasses import fields

from stochlin.models.structures import LAWS, Structure


def closure_names() -> tuple[str, ...]:
    """Names of the closures of all laws."""
    return tuple(dict.fromkeys(name for law in LAWS.values() for name in law.closure_names()))


def laws_in_numbers() -> dict[str, type[Structure]]:
    """The laws that a file or a command can describe: those whose parameters are numbers."""
    return {name: law for name, law in LAWS.items() if len(fields(law)) == len(law.parameter_names())}
