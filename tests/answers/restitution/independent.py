"""A free mass runs into each element; the damping is sought until .65 of its velocity is left."""

from scipy.integrate import solve_ivp
from scipy.optimize import brentq

PROGRAM = "by hand, scipy"

e = 0.65

# Unit mass, stiffness and approach velocity; damping ratio (HertzDamp: factor) x.
FORCES = {
    "Kelvin": lambda d, v, x: d + 2 * x * v,
    "NoTensionKelvin": lambda d, v, x: d + 2 * x * v,
    "ImpactKelvin": lambda d, v, x: d + 2 * x * max(v, 0),
    "Jankowski": lambda d, v, x: max(d, 0) ** 1.5 + 2 * x * max(d, 0) ** 0.25 * max(v, 0),
    "HertzDamp": lambda d, v, x: max(d, 0) ** 1.5 * (1 + x * v),
}


def left(name, x):
    """Share of the velocity that is left: at the greatest compression the run is taken up anew."""
    force = FORCES[name]

    def turned(t, y):
        return y[1]

    def ended(t, y):
        return force(y[0], y[1], x) if name == "NoTensionKelvin" else y[0]

    turned.terminal = ended.terminal = True
    turned.direction = ended.direction = -1

    def run(state, event):
        return solve_ivp(
            lambda t, y: (y[1], -force(y[0], y[1], x)),
            (0, 20),
            state,
            method="DOP853",
            rtol=1e-13,
            atol=1e-15,
            events=event,
        ).y[:, -1]

    d, _ = run((0.0, 1.0), turned)
    return -run((d, -1e-300), ended)[1]


ANSWERS = {
    "damping": [
        brentq(lambda x, name=name: left(name, x) - e, 0.01, 2.0, xtol=1e-13) for name in FORCES
    ]
}
NUMBERS = {"e": e}
