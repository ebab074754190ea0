"""Weighted sums of blended texels in vector registers, in float64, where loops over four channels do not vectorise.

Texels (T, 4) and sums (K, 4) are contiguous; places are int64 and count texels. Every operation is rounded. Without
compilation the same is done by NumPy.
"""

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from refdof._jit import JIT_DISABLED, inline
from refdof._jit.texel_registers import load, plain_lerp, spread

__all__ = ["add_blend"]


@intrinsic
def _add_blend(
    typingctx: Any, sums: Any, k: Any, weight: Any, texels: Any, a: Any, b: Any, c: Any, d: Any, across: Any, down: Any
) -> Any:
    wide = types.float64
    signature = types.void(sums, k, wide, texels, a, b, c, d, wide, wide)

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        vector = ir.VectorType(ir.DoubleType(), 4)
        base = context.make_array(texels)(context, builder, arguments[3]).data

        def texel(place: Any) -> Any:
            numbers = load(builder, base, place, 4)
            return numbers if numbers.type == vector else builder.fpext(numbers, vector)

        first, second, third, fourth = (texel(place) for place in arguments[4:8])
        weight, wx, wy = (spread(builder, arguments[n], 4) for n in (2, 8, 9))
        upper, lower = plain_lerp(builder, first, second, wx), plain_lerp(builder, third, fourth, wx)
        read = plain_lerp(builder, upper, lower, wy)
        total = context.make_array(sums)(context, builder, arguments[0]).data
        place = builder.gep(total, [builder.mul(arguments[1], ir.Constant(arguments[1].type, 4))], inbounds=True)
        place = builder.bitcast(place, vector.as_pointer())
        builder.store(builder.fadd(builder.load(place, align=8), builder.fmul(weight, read)), place, align=8)
        return context.get_dummy_value()

    return signature, generate


def _add_interpreted(
    sums: Any, k: int, weight: float, texels: Any, a: Any, b: Any, c: Any, d: Any, across: Any, down: Any
) -> None:
    first, second, third, fourth = (texels[place].astype(float) for place in (a, b, c, d))
    upper, lower = first + (second - first) * float(across), third + (fourth - third) * float(across)
    sums[k] += weight * (upper + (lower - upper) * float(down))


if JIT_DISABLED:
    add_blend = _add_interpreted
else:

    @inline
    def add_blend(sums, k, weight, texels, a, b, c, d, across, down):
        """Add to row k of sums (K, 4) float64 the bilinear blend of texels a, b above c, d, times a weight."""
        _add_blend(sums, k, weight, texels, a, b, c, d, across, down)
