"""Structures with a hysteresis law that the user gives as sympy expressions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import KW_ONLY, dataclass
from typing import TYPE_CHECKING, Any

from stochlin.messages import brief, listed
from stochlin.models.states import in_words, rates_by_state
from stochlin.models.structures import LAWS, Structure

if TYPE_CHECKING:
    import sympy

    from stochlin.models.states import Rates


@LAWS.register("hysteretic", place=3)
@dataclass(frozen=True)
class Hysteretic(Structure):
    """Oscillator with any hysteresis law ``z' = G(v, z)``, or of more states, in sympy expressions.

    Parameters
    ----------
    period, damping, hardening, yield_displacement, reduction_factor, peak_factor
        As in `Bilinear`.
    law : sympy.Expr or mapping
        ``G`` [1/s] in symbols named ``v``, the ductility rate [1/s], and ``z`` [-]. The law is odd:
        ``G(-v, -z) = -G(v, z)``. It may contain sums, products, powers, ``Abs``, ``sign``, ``Max``,
        ``Min``, ``Heaviside``, ``Piecewise``, ``exp``, ``log``, and trigonometric and hyperbolic
        functions and their inverses.

        A law with memory has at most 7 further states, such as the energy that it has dissipated.
        It is a mapping of the names of all states, among them ``"z"``, to their rates in ``v`` and
        the states. All states are 0 before a motion. If ``v`` and ``z`` are reversed, so is the
        rate of ``z``. The law is kept as pairs of names and rates.
    mass : float, optional
        As in `Bilinear`.
    growing_states : sequence of str, optional
        Those of the further states that keep their sign, and that of their rate, when ``v`` and
        ``z`` are reversed, as an energy does; by default all. All others are then reversed with
        their rate, as a displacement is. A law with growing states has no stationary response.

    Raises
    ------
    ValueError, TypeError
        As in `Bilinear`; also if the law is not given, has other symbols or functions, differs in
        both directions, or is not finite with ``z`` between -2.5 and 2.5 and further states from 0
        to 2.5. What linearizes raises an ArithmeticError if the law has kinks that cannot be
        located, or powers of ``Abs(z)`` below 1/2. For a law of several states it also does for a
        stationary response, and in time for further states that turn with the motion.

    References
    ----------
    Roberts, J. B. and Spanos, P. D. (1990), Random vibration and statistical linearization. Baber,
    T. T. and Wen, Y. K. (1981), J. Eng. Mech. Div. ASCE 107, for laws that degrade with the energy.

    Examples
    --------
    >>> import stochlin as sl, sympy
    >>> v, z = sympy.symbols("v z")
    >>> friction = sl.Hysteretic(1.0, 0.05, 0.1, reduction_factor=2, law=v - abs(v) * z)
    >>> friction.closure_names()
    ('gaussian',)

    The stiffness decreases as the energy ``e`` grows:

    >>> e = sympy.Symbol("e")
    >>> rates = {"z": (v - abs(v) * z) / (1 + 0.05 * e), "e": z * v}
    >>> wearing = sl.Hysteretic(1.0, 0.05, 0.1, yield_displacement=0.02, law=rates)
    >>> ground = sl.KanaiTajimi(0.4, 0.6, 0.02)
    >>> sl.simulate([wearing], ground, paths=32, duration=10.0).sizes["path"]
    32
    """

    law: sympy.Expr | Mapping[str, sympy.Expr] | Rates | None = None
    _: KW_ONLY
    growing_states: Sequence[str] | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        rates = rates_by_state(self.law)
        object.__setattr__(self, "law", rates if len(rates) > 1 else rates[0][1])
        object.__setattr__(self, "growing_states", self._growing([name for name, _ in rates[1:]]))
        _ = self._compiled

    def symbolic(self) -> sympy.Expr | Mapping[str, sympy.Expr]:
        """The sympy expression given as ``law``, or the rates of several states by name."""
        return dict(self.law) if isinstance(self.law, tuple) else self.law

    def growing(self) -> tuple[str, ...]:
        """The ``growing_states``."""
        return tuple(self.growing_states or ())

    def _growing(self, further: list[str]) -> tuple[str, ...]:
        """The growing states in the order of the states; all further ones if none are named."""
        names = further if self.growing_states is None else self.growing_states
        texts = isinstance(names, (list, tuple)) and all(isinstance(name, str) for name in names)
        if not texts or not {*names} <= {*further}:
            raise ValueError(f"growing_states = {brief(names)}; allowed: some of {brief(further)}")
        return tuple(name for name in further if name in names)

    def further(self) -> list[str]:
        """The law."""
        return [f"law {in_words(self.law)}"]


def law_of(
    law: str | sympy.Expr | Mapping[str, sympy.Expr],
    common: Mapping[str, Any],
    further: Mapping[str, Any],
) -> Structure:
    """A structure with a law that is given by its name, as a sympy expression, or by several.

    ``common`` are parameters of every structure, ``further`` those that this law adds, both by
    name.

    Raises
    ------
    ValueError, TypeError
        If the law is not known, or if ``further`` has unknown parameters or lacks required ones.
    """
    kind = LAWS.named(law, "law") if isinstance(law, str) else Hysteretic
    if kind is Hysteretic:
        if isinstance(law, str):
            raise ValueError(
                "law = 'hysteretic' has no expression; give the sympy expression itself"
            )
        common = {**common, "law": law}
    allowed_names = kind.own_parameters()
    unknown = [name for name in further if name not in allowed_names]
    missing = [name for name in allowed_names if name not in further and not hasattr(kind, name)]
    if unknown or missing:
        what = f"has no {listed(unknown)}" if unknown else f"needs {listed(missing)} as well"
        what = f"law_parameters = {brief(dict(further))}: the law {what}"
        allowed = ", ".join(allowed_names)
        raise ValueError(f"{what}; allowed: {allowed or 'none'}")
    return kind(**common, **further)
