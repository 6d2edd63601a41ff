"""What of a scene's ground takes its time: the fit to a code's spectrum, and how strong motions are."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.analyses.cases.case import Case
from stochlin.analyses.records.files import METRES
from stochlin.analyses.sites.design_spectra import asce_7, eurocode_8
from stochlin.analyses.sites.ground_fit import fit_ground
from stochlin.analyses.sites.simulated_spectra import simulated_spectrum
from stochlin.kernels.basics.parallel import Progress
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground, rms_acceleration

EUROCODE_8, ASCE_7 = "eurocode_8", "asce_7"
CODES = (EUROCODE_8, ASCE_7)
SOILS, TYPES = tuple("ABCDE"), ("1", "2")
S0, PGA, SA = "intensity S0", "peak ground acceleration", "spectral acceleration"
MEASURES = (S0, PGA, SA)
G = METRES["g"]
UNIT = 0.3 * G  # strength of the spectra that are fitted: the ground goes with its square
PATHS = 1024  # of motions of which the mean peak is taken: a standard error of half a per cent


class Shape(NamedTuple):
    """A code's spectrum but for its strength, and the motions that are to have it."""

    code: str
    kind: tuple[str, str] | tuple[float, float]  # soil and type, or sd1 over sds and tl
    duration: float
    envelope: Envelope | None

    def spectrum(self, strength: float) -> xr.DataArray:
        """Of this ``ag`` or ``sds`` [m/s^2]."""
        return _SPECTRA[self.code](strength, *self.kind)

    def fitted(self, progress: Progress | None = None) -> Fitted:
        """The ground whose motions have it."""
        motion: Any = {"duration": self.duration, "envelope": self.envelope, "progress": progress}
        return Fitted(self, UNIT, fit_ground(self.spectrum(UNIT), **motion))


class Fitted(NamedTuple):
    """The ground that delivers a spectrum of some strength."""

    shape: Shape
    strength: float  # ag or sds [m/s^2]
    ground: Ground


class Motions(NamedTuple):
    """Motions on a ground, and the period at which their strength is measured; None: by their peaks."""

    ground: Ground
    duration: float
    envelope: Envelope | None
    period: float | None

    def measured(self, seed: int, progress: Progress | None = None) -> Measured:
        """How strong they are in the mean, by simulation."""
        if self.period is None and not np.isfinite(rms_acceleration(self.ground)):
            raise ValueError(
                "white noise has no peak acceleration, since it grows with smaller time steps; "
                "allowed: another ground, or another measure of its strength"
            )
        at = [1.0 if self.period is None else self.period]
        given = (self.duration, self.envelope)
        table = simulated_spectrum(self.ground, at, *given, paths=PATHS, seed=seed, progress=progress)
        found = table.peak_ground_acceleration if self.period is None else table.pseudo_acceleration
        return Measured(self, float(found.item()))


class Measured(NamedTuple):
    """How strong motions are in the mean [m/s^2]."""

    motions: Motions
    acceleration: float


@dataclass(frozen=True)
class RecordsOfFile:
    """The recorded motions of a case file, which no control changes: scenes know them by the file."""

    file: Path
    motions: Mapping[str, xr.DataArray] = field(compare=False, repr=False)


def kind_of(code: str, said: Mapping[str, Any]) -> tuple[Any, Any]:
    """What says the shape of a code's spectrum, by the names of a scene."""
    if code == EUROCODE_8:
        return said["soil"], said["spectrum_type"]
    return said["sd1"] / said["sds"], said["tl"]


def code_of(case: Case) -> dict[str, Any]:
    """What a scene holds of a code's spectrum and the ground fitted to it; nothing of any other."""
    wanted = case.spectrum
    if wanted is None or wanted.attrs.get("code") not in CODES:
        return {}
    code, said = wanted.attrs["code"], wanted.attrs
    names = NAMES[code]
    shape = Shape(code, kind_of(code, said), case.duration, case.envelope)
    own = shape.spectrum(said[names[0]])
    if own.shape != wanted.shape or not np.allclose(own, wanted, rtol=1e-9, atol=0):
        return {}  # of another damping, or scaled
    fitted = Fitted(shape, said[names[0]], case.ground)
    return {"site": code, "fitted": fitted} | {name: said[name] for name in names}


def _eurocode_8(ag: float, soil: str, kind: str) -> xr.DataArray:
    return eurocode_8(ag, soil, type=int(kind))


def _asce_7(sds: float, ratio: float, tl: float) -> xr.DataArray:
    return asce_7(sds, ratio * sds, tl)


_SPECTRA: Mapping[str, Callable[..., xr.DataArray]] = {EUROCODE_8: _eurocode_8, ASCE_7: _asce_7}
# By the names of a scene, what says how strong it is first.
NAMES = {EUROCODE_8: ("ag", "soil", "spectrum_type"), ASCE_7: ("sds", "sd1", "tl")}
