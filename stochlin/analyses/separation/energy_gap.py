"""Critical gap in a recorded motion by the energy approach: eq. (3) with pseudo energy radii."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import xarray as xr

from stochlin.analyses.correlation.correlation import correlate, rho_white_noise
from stochlin.analyses.correlation.effective import rho_effective
from stochlin.analyses.linearization.equivalent_systems import check_closure
from stochlin.analyses.records.cells import Records
from stochlin.analyses.records.gaps import recorded_gap
from stochlin.analyses.separation.variables import VARIABLES
from stochlin.analyses.tables import labels
from stochlin.kernels.correlation.combination import double_difference
from stochlin.messages import brief
from stochlin.models.grounds import Ground
from stochlin.models.parameters import expect
from stochlin.models.rules.effective_properties import EffectiveRule, effective_rule
from stochlin.models.structures import Structure

WHITE_NOISE, EFFECTIVE, LINEARIZATION = METHODS = ("white_noise", "effective", "linearization")


class RhoEstimate(NamedTuple):
    """Where eq. (3) takes its correlation from."""

    method: str = WHITE_NOISE
    rule: str | EffectiveRule = "iwan_1980"
    ground: Ground | None = None
    closure: str = "gaussian"

    def check(self, first: Structure, second: Structure) -> None:
        """Raise for what is not known, or does not fit together."""
        for role, structure in (("first", first), ("second", second)):
            expect(structure, Structure, role)
            check_closure(structure, self.closure)
        if not isinstance(self.method, str) or self.method not in METHODS:
            raise ValueError(
                f"method = {brief(self.method)} is not known; allowed: {', '.join(METHODS)}"
            )
        effective_rule(self.rule)
        if self.ground is None:
            if self.method == LINEARIZATION:
                raise ValueError(
                    f"ground is missing, which method = {self.method!r} needs; give one like the "
                    "record, for instance fit_ground(record)"
                )
            return
        expect(self.ground, Ground, "ground")
        if self.method != LINEARIZATION:
            raise ValueError(
                f"ground is given, which method = {self.method!r} does not use; leave it out, or give "
                f"method={LINEARIZATION!r}"
            )

    def of(self, first: Structure, second: Structure, recorded: xr.Dataset) -> xr.DataArray:
        """The correlation of structures with these peaks in a record."""
        if self.ground is not None:
            return correlate(first, second, self.ground, closure=self.closure).rho
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
        """What a history says of it."""
        if self.method == EFFECTIVE:
            return f"method={self.method!r}, rule={effective_rule(self.rule).name!r}"
        return f"method={self.method!r}" + (f", closure={self.closure!r}" if self.ground else "")


def energy_gap(
    first: Structure,
    second: Structure,
    record: Records,
    method: str = WHITE_NOISE,
    *,
    rule: str | EffectiveRule = "iwan_1980",
    ground: Ground | None = None,
    closure: str = "gaussian",
) -> xr.Dataset:
    """Critical gap in a recorded motion by the energy approach, and the gap that the motion needs.

    Eq. (3) with the pseudo energy radii of both structures, eqs. (1) and (2), elastic or yielding as
    they are, and a correlation coefficient by a formula; and what `recorded_gap` finds without either.

    Parameters
    ----------
    first, second : Bilinear, BoucWen or Hysteretic
        Elastic, or with strengths in metres; their parameters broadcast by dimension name.
    record : xarray.DataArray, or list or mapping of them
        Ground acceleration [m/s^2] over ``time``, as `read_record` gives it. Several records make
        a dimension ``record``.
    method : str
        Of the correlation: ``"white_noise"``, eq. (4) with the elastic periods and dampings;
        ``"effective"``, eq. (4) with those of ``rule`` at the peak ductilities in the record;
        ``"linearization"`` on ``ground``, as the paper advises for structures that yield.
    rule : str
        One of `effective_rule_names`, or a rule; for effective properties.
    ground : WhiteNoise, KanaiTajimi or CloughPenzien, optional
        One like the record, as `fit_ground` finds it: for linearization.
    closure : str
        As in `linearize`, for linearization.

    Returns
    -------
    xarray.Dataset
        Over the dimensions of the parameters what `recorded_gap` returns, ``pseudo_energy_radius_1`` and
        ``_2`` [m] among it, and ``critical_gap`` [m], eq. (3) with them and ``rho_estimate`` [-];
        ``critical_gap_error`` [-], by which it exceeds ``separation``, the gap that the record needs, as
        a share of that.

    Raises
    ------
    ValueError, TypeError
        As in `recorded_gap` and `correlate`; without a ground for linearization, or with one for another
        method.

    Notes
    -----
    Elastic ``rho`` is too small for structures that yield, so that eq. (4) gives too wide a gap;
    effective properties and linearization err both ways. All are means over many motions: in a single
    record two structures may meet although eq. (3) predicts that they do not.

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
        labels.label(estimated_gap(first, second, record, estimate), VARIABLES),
        "Critical gap in recorded motions by the energy approach, eq. (3)",
        f"energy_gap({estimate.told})",
        {"first": first, "second": second} | ({} if ground is None else {"ground": ground}),
    )


def estimated_gap(
    first: Structure, second: Structure, record: Records, estimate: RhoEstimate
) -> xr.Dataset:
    """What `energy_gap` returns, without what made it."""
    table = recorded_gap(first, second, record)
    radii = (table.pseudo_energy_radius_1, table.pseudo_energy_radius_2)
    rho = estimate.of(first, second, table)
    gap = xr.apply_ufunc(double_difference, *radii, rho, join="exact")
    with np.errstate(divide="ignore", invalid="ignore"):
        error = gap / table.separation - 1
    return table.assign(critical_gap=gap, rho_estimate=rho, critical_gap_error=error)
