"""A function of one variable by Chebyshev series, with one series for each unit of its range."""

from stochlin.kernels.basics.compiled import entry
from stochlin.kernels.linearization.cells.tiles import LANES


@entry
def evaluate(x, begin, table, out):
    """Write the function at ``x`` (n,) to ``out``, by Clenshaw's recursion.

    ``table`` (terms, panels) has the coefficients of each series; the first panel starts at ``begin``.
    Outside the range the value at its nearer end is taken.
    """
    terms, panels = table.shape
    for start in range(0, x.size, LANES):
        for lane in range(start, min(start + LANES, x.size)):
            at = min(max(x[lane] - begin, 0.0), float(panels))
            panel = min(int(at), panels - 1)
            u = 4 * (at - panel) - 2
            b_1, b_2 = 0.0, 0.0
            for n in range(terms - 1, 0, -1):
                b_1, b_2 = table[n, panel] + u * b_1 - b_2, b_1
            out[lane] = table[0, panel] + 0.5 * u * b_1 - b_2
