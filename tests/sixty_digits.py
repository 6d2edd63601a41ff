"""Lyapunov equations in 60 digits: those of the fast path and of systems are held against them."""

import cases
import mpmath

DIGITS = 60


def exact_covariance(blocks, filters):
    """Kronecker solution of the Lyapunov equation, in the unknowns on and above the diagonal."""
    number = mpmath.mpf
    matrix, noise = cases.augmented_system(
        [[number(x) for x in block] for block in blocks], [number(x) for x in filters]
    )
    return exact_lyapunov(matrix, noise)


def exact_lyapunov(matrix, noise):
    """The same of any matrix and noise, under white noise of two-sided PSD 1."""
    number = mpmath.mpf
    size = len(matrix)
    index = {
        (i, j): n for n, (i, j) in enumerate((i, j) for i in range(size) for j in range(i, size))
    }
    rows = []
    for i, j in index:
        row = [number(0)] * (len(index) + 1)
        for k in range(size):
            row[index[min(k, j), max(k, j)]] += matrix[i][k]
            row[index[min(i, k), max(i, k)]] += matrix[j][k]
        row[-1] = -2 * mpmath.pi * noise[i] * noise[j]
        rows.append(row)
    solution = eliminate(rows)
    return lambda i, j: solution[index[min(i, j), max(i, j)]]


def eliminate(rows):
    """Gauss with partial pivoting on rows that end in their right-hand side; zeros are skipped."""
    size = len(rows)
    for column in range(size):
        pivot = max(range(column, size), key=lambda i: abs(rows[i][column]))
        rows[column], rows[pivot] = rows[pivot], rows[column]
        top = rows[column]
        entries = [k for k in range(column + 1, size + 1) if top[k]]
        for row in rows[column + 1 :]:
            if row[column]:
                factor = row[column] / top[column]
                for k in entries:
                    row[k] -= factor * top[k]
    solution = [mpmath.mpf(0)] * size
    for i in reversed(range(size)):
        rest = sum(rows[i][k] * solution[k] for k in range(i + 1, size) if rows[i][k])
        solution[i] = (rows[i][size] - rest) / rows[i][i]
    return solution


def with_law(system):
    """``(stiffness, damping, coupling, c, k)``, exactly: ``slip - 1`` would round in floats."""
    w2, d, h, p, k = (mpmath.mpf(float(x)) for x in system)
    return w2, d, h, p - 1, k
