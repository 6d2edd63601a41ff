"""Critical gap in a recorded motion by the energy approach: eq. (3) with pseudo energy radii."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
import xarray as xr

from stochlin.applications.records.cells import Records
from stochlin.applications.records.gaps import recorded_gap
from stochlin.kernels.correlation.combination import double_difference
from stochlin.models.arguments import OneOf, checked
from stochlin.models.grounds import Ground
from stochlin.models.rules.effective_properties import EffectiveRule, effective_rule
from stochlin.models.structures import Structure
from stochlin.solver.correlation.correlation import correlate, rho_white_noise
from stochlin.solver.correlation.effective import rho_effective
from stochlin.solver.linearization.equivalent_systems import check_closure
from stochlin.solver.tables import labels

WHITE_NOISE, EFFECTIVE, LINEARIZATION = METHODS = ("white_noise", "effective", "linearization")
Method = Annotated[str, OneOf(METHODS)]


class RhoEstimate(NamedTuple):
    """The estimate of the correlation in eq. (3): method and options."""

    method: str = WHITE_NOISE
    rule: str | EffectiveRule = "iwan_1980"
    ground: Ground | None = None
    closure: str = "gaussian"

    def check(self, first: Structure, second: Structure) -> None:
        """Raise an error for an unknown closure or rule, or for options of another method."""
        for structure in (first, second):
            check_closure(structure, self.closure)
        effective_rule(self.rule)
        if self.ground is None:
            if self.method == LINEARIZATION:
                raise ValueError(
                    f"ground is missing, which method = {self.method!r} needs; give one like the "
                    "record, for instance fit_ground(record)"
                )
            return
        if self.method != LINEARIZATION:
            raise ValueError(
                f"ground is given, which method = {self.method!r} does not use; leave it out, or give "
                f"method={LINEARIZATION!r}"
            )

    def of(self, first: Structure, second: Structure, recorded: xr.Dataset) -> xr.DataArray:
        """Correlation of the structures [-]; ``recorded`` has their peaks in the record."""
        if self.ground is not None:
            return correlate(first, second, self.ground, closure=self.closure, bias=False).rho
        pairs: dict[str, xr.DataArray] = {}
        for n, structure in enumerate((first, second), start=1):
            own = structure.arrays()
            pairs |= {f"{name}_{n}": own[name] for name in ("period", "damping")}
            if self.method == EFFECTIVE:
                strength = own.get("yield_displacement", xr.DataArray(np.inf))
                pairs[f"hardening_{n}"] = own.get("hardening", xr.DataArray(1.0))
                pairs[f"ductility_{n}"] = (recorded[f"peak_{n}"] / strength).clip(min=1.0)
        if self.method == EFFECTIVE:
            return np.minimum(rho_effective(**pairs, rule=self.rule).rho, 1)
        return np.minimum(rho_white_noise(**pairs).rho, 1)

    @property
    def told(self) -> str:
        """The method and its options in words, for the run information."""
        if self.method == EFFECTIVE:
            return f"method={self.method!r}, rule={effective_rule(self.rule).name!r}"
        return f"method={self.method!r}" + (f", closure={self.closure!r}" if self.ground else "")


@checked
def energy_gap(
    first: Structure,
    second: Structure,
    record: Records,
    method: Method = WHITE_NOISE,
    *,
    rule: str | EffectiveRule = "iwan_1980",
    ground: Ground | None = None,
    closure: str = "gaussian",
) -> xr.Dataset:
    """Critical gap in a recorded motion by the energy approach, compared with the required gap.

    The critical gap is eq. (3) with the pseudo energy radii of both structures, eqs. (1) and (2),
    elastic or yielding, and an estimate of the correlation coefficient. The gap that the record requires
    is that of `recorded_gap`.

    Parameters
    ----------
    first, second : Bilinear, BoucWen or Hysteretic
        Structures, elastic or with a yield displacement. Their parameters broadcast by dimension name.
    record : xarray.DataArray, or list or mapping of them
        Ground acceleration [m/s^2] over ``time`` [s], as from `read_record`. Several records add the
        dimension ``record`` to the result.
    method : str
        Method for the correlation: ``"white_noise"``, eq. (4) with the elastic periods and damping
        ratios; ``"effective"``, eq. (4) with effective properties by ``rule`` at the peak ductilities in
        the record; ``"linearization"`` on ``ground``, as the paper recommends for yielding structures.
    rule : str
        One of `stochlin.rules.effective_rule_names`, or a rule, for ``"effective"``.
    ground : WhiteNoise, KanaiTajimi or CloughPenzien, optional
        Ground that represents the record, as from `fit_ground`, for ``"linearization"``.
    closure : str
        As in `linearize`, for ``"linearization"``.

    Returns
    -------
    xarray.Dataset
        Over the dimensions of the parameters: the variables of `recorded_gap`, among them
        ``pseudo_energy_radius_1`` and ``_2`` [m] and the required gap ``separation`` [m];
        ``critical_gap`` [m] by eq. (3), with ``rho_estimate`` [-]; and ``critical_gap_error`` [-], the
        critical gap over the separation minus 1.

    Raises
    ------
    ValueError, TypeError
        As in `recorded_gap` and `correlate`; also if the ground is missing for ``"linearization"`` or
        given for another method.

    Notes
    -----
    The elastic ``rho`` is too small for yielding structures, so that eq. (4) leads to too large a gap;
    the errors of effective properties and linearization have either sign. All estimates of ``rho`` are
    means over many motions. In a single record two structures may therefore touch with the gap of
    eq. (3).

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (1) to (4), Fig. 2.

    Examples
    --------
    >>> import numpy as np, xarray as xr, stochlin as sl
    >>> time = 0.02 * np.arange(1000)
    >>> record = xr.DataArray(np.sin(5 * time), dims="time", coords={"time": time})
    >>> soft, stiff = sl.Bilinear(period=1.1, damping=0.05), sl.Bilinear(period=0.9, damping=0.05)
    >>> table = sl.energy_gap(soft, stiff, record)
    >>> radii = table.pseudo_energy_radius_1, table.pseudo_energy_radius_2
    >>> bool(table.critical_gap == sl.critical_gap(*radii, table.rho_estimate).gap)
    True
    """
    estimate = RhoEstimate(method, rule, ground, closure)
    estimate.check(first, second)
    return labels.with_run_information(
        labels.label(estimated_gap(first, second, record, estimate)),
        "Critical gap in recorded motions by the energy approach, eq. (3)",
        f"energy_gap({estimate.told})",
        {"first": first, "second": second} | ({} if ground is None else {"ground": ground}),
    )


def estimated_gap(
    first: Structure, second: Structure, record: Records, estimate: RhoEstimate
) -> xr.Dataset:
    """The result of `energy_gap`, without labels and run information."""
    table = recorded_gap(first, second, record)
    radii = (table.pseudo_energy_radius_1, table.pseudo_energy_radius_2)
    rho = estimate.of(first, second, table)
    gap = xr.apply_ufunc(double_difference, *radii, rho, join="exact")
    with np.errstate(divide="ignore", invalid="ignore"):
        error = gap / table.separation - 1
    return table.assign(critical_gap=gap, rho_estimate=rho, critical_gap_error=error)
