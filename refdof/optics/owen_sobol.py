"""Owen-scrambled Sobol' points, one independent scramble per pixel, in an order that keeps rays together.

M = 2^m points of the first two dimensions lie one in each cell of a 2^p x 2^q grid of the unit square (p + q = m), and
scrambling permutes cells. So the points of every pixel can be visited cell by cell: the i-th points of neighbouring
pixels then pass through the same small part of the lens, and their rays stay coherent, although each pixel's
pattern is an independent scramble of the full net.

Numbers are kept with their bits reversed, where scrambling is a hash whose low bits depend on low bits only.

A scramble is chosen by a 32-bit seed. Seeds of different axes, replicates and pixels come from a 64-bit generator [4]:
a 32-bit hash of neighbouring numbers leaves them related (cells of an 8 x 8 grid over two axes up to 37 % off), which
would bias every picture. `tests/optics/test_owen_sobol.py` counts cells for both.

References
----------
.. [1] Owen (1995), Randomly Permuted (t,m,s)-Nets and (t,s)-Sequences.
.. [2] Laine & Karras (2011), Stratified Sampling for Stochastic Transparency (the hash).
.. [3] Burley (2020), Practical Hash-based Owen Scrambling, JCGT 9(4).
.. [4] Steele, Lea & Flood (2014), Fast Splittable Pseudorandom Number Generators (SplitMix64), OOPSLA.
.. [5] Joe & Kuo (2003), Remark on Algorithm 659: Implementing Sobol's Quasirandom Sequence Generator, TOMS 29(1).
.. [6] Joe & Kuo (2008), Constructing Sobol Sequences with Better Two-Dimensional Projections, SISC 30(5).
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from refdof._check import Index
from refdof._jit import borrow, inline

__all__ = [
    "MAX_LOG2",
    "Block",
    "axis_seed",
    "block_of",
    "borrow_block",
    "mix64",
    "reverse_bits",
    "scramble",
    "scramble_state",
]

MAX_LOG2 = 20  # points per scramble: 2^20
# [6], new-joe-kuo-6: degree, inner coefficients and first numbers of lens x, lens y, pixel x, pixel y.
_POLYNOMIALS = ((0, 0, ()), (1, 0, (1,)), (2, 1, (1, 3)), (3, 1, (1, 3, 1)))
_STEP = np.uint64(0x9E3779B97F4A7C15)  # [4]: 2^64 over the golden ratio


class Block(NamedTuple):
    """Points first .. first + 2^m - 1 of the sequence, with first a multiple of 2^m.

    `reversed_points` (4, 2^m) uint32; `point_of_cell` (2^m,) uint32: which point lies in cell
    (row << column_bits) + column before scrambling, columns and rows with their bits reversed; `cells` (2^m, 2)
    uint32: column and row of every cell, along a Z-curve over the square.
    """

    reversed_points: Index
    point_of_cell: Index
    cells: Index
    column_bits: int
    row_bits: int


@lru_cache(maxsize=8)
def block_of(first: int, log2_count: int) -> Block:
    """The block of 2^log2_count points that starts at `first`."""
    count = 1 << log2_count
    backwards = _reverse_numpy(_sobol(first, count))
    column_bits = (log2_count + 1) // 2
    row_bits = log2_count - column_bits
    column = backwards[0] & np.uint32((1 << column_bits) - 1)
    row = backwards[1] & np.uint32((1 << row_bits) - 1)
    point_of_cell = np.zeros(count, dtype=np.uint32)
    point_of_cell[(row << np.uint32(column_bits)) + column] = np.arange(count, dtype=np.uint32)
    return Block(backwards, point_of_cell, _z_curve(column_bits, row_bits), column_bits, row_bits)


def _z_curve(column_bits: int, row_bits: int) -> Index:
    """Columns and rows (2^m, 2), bits reversed, such that 4^k consecutive cells form a square."""
    step = np.arange(1 << (column_bits + row_bits), dtype=np.uint32)
    cells = np.zeros((len(step), 2), dtype=np.uint32)
    for axis, bits in ((0, column_bits), (1, row_bits)):
        for k in range(bits):
            bit = (step >> np.uint32(2 * k + axis)) & np.uint32(1)
            cells[:, axis] |= bit << np.uint32(bits - 1 - k)
    return cells


def _sobol(first: int, count: int) -> Index:
    """Points first .. first + count - 1 of the sequence (4, count) uint32, in the order of a Gray code: [5], [6]."""
    index = np.arange(first, first + count, dtype=np.uint32)
    gray = index ^ (index >> np.uint32(1))
    points = np.zeros((len(_POLYNOMIALS), count), dtype=np.uint32)
    for axis, polynomial in enumerate(_POLYNOMIALS):
        for bit, direction in enumerate(_directions(*polynomial)[: (first + count).bit_length()]):
            points[axis] ^= ((gray >> np.uint32(bit)) & np.uint32(1)) * np.uint32(direction)
    return points


def _directions(degree: int, inner: int, start: tuple[int, ...]) -> list[int]:
    """The 32 direction numbers of an axis: [5], Section 2; as 32-bit fractions."""
    m = list(start)
    for k in range(degree, 32):
        number = m[k - degree] ^ (m[k - degree] << degree) if degree else 1
        for j in range(1, degree):
            number ^= ((inner >> (degree - 1 - j)) & 1) * (m[k - j] << j)
        m.append(number)
    return [number << (31 - k) for k, number in enumerate(m)]


def _reverse_numpy(x: Index) -> Index:
    for shift, mask in ((1, 0x55555555), (2, 0x33333333), (4, 0x0F0F0F0F), (8, 0x00FF00FF), (16, 0x0000FFFF)):
        x = ((x >> np.uint32(shift)) & np.uint32(mask)) | ((x & np.uint32(mask)) << np.uint32(shift))
    return x


@inline
def borrow_block(b):
    """`Block` whose arrays are borrowed, for a tile kernel's inner loops."""
    return Block(borrow(b.reversed_points), borrow(b.point_of_cell), borrow(b.cells), b.column_bits, b.row_bits)


@inline
def reverse_bits(x):
    """The 32 bits of x in reverse order."""
    x = np.uint32(((x >> np.uint32(1)) & np.uint32(0x55555555)) | ((x & np.uint32(0x55555555)) << np.uint32(1)))
    x = np.uint32(((x >> np.uint32(2)) & np.uint32(0x33333333)) | ((x & np.uint32(0x33333333)) << np.uint32(2)))
    x = np.uint32(((x >> np.uint32(4)) & np.uint32(0x0F0F0F0F)) | ((x & np.uint32(0x0F0F0F0F)) << np.uint32(4)))
    x = np.uint32(((x >> np.uint32(8)) & np.uint32(0x00FF00FF)) | ((x & np.uint32(0x00FF00FF)) << np.uint32(8)))
    return np.uint32((x >> np.uint32(16)) | (x << np.uint32(16)))


@inline
def scramble(x, seed):
    """Owen scramble of a bit-reversed number, [2] with the constants of [3]'s follow-ups: a bit-reversed number."""
    x = np.uint32(x ^ np.uint32(x * np.uint32(0x3D20ADEA)))
    x = np.uint32(x + seed)
    x = np.uint32(x * np.uint32((seed >> np.uint32(16)) | np.uint32(1)))
    x = np.uint32(x ^ np.uint32(x * np.uint32(0x05526C56)))
    return np.uint32(x ^ np.uint32(x * np.uint32(0x53A22864)))


@inline
def scramble_state(seed, replicate, pixel):
    """The 64-bit state from which the scrambles of one pixel in one replicate are drawn; pixel >= 0."""
    state = mix64(np.uint64(seed) + np.uint64(replicate + 1) * _STEP)
    return mix64(state + np.uint64(pixel + 1) * _STEP)


@inline
def axis_seed(state, axis):
    """The seed of `scramble` for one axis: the upper half of the next output of [4]."""
    return np.uint32(mix64(state + np.uint64(axis + 1) * _STEP) >> np.uint64(32))


@inline
def mix64(x):
    """The 64-bit finaliser of [4]: every output bit depends evenly on every input bit."""
    x = np.uint64((x ^ (x >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9))
    x = np.uint64((x ^ (x >> np.uint64(27))) * np.uint64(0x94D049BB133111EB))
    return np.uint64(x ^ (x >> np.uint64(31)))
