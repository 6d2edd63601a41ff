"""First modes in closed form, the spectrum by its formula, and one line per code; in metres."""

from math import hypot, pi, sqrt

PROGRAM = "by hand"

g, ag, S, TC = 9.80665, 0.25, 1.15, 0.6


def displacement(period):
    """Of an elastic oscillator, on the plateau of the spectrum or beyond it."""
    return ag * g * S * 2.5 * min(1, TC / period) * (period / (2 * pi)) ** 2


# The clinic: a straight line over the height.
levels = [4.0, 7.2, 10.4, 13.6]
share_1 = levels[1] * sum(levels) / sum(level**2 for level in levels)
# The extension: det [k1 + k2 - m1 s, -k2; -k2, k2 - m2 s] = 0.
m1, m2, k1, k2 = 2.55e5, 2.05e5, 9.0e7, 1.76e8
b = (k1 + k2) * m2 + k2 * m1
square = (b - sqrt(b**2 - 4 * m1 * m2 * k1 * k2)) / (2 * m1 * m2)
roof = (k1 + k2 - m1 * square) / k2  # over the first floor
share_2 = roof * (m1 + m2 * roof) / (m1 + m2 * roof**2)

periods = 0.7, 2 * pi / sqrt(square)
elastic = [
    share * displacement(period) for share, period in zip((share_1, share_2), periods, strict=True)
]
behaviour, deflection = (3.0, 5.0), (2.5, 4.5)
design = [value / q for value, q in zip(elastic, behaviour, strict=True)]
of_ec8 = [value * q for value, q in zip(design, behaviour, strict=True)]
of_asce = [value * cd for value, cd in zip(design, deflection, strict=True)]
peaks = 0.083, 0.065

ANSWERS = {
    "gap": [0.7 * hypot(*of_ec8), hypot(*of_asce)],
    "combination": [0.7 * hypot(*peaks), hypot(*peaks)],
}
NUMBERS = {
    **{"ag": ag, "level": levels[1], "behaviour": behaviour, "deflection": deflection},
    "peaks": [100 * peak for peak in peaks],
    **{"period": periods[1], "share_1": share_1, "share_2": share_2},
    **{"sd_1": 100 * displacement(periods[0]), "sd_2": 100 * displacement(periods[1])},
    **{"elastic_1": 100 * elastic[0], "elastic_2": 100 * elastic[1]},
    **{"design_1": 100 * design[0], "design_2": 100 * design[1]},
    **{"asce_1": 100 * of_asce[0], "asce_2": 100 * of_asce[1]},
    **{"root": 100 * hypot(*elastic), "ec8": 70 * hypot(*elastic), "asce": 100 * hypot(*of_asce)},
    **{"root_of_peaks": 100 * hypot(*peaks), "ec8_of_peaks": 70 * hypot(*peaks)},
}
