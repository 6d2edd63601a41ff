"""Pushover curves of a case file, from which buildings have strength, hardening and stiffness."""

from __future__ import annotations

import warnings
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from stochlin.analyses.buildings.pushover import bilinear_of
from stochlin.analyses.buildings.pushover_files import read_pushover
from stochlin.analyses.cases.files.known import Known
from stochlin.analyses.cases.files.quantities import Quantity
from stochlin.analyses.cases.files.schema import OF_PUSHOVER, PUSHOVER
from stochlin.analyses.cases.files.sections import Section
from stochlin.messages import DoubtfulInput
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.structures import Structure
from stochlin.models.uncertain import applied, median_of

OF_UNITS = "length_units", "force_units"
SHARES = 0.4, 1.05  # plausible effective masses of a first mode, over the whole mass


def pushed(section: Section, elastic: Any, folder: Path, known: Known) -> Any:
    """An elastic structure, maybe uncertain, with what the pushover curve of its table says."""
    with section.naming(PUSHOVER):
        ideal = _idealized(section, folder, known)
        factor = None
        if isinstance(median_of(elastic), Structure):
            factor = section.read("participation")
            _doubt_mass(section, median_of(elastic), ideal, factor)
        change = partial(_of_curve, ideal=ideal, factor=factor)
        change(median_of(elastic))
    return applied(partial(_quietly, change), elastic)


def check_pushover(section: Section) -> None:
    """Raise a ValueError for keys of a pushover curve where there is none."""
    for key in OF_PUSHOVER:
        if key in section and PUSHOVER not in section:
            raise section.error(key, f"goes with {PUSHOVER}; add that, or leave it out")


def _idealized(section: Section, folder: Path, known: Known) -> xr.Dataset:
    """The idealization; files that are known are not read again."""
    units = section.texts("pushover_units") if "pushover_units" in section else [None, None]
    if len(units) != 2:
        what = 'is no pair of units; allowed: of displacement and base shear, as ["mm", "kN"]'
        raise section.error("pushover_units", what)
    path, options = folder / section.text(PUSHOVER), dict(zip(OF_UNITS, units, strict=True))
    curve = known.of(PUSHOVER, [section.text(PUSHOVER), options], lambda: read_pushover(path, **options))
    quantity = Quantity.declared(Bilinear, "hardening")
    hardening = section.number("hardening", quantity) if "hardening" in section else None
    return bilinear_of(curve, section.read("pushover_method"), hardening=hardening)


def _of_curve(structure: Any, ideal: xr.Dataset, factor: float | None) -> Any:
    """A structure by the idealized curve; an oscillator moves less than the roof, by the factor."""
    if factor is None:
        return structure.with_pushover(ideal)
    softer = float(np.sqrt(ideal.initial_stiffness / ideal.effective_stiffness))
    return replace(
        structure,
        period=structure.period * softer,
        hardening=float(ideal.hardening),
        yield_displacement=float(ideal.yield_displacement) / factor,
    )


def _quietly(change: Any, structure: Any) -> Any:
    """The change without its warnings, which are those at the median."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DoubtfulInput)
        return change(structure)


def _doubt_mass(section: Section, structure: Any, ideal: xr.Dataset, factor: float) -> None:
    """Warn if period and curve give an effective mass that the building cannot have."""
    if structure.mass is None:
        return
    mass = float(ideal.initial_stiffness) * factor * (structure.period / (2 * np.pi)) ** 2
    share = mass / structure.mass
    if not SHARES[0] < share < SHARES[1]:
        section.doubt(
            PUSHOVER,
            f"is doubtful: its stiffness and the period give an effective mass of {mass:.4g} kg, "
            f"{share:.3g} of the mass; check units, period and mass",
        )
