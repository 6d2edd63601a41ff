"""Modes in closed form, one ordinate for all of them, a double sum over the three; in metres."""

from math import hypot, pi, sqrt

PROGRAM = "by hand"

g, ag, xi = 9.80665, 0.25, 0.05
plateau = ag * g * 1.2 * 2.5  # from 0.15 to 0.5 s on ground B

# The extension: det [k1 + k2 - m1 s, -k2; -k2, k2 - m2 s] = 0.
m1, m2, k1, k2 = 2.55e5, 2.05e5, 9.0e7, 1.76e8
b, root = (k1 + k2) * m2 + k2 * m1, 4 * m1 * m2 * k1 * k2
squares = [(b - sign * sqrt(b**2 - root)) / (2 * m1 * m2) for sign in (1, -1)]
roofs = [(k1 + k2 - m1 * square) / k2 for square in squares]  # over the first floor
factors = [(m1 + m2 * roof) / (m1 + m2 * roof**2) for roof in roofs]

m, k, level = 3e5, 6.4e7, 7.2  # of the hall
w = [sqrt(k / m), *map(sqrt, squares)]
D = [plateau / each**2 for each in w]
shares = {  # of the three oscillators in the displacements at 4.0 and 7.2 m
    4.0: [4.0 / level, *factors],
    level: [1.0, *(factor * roof for factor, roof in zip(factors, roofs, strict=True))],
}


def rho(one, other):
    """Eq. (4) with equal damping ratios."""
    r = other / one
    return 8 * xi**2 * (1 + r) * r**1.5 / ((1 - r**2) ** 2 + 4 * xi**2 * r * (1 + r) ** 2)


def combined(terms):
    return sqrt(
        sum(a * c * rho(w[i], w[j]) for i, a in enumerate(terms) for j, c in enumerate(terms))
    )


columns = []
for of_height in shares.values():
    hall, first, second = (share * d for share, d in zip(of_height, D, strict=True))
    peak_1, peak_2 = hall, combined([0.0, first, second])
    cqc = combined([hall, -first, -second])
    shared = (peak_1**2 + peak_2**2 - cqc**2) / (2 * peak_1 * peak_2)
    columns.append((peak_1, peak_2, shared, cqc, hypot(peak_1, peak_2), peak_1 + peak_2))
peaks_1, peaks_2, shared, cqc, srss, total = (list(each) for each in zip(*columns, strict=True))

ANSWERS = {"peak_1": peaks_1, "peak_2": peaks_2, "rho": shared, "cqc": cqc, "gap": [srss, total]}
NUMBERS = {
    **{"mass": m / 1e3, "stiffness": k / 1e6, "level": level, "damping": 100 * xi},
    **{"ag": ag, "sa": plateau, "periods": [2 * pi / each for each in w]},
    **{"sd": [100 * d for d in D], "roof": shares[level]},
    **{"rho_1": rho(w[0], w[1]), "rho_2": rho(w[0], w[2]), "rho_own": rho(w[1], w[2])},
    **{"terms": [100 * share * d for share, d in zip(shares[level], D, strict=True)]},
    **{"own": 100 * peaks_2[1], "gap_cqc": 100 * cqc[1]},
    **{"gap_srss": 100 * srss[1], "gap_sum": 100 * total[1]},
}
