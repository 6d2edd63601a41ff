"""Grounds with a name: published and fitted parameter sets, each with its source."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stochlin.models.grounds import CloughPenzien, KanaiTajimi
from stochlin.models.parameters import Parameter


class _HighPass(NamedTuple):
    frequency: float
    damping: float


class _GroundSet(NamedTuple):
    """Frequencies in rad/s, as the sources print them."""

    frequency: float
    damping: float
    high_pass: _HighPass | None
    source: str


_DER_KIUREGHIAN = "Der Kiureghian & Neuenhofer 1992, Earthquake Eng. Struct. Dyn. 21, 713-740"
_GIARALIS = "Giaralis & Spanos, fitted to the Eurocode 8 spectrum of ground type"
_YEH_WEN = "Yeh & Wen 1990, Structural Safety 8, 281-298"
_FIT = "least squares on the linear PSD of the 5-95 % part of the record"

_GROUNDS = {
    "firm": _GroundSet(15.0, 0.6, _HighPass(1.5, 0.6), f"{_DER_KIUREGHIAN}, firm"),
    "medium": _GroundSet(10.0, 0.4, _HighPass(1.0, 0.6), f"{_DER_KIUREGHIAN}, medium"),
    "soft": _GroundSet(5.0, 0.2, _HighPass(0.5, 0.6), f"{_DER_KIUREGHIAN}, soft"),
    "ec8_a": _GroundSet(17.57, 0.54, _HighPass(2.22, 0.78), f"{_GIARALIS} A"),
    "ec8_b": _GroundSet(10.73, 0.78, _HighPass(2.33, 0.90), f"{_GIARALIS} B"),
    "ec8_c": _GroundSet(7.49, 0.84, _HighPass(2.14, 1.15), f"{_GIARALIS} C"),
    "ec8_d": _GroundSet(5.34, 0.88, _HighPass(2.12, 1.17), f"{_GIARALIS} D"),
    "ec8_e": _GroundSet(10.76, 0.77, _HighPass(2.03, 1.07), f"{_GIARALIS} E"),
    "taft_1952_yeh_wen": _GroundSet(20.0, 0.65, _HighPass(1.0, 0.5), f"{_YEH_WEN}, Taft 1952"),
    "mexico_city_1985_yeh_wen": _GroundSet(
        4.2, 0.10, _HighPass(0.23, 0.1), f"{_YEH_WEN}, Mexico City 1985"
    ),
    "sct_1985_ns": _GroundSet(3.09, 0.054, None, f"{_FIT} Mexico City 1985-09-19, SCT, NS"),
    "sct_1985_ew": _GroundSet(3.11, 0.033, None, f"{_FIT} Mexico City 1985-09-19, SCT, EW"),
    "taft_1952": _GroundSet(17.8, 0.45, None, f"{_FIT} Kern County 1952, Taft 111"),
}


def ground_names() -> tuple[str, ...]:
    """Names that `named_ground` knows.

    Returns
    -------
    tuple of str
        In lower case.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.ground_names()[:3]
    ('firm', 'medium', 'soft')
    """
    return tuple(_GROUNDS)


def named_ground(name: str, intensity: Parameter = 1.0) -> KanaiTajimi | CloughPenzien:
    """Ground of a published or fitted parameter set.

    Parameters
    ----------
    name : str
        One of `ground_names`, in any case.
    intensity : float or array
        Two-sided PSD ``S0`` of the white noise per rad/s [m^2/s^3], positive. The sets give the
        shape of the spectrum only; how strong the ground shakes is the user's to say.

    Returns
    -------
    KanaiTajimi or CloughPenzien
        The second where the set has a high-pass oscillator. ``source`` names the reference.

    Raises
    ------
    ValueError
        If the name is unknown (the message lists all names) or the intensity is out of range.

    Notes
    -----
    The sets ``sct_1985_ns``, ``sct_1985_ew`` and ``taft_1952`` are fits as `stochlin.fit_ground`
    makes them by default. Those of the lake bed rest on one narrow peak of a record of 37 to 71 s,
    which leaves their damping uncertain by a factor of two.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.named_ground("sct_1985_ns").describe()
    'KanaiTajimi(period=2.03339, damping=0.054, intensity=1)'
    >>> sl.named_ground("EC8_D", intensity=0.01).source
    'Giaralis & Spanos, fitted to the Eurocode 8 spectrum of ground type D'
    """
    chosen = _GROUNDS.get(str(name).strip().lower())
    if chosen is None:
        raise ValueError(f"name = {name!r} is not a known ground; allowed: {', '.join(_GROUNDS)}")
    period = 2 * np.pi / chosen.frequency
    if chosen.high_pass is None:
        return KanaiTajimi(period, chosen.damping, intensity, source=chosen.source)
    return CloughPenzien(
        period,
        chosen.damping,
        high_pass_period=2 * np.pi / chosen.high_pass.frequency,
        high_pass_damping=chosen.high_pass.damping,
        intensity=intensity,
        source=chosen.source,
    )
