"""One tile of a table of pairs, compiled: which structures, their correlation, and its bias.

The covariance of a pair is `covariance.pair_row`, arranged for speed. By the theorem of Cayley and
Hamilton ``A^3 = -a2 A^2 - a1 A - a0`` for the softer structure, so that with the coefficients of the
stiffer one marked by ``'`` its 3 x 3 matrix is

    D'(-A) = (a2' + a2) A^2 + (a1 - a1') A + (a0' + a0).

What belongs to one structure is computed once; some 70 multiplications and additions and one
division remain a cell, in vector registers. The modal form would cost five divisions, and fails where
a structure has a double eigenvalue: `benchmarks/tables.py` holds it against elimination.
"""

import numpy as np

from stochlin.kernels.basics.compiled import called_often, compiled

LANES = 128  # cells of a tile: both structures of each then fit the first-level cache
PARAMETERS = 21  # of a structure, as `pair_tables.pair_parameters` lists them
BACK, STIFFNESS, KICK, STD = 17, 18, 19, 20  # of these
SHARED = 4  # axes of the map of the bias that the two structures share
ROUNDING = 1e-9  # by which a point may miss the end of an axis
EQUAL = 1e-6  # relative difference of properties that count as equal


@compiled
def cells_of_tile(begin, count, shape, strides, cells):
    """Numbers of one side's structures in ``count`` cells from ``begin``; the last goes on."""
    at = np.empty(shape.size, np.int64)
    rest, cell = begin, 0
    for d in range(shape.size - 1, -1, -1):
        at[d] = rest % shape[d]
        rest //= shape[d]
        cell += at[d] * strides[d]
    for lane in range(LANES):
        cells[lane] = cell
        if lane >= count - 1:
            continue
        for d in range(shape.size - 1, -1, -1):
            at[d] += 1
            cell += strides[d]
            if at[d] < shape[d]:
                break
            cell -= at[d] * strides[d]
            at[d] = 0


@compiled
def _load(parameters, cells, tile, loaded):
    """The parameters of the structures of a tile, one parameter after the other.

    ``loaded`` are those that are there already: of a table's row, one structure stays.
    """
    first, apart, other = cells[0], 0, 0
    for lane in range(LANES):
        apart |= cells[lane] - first - lane
        other |= cells[lane] - loaded[lane]
        loaded[lane] = cells[lane]
    if other == 0:
        return
    for n in range(PARAMETERS):
        at = n * LANES
        if apart == 0:
            row = parameters[n, first : first + LANES]
            for lane in range(LANES):
                tile[at + lane] = row[lane]
        else:
            for lane in range(LANES):
                tile[at + lane] = parameters[n, cells[lane]]


@compiled
def _put_stiffer_first(stiff, soft):
    """Exchange the two structures of a lane where the second is the stiffer."""
    for lane in range(LANES):
        if stiff[STIFFNESS * LANES + lane] < soft[STIFFNESS * LANES + lane]:
            for n in range(lane, PARAMETERS * LANES, LANES):
                stiff[n], soft[n] = soft[n], stiff[n]


@called_often
def correlation(stiff, soft, n, lanes):
    """``rho`` in one of so many lanes, from the parameters of the stiffer structure and the softer."""
    w, d, h = soft[n], soft[lanes + n], soft[2 * lanes + n]
    p, k, back = soft[3 * lanes + n], soft[4 * lanes + n], soft[BACK * lanes + n]
    stiff_d, stiff_k = stiff[lanes + n], stiff[4 * lanes + n]
    stiff_mu = stiff[5 * lanes + n]
    e = stiff[8 * lanes + n] + soft[8 * lanes + n]
    f = soft[9 * lanes + n] - stiff[9 * lanes + n]
    g = stiff[10 * lanes + n] + soft[10 * lanes + n]
    m00, m01, m02 = g - e * w, f - e * d, e * h
    m10 = e * soft[11 * lanes + n] - f * w
    m11 = e * soft[12 * lanes + n] - f * d + g
    m12 = e * soft[13 * lanes + n] + f * h
    m20 = e * soft[14 * lanes + n] + f * back
    m21 = e * soft[15 * lanes + n] + f * p
    m22 = e * soft[16 * lanes + n] - f * k + g
    u0 = soft[5 * lanes + n] - stiff_mu
    u1 = soft[6 * lanes + n] + stiff[6 * lanes + n] + (d + stiff_d) * stiff_mu
    u2 = soft[7 * lanes + n] - p * stiff_mu
    r0 = stiff_k * u0 - u1
    r1 = stiff_k * u1 + w * u0 + d * u1 - h * u2 + stiff[KICK * lanes + n]
    r2 = stiff_k * u2 - back * u0 - p * u1 + k * u2
    c0, c1, c2 = m11 * m22 - m12 * m21, m02 * m21 - m01 * m22, m01 * m12 - m02 * m11
    scale = stiff[STD * lanes + n] * soft[STD * lanes + n]
    return (c0 * r0 + c1 * r1 + c2 * r2) / ((c0 * m00 + c1 * m10 + c2 * m20) * scale)


@compiled
def _correlations(stiff, soft, out):
    """``rho`` of all lanes, from the parameters of the stiffer structure of each and of the softer."""
    for n in range(LANES):
        out[n] = correlation(stiff, soft, n, LANES)


@compiled
def rho_of_tile(one, two, cells_1, cells_2, a, b, loaded, out):
    """``rho`` of a tile, the stiffer structure first (`covariance.pair_covariance` says why).

    ``a`` and ``b`` are space for the structures, ``loaded`` says which are there.
    """
    _load(one, cells_1, a, loaded[0])
    _load(two, cells_2, b, loaded[1])
    stiffer = 0
    for lane in range(LANES):
        stiffer += a[STIFFNESS * LANES + lane] >= b[STIFFNESS * LANES + lane]
    if stiffer == 0:
        _correlations(b, a, out)
        return
    if stiffer < LANES:
        _put_stiffer_first(a, b)
        loaded[:] = -1
    _correlations(a, b, out)


@compiled
def _bracket(axes, d, size, x, low):
    """The interval of ``x`` on axis ``d``, sought from ``low`` on; -1 outside."""
    if not axes[d, 0] - ROUNDING <= x <= axes[d, size - 1] + ROUNDING:
        return -1
    while low > 0 and x < axes[d, low]:
        low -= 1
    while low < size - 2 and x >= axes[d, low + 1]:
        low += 1
    return low


@compiled
def _share(axes, d, low, x):
    x = min(max(x, axes[d, low]), axes[d, low + 1])
    return (x - axes[d, low]) / (axes[d, low + 1] - axes[d, low])


@compiled
def _locate(axes, sizes, point, weights, offsets):
    """Corners around a point of the shared axes; False outside."""
    weights[0], offsets[0], count = 1.0, 0, 1
    for d in range(SHARED):
        low = _bracket(axes, d, sizes[d], point[d], 0)
        if low < 0:
            return False
        share = _share(axes, d, low, point[d])
        for corner in range(count):
            base = offsets[corner] * sizes[d] + low
            offsets[corner + count], weights[corner + count] = base + 1, weights[corner] * share
            offsets[corner], weights[corner] = base, weights[corner] * (1.0 - share)
        count *= 2
    return True


@compiled
def _corner(values, weights, offsets, plane, cell):
    """Value at a corner of the plane of periods, interpolated along the shared axes."""
    total = 0.0
    for corner in range(1 << SHARED):
        total += weights[corner] * values[offsets[corner] * plane + cell]
    return total


@compiled
def bias_of_tile(place_1, cells_1, place_2, cells_2, count, axes, sizes, values, memory, out):
    """Bias of ``rho`` by the map, linear between its points; NaN outside or if the two differ.

    ``memory`` is made by `new_memory`: pairs of equal properties find their corners there. What is
    found does not depend on what was asked before.
    """
    memo, point, weights, offsets, last = memory
    long, width = sizes[SHARED], sizes[SHARED + 1]
    known, low, near = last[0], last[1], last[2]
    for lane in range(count):
        i, j = cells_1[lane], cells_2[lane]
        out[lane] = np.nan
        shared, same = True, True
        for d in range(SHARED):
            shared &= abs(place_1[i, d] - place_2[j, d]) <= EQUAL
            same &= place_1[i, d] == point[d]
        if not shared:
            continue
        if not same:
            for d in range(SHARED):
                point[d] = place_1[i, d]
            for n in range(memo.size):
                memo[n] = np.nan
            known = _locate(axes, sizes, point, weights, offsets)
        if not known:
            continue
        one, two = place_1[i, SHARED], place_2[j, SHARED]
        longer, ratio = max(one, two) - place_1[i, SHARED + 1], -abs(one - two)
        low = _bracket(axes, SHARED, long, longer, max(low, 0))
        near = _bracket(axes, SHARED + 1, width, ratio, max(near, 0))
        if low < 0 or near < 0:
            continue
        cell = low * width + near
        u, v = _share(axes, SHARED, low, longer), _share(axes, SHARED + 1, near, ratio)
        for corner in (cell, cell + 1, cell + width, cell + width + 1):
            if np.isnan(memo[corner]):
                memo[corner] = _corner(values, weights, offsets, memo.size, corner)
        found = (1.0 - u) * ((1.0 - v) * memo[cell] + v * memo[cell + 1])
        out[lane] = found + u * ((1.0 - v) * memo[cell + width] + v * memo[cell + width + 1])
    last[0], last[1], last[2] = known, low, near


@compiled
def new_memory(sizes):
    """Memory of `bias_of_pair`: values at corners, of which point, its weights, and where it was."""
    plane = sizes[SHARED] * sizes[SHARED + 1]
    values, point, weights = np.empty(plane), np.empty(SHARED), np.empty(1 << SHARED)
    offsets, last = np.empty(1 << SHARED, np.int64), np.empty(3, np.int64)
    values[:], point[:], last[:] = np.nan, np.nan, 0
    return values, point, weights, offsets, last
