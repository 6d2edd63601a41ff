"""One tile of a table of pairs: the structures of its cells, their correlation, and its bias.

The covariance of a pair is that of `covariance.pair_row`, arranged for speed. ``A`` is the state matrix
of the softer structure. By the theorem of Cayley and Hamilton ``A^3 = -a2 A^2 - a1 A - a0``, so that
the 3 x 3 matrix of the system of equations, with the coefficients of the stiffer structure marked by
``'``, is

    D'(-A) = (a2' + a2) A^2 + (a1 - a1') A + (a0' + a0).

Terms that belong to one structure are computed once. For each cell some 70 multiplications and
additions and one division remain, in vector registers. The modal form needs five divisions, and fails
for a structure with a double eigenvalue.
"""

import numpy as np

from stochlin.kernels.basics.compiled import called_often, compiled

LANES = 128  # cells (lanes) of a tile, whose structures then fit the first-level cache
PARAMETERS = 21  # quantities of a structure, in the order of `tables.pair_parameters`
BACK, STIFFNESS, KICK, STD = 17, 18, 19, 20  # numbers of some of these
SHARED = 4  # axes of the map of the bias for properties that both structures share
ROUNDING = 1e-9  # distance beyond the end of an axis at which a point still counts as inside
EQUAL = 1e-6  # relative difference of properties that counts as rounding error


@compiled
def cells_of_tile(begin, count, shape, strides, cells):
    """Write the numbers of the first (or second) structures in a tile to ``cells`` (LANES,).

    The tile has the ``count`` cells from ``begin``; further lanes repeat the last cell.
    """
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
    """Copy the parameters of the structures of a tile into ``tile``, one parameter after the other.

    ``loaded`` are the numbers of the structures that are in the tile already. Along a row of the table
    one structure does not change, and is not copied again.
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
    """Exchange the two structures in lanes where the second one is stiffer."""
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
    """Write ``rho`` of all lanes to ``out``, from the tiles of the stiffer and the softer structures."""
    for n in range(LANES):
        out[n] = correlation(stiff, soft, n, LANES)


@compiled
def rho_of_tile(parameters_1, parameters_2, cells_1, cells_2, a, b, loaded, out):
    """Write ``rho`` of a tile to ``out``.

    The stiffer structure of each pair is taken first, for accuracy as in `covariance.pair_covariance`.
    ``a`` and ``b`` are working space for the two structures, and ``loaded`` are the numbers of those
    that are in it.
    """
    _load(parameters_1, cells_1, a, loaded[0])
    _load(parameters_2, cells_2, b, loaded[1])
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
    """Number of the interval with ``x`` on axis ``d``, searched from ``low``; -1 outside the axis."""
    if not axes[d, 0] - ROUNDING <= x <= axes[d, size - 1] + ROUNDING:
        return -1
    while low > 0 and x < axes[d, low]:
        low -= 1
    while low < size - 2 and x >= axes[d, low + 1]:
        low += 1
    return low


@compiled
def _share(axes, d, low, x):
    """Position of ``x`` in interval ``low`` of axis ``d``, from 0 to 1."""
    x = min(max(x, axes[d, low]), axes[d, low + 1])
    return (x - axes[d, low]) / (axes[d, low + 1] - axes[d, low])


@compiled
def _locate(axes, sizes, point, weights, offsets):
    """Find the weights and offsets of the corners around a point on the shared axes.

    Returns False if the point is outside.
    """
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
    """Value of the map at point ``cell`` of the two period axes, interpolated along the shared axes."""
    total = 0.0
    for corner in range(1 << SHARED):
        total += weights[corner] * values[offsets[corner] * plane + cell]
    return total


@compiled
def bias_of_tile(place_1, cells_1, place_2, cells_2, count, axes, sizes, values, memory, out):
    """Write the bias of ``rho`` in a tile to ``out``, by linear interpolation in the map.

    It is NaN outside the map and for structures whose shared properties differ. ``memory``, from
    `new_memory`, has interpolated values for later pairs with the same properties; the results do not
    depend on earlier calls.
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
        period_1, period_2 = place_1[i, SHARED], place_2[j, SHARED]
        longer, ratio = max(period_1, period_2) - place_1[i, SHARED + 1], -abs(period_1 - period_2)
        low = _bracket(axes, SHARED, long, longer, max(low, 0))
        near = _bracket(axes, SHARED + 1, width, ratio, max(near, 0))
        if low < 0 or near < 0:
            continue
        cell = low * width + near
        u, v = _share(axes, SHARED, low, longer), _share(axes, SHARED + 1, near, ratio)
        for corner in (cell, cell + 1, cell + width, cell + width + 1):
            if np.isnan(memo[corner]):
                memo[corner] = _corner(values, weights, offsets, memo.size, corner)
        value = (1.0 - u) * ((1.0 - v) * memo[cell] + v * memo[cell + 1])
        out[lane] = value + u * ((1.0 - v) * memo[cell + width] + v * memo[cell + width + 1])
    last[0], last[1], last[2] = known, low, near


@compiled
def new_memory(sizes):
    """Working space of `bias_of_tile`, which is kept from tile to tile.

    It has values of the map interpolated along the shared axes, the point for which they hold, its
    weights and offsets, and whether it is inside, with the intervals that were found last.
    """
    plane = sizes[SHARED] * sizes[SHARED + 1]
    values, point, weights = np.empty(plane), np.empty(SHARED), np.empty(1 << SHARED)
    offsets, last = np.empty(1 << SHARED, np.int64), np.empty(3, np.int64)
    values[:], point[:], last[:] = np.nan, np.nan, 0
    return values, point, weights, offsets, last
