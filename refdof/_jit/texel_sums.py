"""Weighted sums of blended texels in vector registers, where loops over four channels do not vectorise.

Texels (T, 4) and sums (K, 4) are contiguous; places are int64 and count texels. Numbers are of the sums' type, every
operation is rounded. Without compilation the same is done by NumPy.
"""

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from refdof._jit import JIT_DISABLED, inline
from refdof._jit.texel_registers import blend_vectors, load, spread, store

__all__ = ["add_blend", "add_blend_twice"]


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


if JIT_DISABLED:
    add_blend, add_blend_twice = _add_interpreted, _twice_interpreted
else:

    @inline
    def add_blend(sums, k, weight, texels, a, b, c, d, across, down):
        """Add to row k of sums (K, 4) the bilinear blend of texels a, b above c, d, times a weight."""
        _add_blend(sums, k, (weight,), texels, a, b, c, d, across, down)

    @inline
    def add_blend_twice(sums, k, weights, texels, a, b, c, d, across, down):
        """The same to rows k and k + 1, with a weight of its own each."""
        _add_blend(sums, k, weights, texels, a, b, c, d, across, down)
