"""Modified Clough law: reloading aims at the largest excursion yet, as in reinforced concrete."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from stochlin.models.parameters import Parameter, Range, parameter
from stochlin.models.structures import LAWS, Structure

FROM_1 = Range(lower=1.0, include_lower=True)
NOT_BEFORE_YIELD = Range(
    lower=1.0, include_lower=True, reason="the cap is not before yielding, at 1"
)
FALLS = Range(reason="above hardening/(1 - hardening), so that the force falls")
UNLOADS = Range(upper=1.0, include_lower=True, reason="1 unloads to the origin, more makes energy")
BELOW_CAP = Range(upper=1.0, include_lower=True, reason="z is 1 at the cap")
# Parameters of which one means nothing without the other
DEPENDENT_PARAMETERS = [("cracking", "uncracked_stiffness"), ("cap_ductility", "softening")]


@LAWS.register("modified_clough", place=5)
@dataclass(frozen=True)
class ModifiedClough(Structure):
    """Peak-oriented oscillator, whose stiffness degrades with the largest excursions.

    The hysteretic displacement ``uy z`` is elastic-plastic at first. It unloads with the elastic
    stiffness times ``(d_max/uy)^-a``, where ``d_max`` is the largest displacement so far on the
    side it unloads from, or ``uy`` if that is larger. From ``z = 0`` it reloads along a straight
    line to the point of the largest displacement so far on the other side. If it unloads and
    reloads before that, it first returns to this line along the way on which it came.

    The first loading may have four branches in place of two. It cracks at ``z = cracking`` and then
    leads straight to yielding at ``uy``, which remains the point of ``z = 1``. So period and yield
    displacement are those of the cracked structure, as designers take them, and small motions
    before cracking are stiffer. Beyond the cap ``z`` falls along ``softening``, down to
    ``residual``. Each side has its own largest displacement, from which the strength that is left
    follows. Between cracking and yielding it unloads towards the point of cracking on the other
    side. Once one side has yielded, it reloads towards the point of yielding on the other side, if
    it has not been there.

    The largest displacement of a stationary motion grows for ever, so that there is no stationary
    response. The law is followed in motions of finite length: by `simulate` with a duration,
    `separation`, `respond`, `recorded_gap` and `pound`.

    Parameters
    ----------
    period, damping, hardening, yield_displacement, reduction_factor, peak_factor
        As in `Bilinear`; period and strength are those of the cracked structure before any damage.
        Beside the hysteretic spring stands the linear one of the hardening, so that both aim at the
        same point. It is there beyond the cap, too.
    unloading_exponent : float or array
        Exponent ``a`` of the unloading stiffness [-], at least 0 and below 1. At 0 the stiffness in
        unloading is the elastic one, as in Clough's law; 0.4 is Takeda's.
    cracking : float or array, optional
        ``z`` at cracking [-], above 0 and below 1; without it there is no cracking.
    uncracked_stiffness : float or array, optional
        Stiffness before cracking over that of the line from zero to yielding [-], at least 1; it is
        given together with ``cracking``.
    cap_ductility : float or array, optional
        Displacement from which the strength falls, over ``uy`` [-], at least 1; without it the
        strength is kept.
    softening : float or array, optional
        How much ``z`` falls per ``uy`` beyond the cap [-], positive. The force of the whole
        structure falls by ``(1 - hardening) softening - hardening`` times the elastic stiffness,
        which has to be positive unless the cap is at yielding. It is given together with
        ``cap_ductility``.
    residual : float or array
        ``z`` that is left in the end [-], at least 0 and below 1; it has no effect without a cap.
    mass : float, optional
        As in `Bilinear`.

    Raises
    ------
    ValueError, TypeError
        As in `Bilinear`; also if a parameter lacks the one that belongs to it, or if the force does
        not fall beyond a cap after yielding. What needs a stationary response refuses the law: by
        an ArithmeticError what linearizes, by a ValueError what simulates.

    References
    ----------
    Clough, R. W. and Johnston, S. B. (1966), Proc. 2nd Japan Earthquake Eng. Symp.; Mahin, S. A.
    and Lin, J. (1983), UCB/EERC-83/17, for reloading after partial unloading; Takeda, T., Sozen, M.
    A. and Nielsen, N. N. (1970), J. Struct. Div. ASCE 96, for cracking and the stiffness in
    unloading; Ibarra, L. F., Medina, R. A. and Krawinkler, H. (2005), Earthquake Eng. Struct. Dyn.
    34, 1489-1511, for the cap, without its cyclic deterioration.

    Examples
    --------
    >>> import stochlin as sl
    >>> frame = sl.ModifiedClough(0.6, 0.05, hardening=0.05, yield_displacement=0.02)
    >>> ground = sl.KanaiTajimi(0.4, 0.6, 0.02)
    >>> sl.simulate([frame], ground, paths=32, duration=10.0).sizes["path"]
    32

    A structure that cracks at 0.4 of its strength and loses strength from a ductility of 4 on:

    >>> brittle = sl.ModifiedClough(
    ...     0.6, 0.05, hardening=0.02, yield_displacement=0.02, cracking=0.4,
    ...     uncracked_stiffness=2.5, cap_ductility=4.0, softening=0.1, residual=0.2,
    ... )
    >>> loop = sl.hysteresis_loop(brittle, [0.02, 0.16, 0.3], refine=1)
    >>> [round(float(z), 6) for z in loop.z]
    [0.0, 1.0, 0.6, 0.2]
    """

    unloading_exponent: Parameter = parameter(
        "1", "exponent of the unloading stiffness", UNLOADS, 0.4
    )
    cracking: Parameter | None = parameter("1", "z at cracking", Range(upper=1.0), None)
    uncracked_stiffness: Parameter | None = parameter(
        "1", "stiffness before cracking over that to yielding", FROM_1, None
    )
    cap_ductility: Parameter | None = parameter("1", "ductility of the cap", NOT_BEFORE_YIELD, None)
    softening: Parameter | None = parameter("1", "fall of z per uy beyond the cap", FALLS, None)
    residual: Parameter = parameter("1", "z that is left beyond the cap", BELOW_CAP, 0.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        cells = self.cells()
        for pair in DEPENDENT_PARAMETERS:
            alone = [name for name in pair if name in cells]
            if len(alone) == 1:
                missing = pair[1 - pair.index(alone[0])]
                what = f"ModifiedClough: {alone[0]} is given without {missing}"
                raise ValueError(f"{what}; allowed: both, or neither")
        falls = self._falls()
        if not falls.ndim and not falls:
            hardening = float(self.arrays()["hardening"])
            softening = float(self.arrays()["softening"])
            least = hardening / (1 - hardening) if hardening < 1 else np.inf
            what = f"ModifiedClough: softening = {softening:g} gives no descending branch"
            allowed = f"hardening/(1 - hardening) = {least:.6g} < value; or cap_ductility = 1"
            raise ValueError(f"{what}; allowed: {allowed}")

    def valid(self) -> xr.DataArray:
        """True for the cells in which every parameter is in its range."""
        return super().valid() & self._falls()

    def _falls(self) -> xr.DataArray:
        """Whether the force falls beyond the cap, or there is none."""
        values = self.arrays()
        if not self.yields or "softening" not in values:
            return xr.DataArray(True)
        falls = (1 - values["hardening"]) * values["softening"] > values["hardening"]
        return falls | (values["cap_ductility"] == 1)

    def growing(self) -> tuple[str, ...]:
        """The largest displacement so far, on which the law depends."""
        return ("the largest displacement so far",)

    def step(self) -> Any:
        """The law in time steps."""
        from stochlin.kernels.simulation.paths import MODIFIED_CLOUGH

        return MODIFIED_CLOUGH

    def law_parameters(self) -> list[xr.DataArray]:
        """The branches as time steps take them; those that are not given have no effect."""
        values = self.arrays()
        unit = xr.DataArray(1.0)
        crack = values.get("cracking", unit)
        limit = unit
        rise = xr.DataArray(0.0)
        if self.cracking is not None:
            limit = crack / values["uncracked_stiffness"]
            rise = (1 - crack) / (1 - limit)
        cap = values.get("cap_ductility", np.inf * unit)
        softening = values.get("softening", unit)
        return [
            values["unloading_exponent"],
            crack,
            limit,
            rise,
            cap,
            softening,
            values["residual"],
        ]
