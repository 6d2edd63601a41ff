"""Peak factors by name: those of Davenport, Der Kiureghian and Vanmarcke."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.quadrature import on_panels
from stochlin.messages import brief
from stochlin.models.arguments import checked
from stochlin.models.parameters import POSITIVE, Model, Parameter, parameter
from stochlin.models.rules import Published, look_up, publish
from stochlin.registry import Registry

PEAK_FACTORS: Registry[PeakFactor] = Registry("peak factor", "stochlin.models.rules.peak_factors")
EULER = float(np.euler_gamma)
FEWEST_PEAKS = float(np.exp(EULER / 2))  # smallest N from which L + 0.5772/L grows with N
# mean and std are exact to 1e-10 up to N = 1e8, compared with mpmath
PANELS = 28
NODES_PER_PANEL = 12
# Panels shrink towards 0, since F rises from 0 within x ~ N delta^1.2 where this is small.
_NODES, _WEIGHTS = on_panels(
    np.union1d(0.25 ** np.arange(2, 9), np.linspace(0, 1, PANELS)), NODES_PER_PANEL
)
# cells evaluated at a time, so that nodes times cells fit into the processor cache
CELLS_OF_PEAKS = 256


@dataclass(frozen=True, kw_only=True)
class PeakFactor(Published):
    """A peak factor: mean and standard deviation of the peak over that of the response.

    ``formula(N, delta)`` gives both, ``p`` and ``q``, of two-sided peaks for 1-D arrays of cells.
    """

    formula: Callable[[Array, Array], tuple[Array, Array]] = field(compare=False)
    # For one-sided peaks only half of the crossings count, and a clump has half as many of them.
    # The formula takes this into account by a bandwidth that is larger by this factor.
    spread: float = 1.0
    fewest: float = 1.0  # counted crossings from which the formula is defined
    needs: str = ""  # besides the crossings, for messages

    def mean(self, crossings: Array, bandwidth: Array, sides: int = 2) -> Array:
        """Mean peak factor ``p`` [-] for ``N`` crossings and the bandwidth ``delta``.

        ``sides`` is 2 for two-sided and 1 for one-sided peaks. Cells outside the domain are NaN.
        """
        return self._both(crossings, bandwidth, sides)[0]

    def std(self, crossings: Array, bandwidth: Array, sides: int = 2) -> Array:
        """Standard deviation ``q`` of the peak factor [-]; arguments as in `mean`."""
        return self._both(crossings, bandwidth, sides)[1]

    def domain(self, sides: int = 2) -> str:
        """The domain of the model in words, for messages."""
        crossings = f"at least {self.fewest * (3 - sides):.3g} zero crossings (both ways)"
        return f"{crossings} in the duration{self.needs}"

    def _both(self, crossings: Array, bandwidth: Array, sides: int) -> tuple[Array, Array]:
        if sides not in {1, 2}:
            raise ValueError(
                f"sides = {brief(sides)}; allowed: 2, the largest |u|, or 1, the largest u"
            )
        n, delta = np.broadcast_arrays(np.asarray(crossings, float), np.asarray(bandwidth, float))
        widest = 1.0
        if sides == 1:
            n = n / 2
            delta = delta * self.spread
            widest = self.spread
        inside = (n >= 1) & (n < np.inf) & (delta >= 0) & (delta <= widest)
        values = np.full((2, n.size), np.nan)
        values[:, inside.ravel()] = self.formula(n[inside], delta[inside])
        mean, std = values.reshape(2, *n.shape)
        return mean, std


def peak_factor_names() -> tuple[str, ...]:
    """Names of the peak factor models.

    Returns
    -------
    tuple of str
        Names for `peak_factor_model`.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.rules.peak_factor_names()
    ('Davenport1964', 'DerKiureghian1980', 'Vanmarcke1975')
    """
    return tuple(PEAK_FACTORS)


@checked
def peak_factor_model(name: str) -> PeakFactor:
    """Peak factor model by its name, with or without the year.

    Parameters
    ----------
    name : str
        One of `peak_factor_names`, or for instance ``"davenport"`` or ``"vanmarcke"``, in upper or
        lower case.

    Returns
    -------
    PeakFactor
        The model. Its methods ``mean`` and ``std`` give the mean and the standard deviation of the
        peak over the standard deviation of the response [-].

    Raises
    ------
    ValueError
        If the name is unknown; the message lists the known names.

    Examples
    --------
    >>> import stochlin as sl
    >>> model = sl.rules.peak_factor_model("vanmarcke")
    >>> round(float(model.mean(40, 0.2463)), 2), round(float(model.mean(40, 0.2463, sides=1)), 2)
    (2.63, 2.53)
    """
    return look_up(PEAK_FACTORS, name, "model")


@dataclass(frozen=True)
class StationaryMotion(Model):
    """A stationary motion of finite length: ``duration`` [s], positive."""

    of_arguments = True

    duration: Parameter = parameter("s", "duration of the motion", POSITIVE)


def davenport(n: Array, delta: Array) -> tuple[Array, Array]:
    """Independent crossings: ``p = L + 0.5772/L``, ``q = (pi/sqrt 6)/L``, ``L = sqrt(2 ln N)``.

    The formula is asymptotic for many crossings of a broad-band response. For a narrow band, in
    which crossings occur in clumps, it is too large. Below ``N = exp(0.5772/2) = 1.33`` the formula
    for p would decrease with N, and p is NaN. Below ``N = 6.8`` the formula for q exceeds 0.655,
    the standard deviation of the Rayleigh distribution, which it should not. One-sided peaks have
    ``N/2`` crossings.
    """
    mean = _extreme_value(n)
    with np.errstate(divide="ignore"):
        std = np.pi / np.sqrt(12 * np.log(n))
    return mean, np.where(np.isnan(mean), np.nan, std)


def der_kiureghian(n: Array, delta: Array) -> tuple[Array, Array]:
    """Davenport's mean with a fitted equivalent number ``Ne`` of independent crossings.

    ``Ne`` is ``max(2.1, 2 delta N)`` for ``delta <= 0.1``, ``(1.63 delta^0.45 - 0.38) N`` for
    ``delta`` up to 0.69, and ``N`` above; ``q = 1.2/L - 5.4/(13 + L^6.4)``, and 0.65 for ``Ne <=
    2.1``. Only the first of the three pieces has a lower bound; where the others give ``Ne <
    1.33``, p is NaN. The pieces do not quite meet at ``delta = 0.1``, where ``Ne`` falls by 0.8 %.

    One-sided peaks have ``N/2`` crossings and ``2 delta``. In a narrow band ``Ne`` then has its
    value for two-sided peaks, since the envelope has the same peak in both directions.
    """
    middle = (1.63 * delta**0.45 - 0.38) * n
    effective = np.where(delta <= 0.1, np.maximum(2.1, 2 * delta * n), middle)
    effective = np.where(delta > 0.69, n, effective)
    level = np.sqrt(2 * np.log(np.maximum(effective, 2.1)))
    std = np.where(effective > 2.1, 1.2 / level - 5.4 / (13 + level**6.4), 0.65)
    mean = _extreme_value(effective)
    return mean, np.where(np.isnan(mean), np.nan, std)


def vanmarcke(n: Array, delta: Array) -> tuple[Array, Array]:
    """First passage of the envelope, with crossings in clumps, from its stationary state.

    ``P(peak < x) = [1 - e^(-x^2/2)] exp{-N [1 - e^(-sqrt(pi/2) delta^1.2 x)] / (e^(x^2/2) - 1)}``,
    from which mean and standard deviation follow by quadrature.

    For one-sided peaks the up-crossings occur at half the rate, ``N/2``, and each clump has half as
    many of them, so that ``sqrt(2 pi)`` replaces ``sqrt(pi/2)``. The factor ``1 - e^(-x^2/2)``, for
    the start of the envelope, does not change. The narrow-band limits of one- and two-sided peaks
    are equal.
    """
    moments = np.empty((2, n.size))
    for begin in range(0, n.size, CELLS_OF_PEAKS):
        cells = slice(begin, begin + CELLS_OF_PEAKS)
        moments[:, cells] = _survival_moments(n[cells, None], delta[cells, None])
    mean, square = moments
    return mean, np.sqrt(np.maximum(square - mean**2, 0))


def _extreme_value(n: Array) -> Array:
    """Mean peak factor ``L + 0.5772/L``, ``L = sqrt(2 ln N)``; NaN where it decreases with N."""
    level = np.sqrt(2 * np.log(np.maximum(n, FEWEST_PEAKS)))
    return np.where(n >= FEWEST_PEAKS, level + EULER / level, np.nan)


@np.errstate(over="ignore")  # of the rate, where the exceedance is 0 or 1
def _survival_moments(n: Array, delta: Array) -> tuple[Array, Array]:
    """First moments ``Int (1 - F) dx`` and ``Int 2 x (1 - F) dx`` of Vanmarcke's distribution F."""
    reach = np.sqrt(2 * (np.log1p(n) + 37))  # for larger x, 1 - F is below 1e-16
    x = reach * _NODES
    weight = reach * _WEIGHTS
    rate = -n * np.expm1(-np.sqrt(np.pi / 2) * delta**1.2 * x) / np.expm1(0.5 * x * x)
    # 1 - F = 1 - (1 - a) e^-r with a the start and r the rate, without cancellation for small a and
    # r
    start = np.exp(-0.5 * x * x)
    exceeding = start * np.exp(-rate) - np.expm1(-rate)
    return (weight * exceeding).sum(axis=1), (weight * 2 * x * exceeding).sum(axis=1)


OF_BAND = ", 0 <= bandwidth <= 1"
MODELS = (
    PeakFactor(
        name="Davenport1964",
        reference="Davenport, A. G. (1964), Proc. Inst. Civil Eng. 28, 187-196",
        formula=davenport,
        fewest=FEWEST_PEAKS,
    ),
    PeakFactor(
        name="DerKiureghian1980",
        reference="Der Kiureghian, A. (1980), J. Eng. Mech. Div. ASCE 106, 1195-1213",
        formula=der_kiureghian,
        spread=2.0,
        needs=f"{OF_BAND}, and Ne >= {FEWEST_PEAKS:.3g} independent ones",
    ),
    PeakFactor(
        name="Vanmarcke1975",
        reference="Vanmarcke, E. H. (1975), J. Appl. Mech. 42, 215-220",
        formula=vanmarcke,
        spread=2 ** (1 / 1.2),
        needs=OF_BAND,
    ),
)
for place, model in enumerate(MODELS):
    publish(PEAK_FACTORS, model, place)
