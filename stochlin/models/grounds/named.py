"""Grounds with published parameters, by name."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from stochlin.messages import brief
from stochlin.models.arguments import checked
from stochlin.models.grounds.clough_penzien import CloughPenzien
from stochlin.models.grounds.kanai_tajimi import KanaiTajimi
from stochlin.models.parameters import (
    Parameter,
)


def _ground(
    source: str, frequency: float, damping: float, *high_pass: float
) -> KanaiTajimi | CloughPenzien:
    """A ground from frequency [rad/s] and damping ratio of the soil and any high-pass oscillator.

    The references print circular frequencies, not periods.
    """
    soil = 2 * np.pi / frequency, damping
    if not high_pass:
        return KanaiTajimi(*soil, source=source)
    high_pass_frequency, high_pass_damping = high_pass
    return CloughPenzien(*soil, 2 * np.pi / high_pass_frequency, high_pass_damping, source=source)


_DER_KIUREGHIAN = "Der Kiureghian & Neuenhofer 1992, Earthquake Eng. Struct. Dyn. 21, 713-740"
_GIARALIS = "Giaralis & Spanos, fitted to the Eurocode 8 spectrum of ground type"
_YEH_WEN = "Yeh & Wen 1990, Structural Safety 8, 281-298"
_FIT = "least squares on the linear PSD of the 5-95 % part of the record"
_GROUNDS = {
    "firm": _ground(f"{_DER_KIUREGHIAN}, firm", 15.0, 0.6, 1.5, 0.6),
    "medium": _ground(f"{_DER_KIUREGHIAN}, medium", 10.0, 0.4, 1.0, 0.6),
    "soft": _ground(f"{_DER_KIUREGHIAN}, soft", 5.0, 0.2, 0.5, 0.6),
    "ec8_a": _ground(f"{_GIARALIS} A", 17.57, 0.54, 2.22, 0.78),
    "ec8_b": _ground(f"{_GIARALIS} B", 10.73, 0.78, 2.33, 0.90),
    "ec8_c": _ground(f"{_GIARALIS} C", 7.49, 0.84, 2.14, 1.15),
    "ec8_d": _ground(f"{_GIARALIS} D", 5.34, 0.88, 2.12, 1.17),
    "ec8_e": _ground(f"{_GIARALIS} E", 10.76, 0.77, 2.03, 1.07),
    "taft_1952_yeh_wen": _ground(f"{_YEH_WEN}, Taft 1952", 20.0, 0.65, 1.0, 0.5),
    "mexico_city_1985_yeh_wen": _ground(f"{_YEH_WEN}, Mexico City 1985", 4.2, 0.10, 0.23, 0.1),
    "sct_1985_ns": _ground(f"{_FIT} Mexico City 1985-09-19, SCT, NS", 3.09, 0.054),
    "sct_1985_ew": _ground(f"{_FIT} Mexico City 1985-09-19, SCT, EW", 3.11, 0.033),
    "taft_1952": _ground(f"{_FIT} Kern County 1952, Taft 111", 17.8, 0.45),
}


def ground_names() -> tuple[str, ...]:
    """Names of the parameter sets that `named_ground` takes, in lower case."""
    return tuple(_GROUNDS)


@checked
def named_ground(name: str, intensity: Parameter = 1.0) -> KanaiTajimi | CloughPenzien:
    """Ground with a published or fitted parameter set.

    Parameters
    ----------
    name : str
        ``firm``, ``medium``, ``soft``, ``ec8_a`` to ``ec8_e``, ``taft_1952``,
        ``taft_1952_yeh_wen``, ``sct_1985_ns``, ``sct_1985_ew`` or ``mexico_city_1985_yeh_wen``, in
        upper or lower case.
    intensity : float or array
        Two-sided PSD ``S0`` of the white noise per rad/s [m^2/s^3], positive. The parameter sets
        give only the shape of the spectrum, not its intensity.

    Returns
    -------
    KanaiTajimi or CloughPenzien
        A `CloughPenzien` ground if the set has a high-pass oscillator. ``source`` names the
        reference.

    Raises
    ------
    ValueError
        If the name is unknown (the message lists all names) or the intensity is out of range.

    Notes
    -----
    The sets ``sct_1985_ns``, ``sct_1985_ew`` and ``taft_1952`` are least-squares fits as made by
    `stochlin.fit_ground`. The two sets of the lake bed (SCT) are each fitted to one narrow spectral
    peak of a strong part of 37 to 71 s, so that their damping is uncertain by a factor of two.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.named_ground("sct_1985_ns").describe()
    'Kanai-Tajimi (period 2.03339 s, damping 0.054, intensity 1 m²/s³)'
    >>> sl.named_ground("EC8_D", intensity=0.01).source
    'Giaralis & Spanos, fitted to the Eurocode 8 spectrum of ground type D'
    """
    if (chosen := _GROUNDS.get(str(name).strip().lower())) is None:
        raise ValueError(
            f"name = {brief(name)} is not a known ground; allowed: {', '.join(_GROUNDS)}"
        )
    return replace(chosen, intensity=intensity)
