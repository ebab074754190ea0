"""Weighted sums of blended texels in vector registers, where loops over channels do not vectorise.

1. two texels above two, weighed by numbers        `add_blend`, `add_blend_twice`
2. two pairs of a line, weighed channel by channel `add_pairs`, `add_pairs_of_four`

Texels (T, C) and sums (K, C) are contiguous, four channels or eight; places are int64 and count texels. Numbers are of
the sums' type, every operation is rounded. Without compilation the same is done by NumPy.
"""

from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from refdof._jit import JIT_DISABLED, inline
from refdof._jit.texel_registers import blend_vectors, load, pick, plain_lerp, spread, store

__all__ = ["WIDE", "add_blend", "add_blend_twice", "add_pairs", "add_pairs_of_four"]

WIDE = 8  # channels of `add_pairs`


@intrinsic
def _add_blend(
    typingctx: Any, sums: Any, k: Any, weights: Any, texels: Any, a: Any, b: Any, c: Any, d: Any, across: Any, down: Any
) -> Any:
    wide = sums.dtype
    signature = types.void(sums, k, types.UniTuple(wide, len(weights)), texels, a, b, c, d, wide, wide)

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        vector = ir.VectorType(context.get_value_type(wide), 4)
        base = context.make_array(texels)(context, builder, arguments[3]).data

        def texel(place: Any) -> Any:
            numbers = load(builder, base, place, 4)
            return numbers if numbers.type == vector else builder.fpext(numbers, vector)

        wx, wy = (spread(builder, arguments[n], 4) for n in (8, 9))
        read = blend_vectors(builder, [texel(place) for place in arguments[4:8]], wx, wy)
        target = context.make_array(sums)(context, builder, arguments[0]).data
        for n in range(len(weights)):
            weight = spread(builder, builder.extract_value(arguments[2], n), 4)
            row = builder.add(arguments[1], ir.Constant(arguments[1].type, n))
            before = load(builder, target, row, 4)
            store(builder, builder.fadd(before, builder.fmul(weight, read)), target, row)
        return context.get_dummy_value()

    return signature, generate


@intrinsic
def _add_pairs(
    typingctx: Any, sums: Any, k: Any, weights: Any, m: Any, texels: Any, four: Any, a: Any, b: Any, c: Any, d: Any,
    s: Any, t: Any,
) -> Any:  # fmt: skip
    wide, lanes = sums.dtype, WIDE if isinstance(four, types.NoneType) else 4
    signature = types.void(sums, k, weights, m, texels, four, a, b, c, d, wide, wide)

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        def texel(n: int, place: Any, count: int = WIDE) -> Any:
            base = context.make_array(signature.args[n])(context, builder, arguments[n]).data
            at = builder.mul(place, ir.Constant(place.type, count // 4))  # places of `load` count fours
            return base, at, load(builder, base, at, count)

        reads = []
        for first, second, share in ((6, 7, 10), (8, 9, 11)):
            a, b = (texel(4, arguments[n], lanes)[2] for n in (first, second))
            reads.append(plain_lerp(builder, a, b, spread(builder, arguments[share], lanes)))
        read = builder.fadd(*reads)
        if lanes < WIDE:
            read = pick(builder, read, read, [0, 1, 2, 3] * 2)
        base, at, before = texel(0, arguments[1])
        weight = texel(2, arguments[3])[2]
        store(builder, builder.fadd(before, builder.fmul(weight, read)), base, at)
        return context.get_dummy_value()

    return signature, generate


def _add_interpreted(
    sums: Any, k: int, weight: float, texels: Any, a: Any, b: Any, c: Any, d: Any, across: Any, down: Any
) -> None:
    _twice_interpreted(sums, k, (weight,), texels, a, b, c, d, across, down)


def _twice_interpreted(
    sums: Any, k: int, weights: tuple[float, ...], texels: Any, a: Any, b: Any, c: Any, d: Any, across: Any, down: Any
) -> None:
    own = sums.dtype.type
    first, second, third, fourth = (texels[place].astype(own) for place in (a, b, c, d))
    upper, lower = first + (second - first) * own(across), third + (fourth - third) * own(across)
    for n, weight in enumerate(weights):
        sums[k + n] += own(weight) * (upper + (lower - upper) * own(down))


def _pairs_interpreted(
    sums: Any, k: int, weights: Any, m: int, texels: Any, a: int, b: int, c: int, d: int, s: Any, t: Any
) -> None:
    first, second = texels[a] + (texels[b] - texels[a]) * s, texels[c] + (texels[d] - texels[c]) * t
    sums[k] += weights[m] * np.resize(first + second, WIDE)


if JIT_DISABLED:
    add_blend, add_blend_twice = _add_interpreted, _twice_interpreted
    add_pairs = add_pairs_of_four = _pairs_interpreted
else:

    @inline
    def add_blend(sums, k, weight, texels, a, b, c, d, across, down):
        """Add to row k of sums (K, 4) the bilinear blend of texels a, b above c, d, times a weight."""
        _add_blend(sums, k, (weight,), texels, a, b, c, d, across, down)

    @inline
    def add_blend_twice(sums, k, weights, texels, a, b, c, d, across, down):
        """The same to rows k and k + 1, with a weight of its own each."""
        _add_blend(sums, k, weights, texels, a, b, c, d, across, down)

    @inline
    def add_pairs(sums, k, weights, m, texels, a, b, c, d, s, t):
        """Add to row k of sums (K, 8) texel a blended with b by s, and c with d by t, times row m of weights (M, 8)."""
        _add_pairs(sums, k, weights, m, texels, None, a, b, c, d, s, t)

    @inline
    def add_pairs_of_four(sums, k, weights, m, texels, a, b, c, d, s, t):
        """The same with texels of four channels, which are repeated."""
        _add_pairs(sums, k, weights, m, texels, True, a, b, c, d, s, t)
