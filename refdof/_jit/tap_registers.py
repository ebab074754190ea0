"""Taps of a gather in vector registers: two bilinear reads, blended by blur and weighed by what may spread.

Texels (T, 4) are a colour and a code of its blur: 0 full in front, 1/2 sharp, 1 full behind. All numbers are of the
texels' type, every operation is rounded. Two neighbouring pixels are done at once, one in each half of a register.
Without compilation the same is done by NumPy.
"""

from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from refdof._jit import JIT_DISABLED, inline
from refdof._jit.texel_registers import blend_to, blend_vectors, load, pick, plain_lerp, store

__all__ = ["add_two_taps"]


@intrinsic
def _add_two_taps(
    typingctx: Any, sharp: Any, soft: Any, strides: Any, firsts: Any, weights: Any, own: Any, sums: Any, k: Any
) -> Any:
    signature = types.void(sharp, soft, strides, firsts, weights, own, sums, k)

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        sharps, softs, target = (
            context.make_array(t)(context, builder, arguments[n]).data for t, n in ((sharp, 0), (soft, 1), (sums, 6))
        )
        place = arguments[7]

        def of_two(array: Any, which: int, row: int) -> Any:
            """Numbers k and k + 1 of a row: a vector of two."""
            view = context.make_array(array)(context, builder, arguments[which])
            at = [ir.Constant(place.type, row), place]
            pointer = cgutils.get_item_pointer2(
                context, builder, view.data, cgutils.unpack_tuple(builder, view.shape), None, "C", at
            )
            vector = ir.VectorType(pointer.type.pointee, 2)
            align = array.dtype.bitwidth // 8
            return builder.load(builder.bitcast(pointer, vector.as_pointer()), align=align)

        def read(base: Any, n: int) -> Any:
            two = of_two(firsts, 3, n)
            starts = [builder.extract_element(two, ir.Constant(ir.IntType(32), h)) for h in (0, 1)]
            stride = builder.mul(builder.extract_value(arguments[2], n), ir.Constant(place.type, 4))
            corners = []
            for line in (base, builder.gep(base, [stride], inbounds=True)):
                for side in (line, builder.gep(line, [ir.Constant(place.type, 4)], inbounds=True)):
                    at = (builder.gep(side, [start], inbounds=True) for start in starts)
                    texel = ir.VectorType(base.type.pointee, 4).as_pointer()
                    corners.append(_joined(builder, *(builder.load(builder.bitcast(t, texel), align=4) for t in at)))
            across, down = (_spread_two(builder, of_two(weights, 4, 2 * n + m)) for m in (0, 1))
            return blend_vectors(builder, corners, across, down)

        high, low = read(sharps, 0), read(softs, 1)
        value = plain_lerp(builder, high, low, _of_codes(builder, _size(builder, high)))
        centers = load(builder, sharps, arguments[5], 8)
        one = ir.Constant(value.type, [1.0] * 8)
        spreads = builder.fcmp_ordered(">=", value, centers)
        weight = _of_codes(builder, builder.select(spreads, one, _size(builder, value)))
        share = builder.fmul(weight, pick(builder, value, one, [0, 1, 2, 11, 4, 5, 6, 15]))
        store(builder, builder.fadd(load(builder, target, place, 8), share), target, place)
        return context.get_dummy_value()

    return signature, generate


def _joined(builder: Any, lower: Any, upper: Any) -> Any:
    return pick(builder, lower, upper, list(range(8)))


def _spread_two(builder: Any, pair: Any) -> Any:
    return pick(builder, pair, pair, [0] * 4 + [1] * 4)


def _of_codes(builder: Any, texels: Any) -> Any:
    """The fourth number of each of two texels in all of its lanes."""
    return pick(builder, texels, texels, [3] * 4 + [7] * 4)


def _size(builder: Any, texels: Any) -> Any:
    """|2 x - 1| of all numbers."""
    one, two = (ir.Constant(texels.type, [value] * 8) for value in (1.0, 2.0))
    signed = builder.fsub(builder.fmul(two, texels), one)
    kind = "f64" if isinstance(texels.type.element, ir.DoubleType) else "f32"
    function_type = ir.FunctionType(texels.type, [texels.type])
    function = cgutils.get_or_insert_function(builder.module, function_type, f"llvm.fabs.v8{kind}")
    return builder.call(function, [signed])


def _add_interpreted(
    sharp: Any, soft: Any, strides: Any, firsts: Any, weights: Any, own: int, sums: Any, k: int
) -> None:
    one, two, reads = sums.dtype.type(1), sums.dtype.type(2), np.empty((2, 4), sums.dtype)
    for x in (0, 1):
        for n, (texels, stride) in enumerate(zip((sharp, soft), strides, strict=True)):
            a, (across, down) = firsts[n, k + x] // 4, weights[2 * n : 2 * n + 2, k + x]
            blend_to(texels, a, a + 1, a + stride, a + stride + 1, across, down, reads, n)
        high, low = reads
        value = high + (low - high) * abs(two * high[3] - one)
        weight = one if value[3] >= sharp[own + x, 3] else abs(two * value[3] - one)
        for n in range(4):
            sums[k + x, n] += weight * value[n] if n < 3 else weight


if JIT_DISABLED:
    add_two_taps = _add_interpreted
else:

    @inline
    def add_two_taps(sharp, soft, strides, firsts, weights, own, sums, k):
        """Add taps to sums[k] and sums[k + 1], three colours and the sum of weights each.

        firsts (2, n) int64: where the numbers begin of the upper left one of four texels in `sharp` and in `soft`,
        whose rows have `strides` texels; weights (4, n): of the right and lower texels in both. Reads are blended by
        the blur of the sharp one. A tap counts in full if its code is not below that of texel `own` of `sharp`,
        `own` + 1 for the second, else by its blur.
        """
        _add_two_taps(sharp, soft, strides, firsts, weights, own, sums, k)
