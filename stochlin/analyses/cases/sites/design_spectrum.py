"""The design spectrum of a case file, and the ground that is fitted to it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import xarray as xr

from stochlin.analyses.cases.files.known import Known
from stochlin.analyses.cases.files.quantities import Quantity
from stochlin.analyses.cases.files.sections import Section
from stochlin.analyses.cases.sites.records import SUITE
from stochlin.analyses.cases.sites.strength import GOALS, HAZARD, INTENSITY
from stochlin.analyses.sites.design_spectra import asce_7, eurocode_8
from stochlin.analyses.sites.ground_fit import fit_ground
from stochlin.analyses.sites.spectra import read_spectrum
from stochlin.analyses.tables.inputs import input_path
from stochlin.kernels.basics.parallel import Progress
from stochlin.messages import brief, hint
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground
from stochlin.models.parameters import Range

SPECTRUM = "spectrum"
DAMPING = Quantity("1", Range(0.0, 1.0))
_SHARED = (SPECTRUM, "filters", "records", SUITE)
_READING = ("units", "column", "period_column", "between")
_OF_FILES = (*_READING, "damping", "scale")


def spectrum_file(site: Section, folder: Path) -> list[Path]:
    """Path of the file of the spectrum, if there is one."""
    if SPECTRUM not in site or site.text(SPECTRUM) in _CODES:
        return []
    return [folder / site.text(SPECTRUM)]


def design_spectrum(site: Section, folder: Path, known: Known) -> xr.DataArray:
    """The spectrum of the site, by a code or from a file."""
    if "ground" in site:
        raise site.error("ground", "is given beside a spectrum; allowed: one of them, so leave one out")
    name = site.text(SPECTRUM)
    with site.naming(SPECTRUM):
        return _CODES[name](site) if name in _CODES else _of_file(site, folder, known)


def ground_of_design(
    site: Section,
    spectrum: xr.DataArray,
    duration: float,
    envelope: Envelope | None,
    progress: Progress | None,
) -> Ground:
    """The ground fitted to the spectrum of the site for the motion of the case."""
    with site.naming(SPECTRUM):
        options: Any = {"filters": site.read("filters"), "progress": progress}
        ground: Ground = fit_ground(spectrum, duration=duration, envelope=envelope, **options)
    return ground


def _eurocode_8(site: Section) -> xr.DataArray:
    _check_keys(site, ("ag", "soil", "type", "damping"), strength="ag")
    options: dict[str, Any] = {"type": site.read("type")}
    if "damping" in site:
        options["damping"] = site.number("damping", DAMPING)
    return eurocode_8(site.read("ag"), site.read("soil"), **options)


def _asce_7(site: Section) -> xr.DataArray:
    _check_keys(site, ("sds", "sd1", "tl"), strength="sds and sd1")
    return asce_7(site.read("sds"), site.read("sd1"), site.read("tl"))


def _of_file(site: Section, folder: Path, known: Known) -> xr.DataArray:
    name = site.text(SPECTRUM)
    path = known.of("file", name, lambda: _existing(site, folder / name))
    _check_keys(site, (*_OF_FILES, *GOALS), strength="the file and scale, or pga, sa and return_period")
    options = {key: site.read(key) for key in _READING if key in site}
    if "damping" in site:
        options["damping"] = site.number("damping", DAMPING)
    spectrum = known.of(SPECTRUM, [name, options], lambda: read_spectrum(path, **options))
    if "scale" not in site:
        return spectrum
    return (site.read("scale") * spectrum).assign_attrs(spectrum.attrs)


def _existing(site: Section, path: Path) -> Path:
    """The path of the spectrum; a ValueError if there is no such file."""
    try:
        input_path("path", path).stat()
    except FileNotFoundError as error:
        allowed = f"{hint(path.name, _CODES)}allowed: {', '.join(_CODES)}, or such a file"
        raise site.error(SPECTRUM, f"is neither a code nor a file beside this one; {allowed}") from error
    return path


def _check_keys(site: Section, own: tuple[str, ...], strength: str) -> None:
    """Raise a ValueError for a key that does not belong to this kind of spectrum.

    ``strength`` names the keys that give the strength of the spectrum, for messages.
    """
    for key in (INTENSITY, *GOALS):
        if key in site and key not in (*own, HAZARD):
            raise site.error(
                key,
                f"is given beside spectrum = {brief(site.values[SPECTRUM])}; its strength is given by "
                f"{strength}, so leave {key} out",
            )
    site.only(*_SHARED, HAZARD, *own)


_CODES = {"eurocode_8": _eurocode_8, "asce_7": _asce_7}
