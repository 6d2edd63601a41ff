"""Normal random numbers for many motions at once, each with a generator of its own.

The generator xoshiro256+ (Blackman and Vigna 2021) gives 64 bits for each motion (lane) and step.
The sum of their four 16-bit fields is nearly normal; an odd polynomial of it has the moments of the
normal distribution up to the ninth, those of odd order by symmetry. There is no logarithm and no
rejection, so that the loop over lanes runs in vector registers. This is sufficient for steps of
white noise: a weak scheme of second order requires five moments, and the response is a sum over
many steps. The largest number is 5.04; the error of the distribution function is at most 9e-4.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from stochlin.kernels.basics.arrays import Array, zeros_on_a_line
from stochlin.kernels.basics.compiled import entry

State = npt.NDArray[np.uint64]

# Coefficients of P in x P(x^2), where x is the sum of the fields less its mean, over its standard
# deviation. The moments of orders 2, 4, 6, 8 of x P(x^2) are 1, 3, 15, 105.
POLYNOMIAL = (
    0.9554664534582995,
    0.021272612064048006,
    -0.0034087076598092536,
    0.00042516035818070537,
)
_C0, _C1, _C2, _C3 = POLYNOMIAL
_MIDDLE = 2.0 * 65535.0
_INVERSE_STD = 1.0 / np.sqrt((2.0**32 - 1) / 3.0)
_TWO_FIELDS = np.uint64(0x0000FFFF0000FFFF)  # two of the four fields
_SUM = np.uint64(0x3FFFF)
_S16, _S17, _S19, _S32, _S45 = (np.uint64(n) for n in (16, 17, 19, 32, 45))
# The bits of the number 2^52, whose last bit counts 1. Put into its last bits, a smaller whole
# number is added to it. This converts in vector registers, for which most processors have no
# instruction.
_LARGE = np.uint64(0x4330000000000000)
_LARGE_MIDDLE = 2.0**52 + _MIDDLE


def generator_state(seed: int, stream: int, lanes: int, *within: int) -> State:
    """Initial state (4, lanes) of the generators of a stream, or of a stream ``within`` it.

    All streams of a seed are independent.
    """
    sequence = np.random.SeedSequence(seed, spawn_key=(stream, *within))
    state: State = zeros_on_a_line(4, lanes).view(np.uint64)
    state[:] = sequence.generate_state(state.size, np.uint64).reshape(state.shape)
    return state


def fill_normal(state: State, out: Array) -> None:
    """Fill ``out`` (steps, lanes) with independent normal numbers of mean 0 and variance 1."""
    _fill_normal(state, out.view(np.uint64), out)


@entry
def _fill_normal(state, words, out):
    """`fill_normal`, where ``words`` is the memory of ``out``.

    It holds whole numbers first, then the result. With one loop for both, this takes half as long
    again.
    """
    s0, s1, s2, s3 = state[0], state[1], state[2], state[3]
    for step in range(out.shape[0]):
        for lane in range(out.shape[1]):
            a, b, c, d = s0[lane], s1[lane], s2[lane], s3[lane]
            bits = a + d
            shifted = b << _S17
            c ^= a
            d ^= b
            s0[lane], s1[lane] = a ^ d, b ^ c
            s2[lane], s3[lane] = c ^ shifted, (d << _S45) | (d >> _S19)
            pairs = (bits & _TWO_FIELDS) + ((bits >> _S16) & _TWO_FIELDS)
            words[step, lane] = ((pairs + (pairs >> _S32)) & _SUM) | _LARGE
        for lane in range(out.shape[1]):
            x = (out[step, lane] - _LARGE_MIDDLE) * _INVERSE_STD
            q = x * x
            out[step, lane] = x * (_C0 + q * (_C1 + q * (_C2 + q * _C3)))
