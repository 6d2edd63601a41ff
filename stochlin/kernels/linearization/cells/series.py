"""A function of one variable by Chebyshev series, with one series for each unit of its range."""

from stochlin.kernels.basics.compiled import entry


@entry
def evaluate(x, begin, table, out):
    """Write the function at ``x`` (n,) to ``out``, by Clenshaw's recursion.

    ``table`` (terms, panels) has the coefficients of each series; the first panel starts at ``begin``.
    Outside the range the value at its nearer end is taken.
    """
    terms, panels = table.shape
    for n in range(x.size):
        at = min(max(x[n] - begin, 0.0), float(panels))
        panel = min(int(at), panels - 1)
        u = 4 * (at - panel) - 2
        b_1, b_2 = 0.0, 0.0
        for term in range(terms - 1, 0, -1):
            b_1, b_2 = table[term, panel] + u * b_1 - b_2, b_1
        out[n] = table[0, panel] + 0.5 * u * b_1 - b_2
