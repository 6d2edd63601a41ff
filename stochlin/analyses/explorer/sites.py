"""Fit of the ground of a scene to a spectrum, and mean accelerations of its motions, by simulation."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple, Self

import numpy as np
import xarray as xr

from stochlin.analyses.cases.case import Case
from stochlin.analyses.records.files import METRES
from stochlin.analyses.sites.design_spectra import asce_7, eurocode_8
from stochlin.analyses.sites.ground_fit import fit_ground
from stochlin.analyses.sites.simulated_spectra import simulated_spectrum
from stochlin.analyses.sites.spectra import labelled
from stochlin.kernels.basics.parallel import Progress
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground, rms_acceleration

EUROCODE_8, ASCE_7 = "eurocode_8", "asce_7"
CODES = (EUROCODE_8, ASCE_7)
OF_FILE = "spectrum of the file"
SPECTRA = (*CODES, OF_FILE)
SOILS, TYPES = tuple("ABCDE"), ("1", "2")
S0, PGA, SA = "intensity S₀", "peak ground acceleration", "spectral acceleration"
MEASURES = (S0, PGA, SA)
G = METRES["g"]
# Values of ag, sds or the scale for which spectra are fitted; the intensity grows with their square.
UNITS = dict.fromkeys(CODES, 0.3 * G) | {OF_FILE: 1.0}
PATHS = 1024  # motions for a mean peak acceleration, with a standard error of half a per cent


class SpectrumOfFile(NamedTuple):
    """Spectrum with ordinates from a file, as plain numbers of a scene, which can be compared."""

    periods: tuple[float, ...]  # [s]
    accelerations: tuple[float, ...]  # [m/s^2], for the scale 1
    damping: float
    source: str

    @classmethod
    def of(cls, spectrum: xr.DataArray, scale: float) -> Self:
        """From a spectrum that is ``scale`` times that of the file."""
        periods, values = spectrum.period.values, spectrum.values / scale
        attrs = spectrum.attrs
        return cls(tuple(periods.tolist()), tuple(values.tolist()), attrs["damping"], attrs["source"])


class Shape(NamedTuple):
    """Shape of a spectrum without its strength, with the duration and envelope of its motions."""

    name: str
    kind: Any  # (soil, type, damping), (sd1/sds, tl), or a `SpectrumOfFile`
    duration: float
    envelope: Envelope | None

    def spectrum(self, strength: float) -> xr.DataArray:
        """Spectrum for ``strength``, which is ``ag`` or ``sds`` [m/s^2] or the scale."""
        return _SPECTRA[self.name](strength, *self.kind)

    def fitted(self, progress: Progress | None = None) -> Fitted:
        """Ground whose motions have this spectrum in the mean."""
        motion: Any = {"duration": self.duration, "envelope": self.envelope, "progress": progress}
        unit = UNITS[self.name]
        return Fitted(self, unit, fit_ground(self.spectrum(unit), **motion))


class Fitted(NamedTuple):
    """Ground fitted to a spectrum."""

    shape: Shape
    strength: float  # ag or sds [m/s^2] or the scale
    ground: Ground


class SiteMotions(NamedTuple):
    """Motions on a ground, and the period of their mean spectral acceleration; None: mean peak."""

    ground: Ground
    duration: float
    envelope: Envelope | None
    period: float | None

    def measured(self, seed: int, progress: Progress | None = None) -> MeasuredAcceleration:
        """Mean acceleration of the motions by simulation."""
        if self.period is None and not np.isfinite(rms_acceleration(self.ground)):
            raise ValueError(
                "white noise has no peak acceleration, since it grows with smaller time steps; "
                "allowed: another ground, or another measure of its strength"
            )
        at = [1.0 if self.period is None else self.period]
        motion = (self.duration, self.envelope)
        table = simulated_spectrum(self.ground, at, *motion, paths=PATHS, seed=seed, progress=progress)
        acceleration = (
            table.peak_ground_acceleration if self.period is None else table.pseudo_acceleration
        )
        return MeasuredAcceleration(self, float(acceleration.item()))


class MeasuredAcceleration(NamedTuple):
    """Mean peak or spectral acceleration of motions [m/s^2]."""

    motions: SiteMotions
    acceleration: float


def kind_of(name: str, said: Mapping[str, Any]) -> Any:
    """The ``kind`` of a `Shape`, from the parameters of a scene."""
    if name == OF_FILE:
        return said["spectrum_of_file"]
    if name == EUROCODE_8:
        return said["soil"], said["spectrum_type"], said["spectrum_damping"]
    return said["sd1"] / said["sds"], said["tl"]


def spectrum_of(case: Case, scale: float) -> dict[str, Any]:
    """Parameters of a scene for the spectrum of a case and its fitted ground; empty without one.

    ``scale`` is the factor on a spectrum from a file.
    """
    wanted = case.spectrum
    if wanted is None:
        return {}
    name = wanted.attrs.get("code", OF_FILE)
    if name == OF_FILE:
        said: dict[str, Any] = {
            "spectrum_scale": scale,
            "spectrum_of_file": SpectrumOfFile.of(wanted, scale),
        }
    else:
        said = {key: wanted.attrs[key] for key in NAMES[name]}
        said["spectrum_damping"] = wanted.attrs["damping"]
    shape = Shape(name, kind_of(name, said), case.duration, case.envelope)
    return {"site": name, "fitted": Fitted(shape, said[NAMES[name][0]], case.ground)} | said


def _eurocode_8(ag: float, soil: str, kind: str, damping: float) -> xr.DataArray:
    return eurocode_8(ag, soil, type=int(kind), damping=damping)


def _asce_7(sds: float, ratio: float, tl: float) -> xr.DataArray:
    return asce_7(sds, ratio * sds, tl)


def _of_file(
    scale: float, periods: Any, accelerations: Any, damping: float, source: str
) -> xr.DataArray:
    return labelled(np.array(periods), scale * np.array(accelerations), damping, source)


_SPECTRA: Mapping[str, Callable[..., xr.DataArray]] = {
    EUROCODE_8: _eurocode_8,
    ASCE_7: _asce_7,
    OF_FILE: _of_file,
}
# Parameters of a scene for each spectrum; the first one is its strength.
NAMES = {
    EUROCODE_8: ("ag", "soil", "spectrum_type"),
    ASCE_7: ("sds", "sd1", "tl"),
    OF_FILE: ("spectrum_scale",),
}
