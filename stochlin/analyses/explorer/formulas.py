"""What the explorer shows of a scene by formula: spectra, correlation, gaps by rule, probability.

Where linearization fails, each raises an ArithmeticError.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
import xarray as xr

from stochlin.analyses.cases.separation import AROUND, periods_of
from stochlin.analyses.correlation.correlation import rho_white_noise
from stochlin.analyses.correlation.drifting import correlation_with_drift
from stochlin.analyses.correlation.linearized import pairs_of_solved
from stochlin.analyses.correlation.variables import VARIABLES as OF_PAIRS
from stochlin.analyses.explorer.scene import Scene
from stochlin.analyses.linearization.equivalent_systems import INTERNAL, solve_structure
from stochlin.analyses.linearization.peaks import relative_moments, response_moments
from stochlin.analyses.linearization.tolerance import USUAL
from stochlin.analyses.probability.probability import pounding_probability
from stochlin.analyses.separation.rules import (
    EQ_3,
    code_rules,
    equation_3_rule,
    linearized_rule,
    peak_quantile,
    strong_seconds,
)
from stochlin.analyses.separation.separation import TEXTS
from stochlin.analyses.separation.variables import VARIABLES as OF_GAPS
from stochlin.analyses.tables import labels
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.covariance import EquivalentSystem
from stochlin.models.parameters import Model
from stochlin.models.structures import DRIFT, Structure

FREQUENCIES = 301
_EVEN = np.linspace(-1, 1, 49)
RATIOS = 4.0 ** (np.sign(_EVEN) * np.abs(_EVEN) ** 1.5)  # of T2 to T1, closer around 1
LINEARIZED_PEAKS = "peaks of linearization"
DRIFTED_PEAKS = "peaks by standard deviations of the drift closure and peak factors of linearization"


class _SolvedScene(NamedTuple):
    """Both buildings as solved, the second with every period, and where its own is."""

    structures: tuple[Structure, Structure]
    gaussian: tuple[xr.Dataset, xr.Dataset]
    drift: tuple[xr.Dataset, xr.Dataset]
    own: int

    def single(self, sides: tuple[xr.Dataset, xr.Dataset]) -> list[xr.Dataset]:
        """Both with their own periods."""
        return [sides[0], sides[1].isel(period_ratio=self.own, drop=True)]


@lru_cache(maxsize=8)  # three views of one scene share it
def _solved(scene: Scene) -> _SolvedScene:
    ratio = scene.period_2 / scene.period_1
    ratios = np.union1d(RATIOS, ratio)
    own = int(np.searchsorted(ratios, ratio))
    structures = scene.structure(1), swept(scene, ratios)
    ground = scene.ground()
    one, other, one_drifting, other_drifting = (
        solve_structure(structure, ground, closure, USUAL)
        for closure in ("gaussian", DRIFT)
        for structure in structures
    )
    pair = _SolvedScene(structures, (one, other), (one_drifting, other_drifting), own)
    for structure, side in zip(scene.structures(), pair.single(pair.gaussian), strict=True):
        labels.raise_if_lone_failure(side, structure.describe())
    return pair


def spectra(scene: Scene) -> xr.Dataset:
    """Spectra of the ground and of both buildings' displacements, linearized.

    Over ``frequency`` [rad/s], with the coordinate ``period`` [s]: ``psd_ground`` [m^2/s^3] and
    ``displacement_psd_1`` and ``_2`` [m^2 s], two-sided.
    """
    ground = scene.ground()
    periods = periods_of(*scene.structures(), ground)
    low, high = min(periods) / AROUND, max(periods) * AROUND
    # The periods themselves belong to the grid: a resonance is narrow.
    period = np.unique(np.concatenate([np.geomspace(low, high, FREQUENCIES), periods]))[::-1]
    frequency = 2 * np.pi / period
    density = ground.psd(frequency)
    table = density.rename("psd_ground").to_dataset()
    pair = _solved(scene)
    for number, side in enumerate(pair.single(pair.gaussian), start=1):
        system = EquivalentSystem(*(side[name].to_numpy() for name in INTERNAL[:5]))
        response = density * system.transfer_squared(frequency)
        told = f"two-sided PSD of the displacement, building {number}, linearized"
        response.attrs = {"units": "m^2 s", "long_name": told}
        table[f"displacement_psd_{number}"] = response
    attrs = {"units": "s", "long_name": "period"}
    table = table.assign_coords(period=("frequency", period, attrs))
    table.frequency.attrs = {"units": "rad/s", "long_name": "circular frequency"}
    return _described(scene, table, "Spectra of ground and displacements", "spectra")


@lru_cache(maxsize=8)
def correlation(scene: Scene) -> xr.Dataset:
    """Correlation over the ratio of the periods, that of building 1 fixed: eq. (4) and two closures.

    Over ``period_ratio`` [-], ``T2/T1``, that of the scene among the values: ``rho_white_noise`` [-],
    eq. (4), ``rho_linearized`` [-] (Gaussian closure) and ``rho_drift`` [-]; ``bias``, ``bias_1`` and
    ``bias_2`` of the Gaussian closure and its flag ``caution``. The scene's own ratio is an attribute.
    """
    pair, ground = _solved(scene), scene.ground()
    first, second = pair.structures
    sides = list(pair.gaussian)
    table = pairs_of_solved(pair.structures, ground, sides, sides)
    arguments = (first.period, second.period, first.damping, second.damping)
    shown = {name: table[name] for name in ("bias", "bias_1", "bias_2", "caution", "status")}
    shown |= {
        "rho_white_noise": rho_white_noise(*arguments).rho.drop_attrs(),
        "rho_linearized": table.rho.drop_attrs(),
        "rho_drift": correlation_with_drift(pair.structures, list(pair.drift), ground, USUAL),
    }
    texts = ("eq. (4)", "linearization, Gaussian closure", "linearization, drift closure")
    for name, text in zip(list(shown)[-3:], texts, strict=True):
        shown[name].attrs = {"units": "1", "long_name": f"correlation coefficient, {text}"}
    ratio = scene.period_2 / scene.period_1
    found = labels.label(xr.Dataset(shown), OF_PAIRS).assign_attrs(period_ratio=ratio)
    if scene.yields_1 or scene.yields_2:
        found.attrs["comment"] = f"{labels.CAUTION_RHO} {labels.CAUTION_SIGMA}"
    return _described(scene, found, "Correlation over the ratio of periods", "correlation")


def gap_rules(scene: Scene) -> xr.Dataset:
    """The gap by the rules that need no simulation.

    Peaks are standard deviations of the drift closure times peak factors of linearization; those of
    linearization alone only in ``eq_3_linearized`` and ``linearization``. Over ``rule``: ``gap`` [m],
    NaN where the rule has none, and ``rho`` [-]; the coordinates of `separation`.
    """
    ground, seconds = scene.ground(), strong_seconds(scene.duration, scene.motion_envelope())
    pair = _solved(scene)
    solved, drifting = pair.single(pair.gaussian), pair.single(pair.drift)
    moments = [response_moments(side, ground) for side in solved]
    both = tuple(xr.concat(parts, "building") for parts in zip(*moments, strict=True))
    peaks = peak_quantile(both, seconds, scene.confidence, 2).to_numpy()
    if not np.isfinite(peaks).all():
        raise ValueError(
            f"duration = {scene.duration:g} s is too short for these periods to tell a peak; allowed: "
            "some periods and more"
        )
    drifted = peaks * [
        float(d.displacement_std / s.displacement_std) for d, s in zip(drifting, solved, strict=True)
    ]
    rho = correlation(scene).isel(period_ratio=pair.own)
    linear = {"mark": "C", "assumptions": f"{EQ_3}; {LINEARIZED_PEAKS}"}
    drift = {"mark": "C", "assumptions": f"{EQ_3}; {DRIFTED_PEAKS}"}
    rules = [
        equation_3_rule(drifted[:, None], "eq_3_drift", rho.rho_drift.values, **drift),
        equation_3_rule(drifted[:, None], "eq_3_white_noise", rho.rho_white_noise.values, **drift),
        equation_3_rule(peaks[:, None], "eq_3_linearized", rho.rho_linearized.values, **linear),
        linearized_rule(
            lambda: relative_moments(solved[0], solved[1], ground),
            seconds,
            scene.confidence,
        ),
        *code_rules(drifted[:, None], scene.heights, scene.floors_align, scene.zone),
    ]
    columns = {name: ("rule", [getattr(rule, name) for rule in rules]) for name in TEXTS}
    table = xr.Dataset(
        {name: ("rule", [getattr(rule, name) for rule in rules]) for name in ("gap", "rho")},
        coords={"rule": ("rule", [rule.name for rule in rules]), **columns},
    )
    for name, text in TEXTS.items():
        table[name].attrs["long_name"] = text
    table = table.assign_attrs(peaks="drift closure", gap_m=scene.gap, confidence=scene.confidence)
    table = labels.label(table, OF_GAPS)
    return _described(scene, table, "Gap by rules without simulation", "gap_rules")


def probability(scene: Scene) -> xr.Dataset:
    """Probability of no pounding over time, by formula: `pounding_probability` without simulation."""
    return pounding_probability(
        *scene.structures(), scene.ground(), scene.gap, **scene.motion(), paths=0
    )


def swept(scene: Scene, ratios: Array) -> Structure:
    """Building 2 with every ratio of its period to that of building 1."""
    ratio = labels.axis("period_ratio", "ratio of the periods, T2/T1", ratios)
    return scene.structure(2, period=scene.period_1 * ratio)


def models_of(scene: Scene) -> dict[str, Model]:
    """What a scene is of, by the words of run information."""
    first, second = scene.structures()
    envelope = scene.motion_envelope()
    models = {"first": first, "second": second, "ground": scene.ground()}
    return models | ({"envelope": envelope} if envelope else {})


def _described(scene: Scene, table: xr.Dataset, title: str, call: str) -> xr.Dataset:
    ground = scene.ground()
    return labels.with_run_information(table, f"{title}, {ground.name} ground", call, models_of(scene))
