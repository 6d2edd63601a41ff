"""The design spectrum of a case file, and the ground that delivers it in the motion of the file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import xarray as xr

from stochlin.analyses.cases.values import Quantity, Section
from stochlin.analyses.sites.design_spectra import asce_7, eurocode_8
from stochlin.analyses.sites.ground_fit import fit_ground
from stochlin.analyses.sites.spectrum_files import read_spectrum
from stochlin.analyses.sites.spectrum_fit import MOST_FILTERS
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground
from stochlin.models.parameters import POSITIVE, Range

SPECTRUM = "spectrum"
ACCELERATION, TIME = Quantity("m/s^2", POSITIVE), Quantity("s", POSITIVE)
DAMPING = Quantity("1", Range(0.0, 1.0))
_SHARED = (SPECTRUM, "filters", "records")
_OF_FILES = ("units", "damping", "column", "period_column")


def spectrum_file(site: Section, folder: Path) -> list[Path]:
    """The file that the spectrum is read from, if there is one."""
    if SPECTRUM not in site or site.text(SPECTRUM) in _CODES:
        return []
    return [folder / site.text(SPECTRUM)]


def ground_of_design(
    site: Section, folder: Path, duration: float, envelope: Envelope | None
) -> tuple[Ground, xr.DataArray]:
    """The ground that delivers the spectrum of the site, and this spectrum."""
    if "ground" in site:
        raise site.error("ground", "is given beside a spectrum; allowed: one of them, so leave one out")
    filters = site.whole("filters", 1, highest=MOST_FILTERS) if "filters" in site else None
    name = site.text(SPECTRUM)
    make = _CODES.get(name, _of_file)
    try:
        spectrum = make(site, folder)
        ground: Ground = fit_ground(spectrum, duration=duration, envelope=envelope, filters=filters)
    except (OSError, ValueError) as error:
        if str(error).startswith(site.file):
            raise
        raise site.error(SPECTRUM, f"cannot be used: {error}") from error
    return ground, spectrum


def _eurocode_8(site: Section, folder: Path) -> xr.DataArray:
    site.only(*_SHARED, "ag", "soil", "type", "damping")
    options: dict[str, Any] = {"type": site.whole("type", 1, 1, 2)}
    if "damping" in site:
        options["damping"] = site.number("damping", DAMPING)
    return eurocode_8(site.number("ag", ACCELERATION), site.text("soil", tuple("ABCDE")), **options)


def _asce_7(site: Section, folder: Path) -> xr.DataArray:
    site.only(*_SHARED, "sds", "sd1", "tl")
    sds, sd1 = (site.number(name, ACCELERATION) for name in ("sds", "sd1"))
    return asce_7(sds, sd1, site.number("tl", TIME))


def _of_file(site: Section, folder: Path) -> xr.DataArray:
    site.only(*_SHARED, *_OF_FILES)
    name = site.text(SPECTRUM)
    if not (folder / name).exists():
        raise site.error(
            SPECTRUM,
            f"is no code, and no file beside this one; allowed: {', '.join(_CODES)}, or such a file",
        )
    options: dict[str, Any] = {}
    if "units" in site:
        options["units"] = site.text("units")
    if "damping" in site:
        options["damping"] = site.number("damping", DAMPING)
    for key in ("column", "period_column"):
        if key in site:
            options[key] = site.column(key)
    return read_spectrum(folder / name, **options)


_CODES = {"eurocode_8": _eurocode_8, "asce_7": _asce_7}
