"""Taps of a gather in vector registers: two bilinear reads, blended by blur and weighed by what may spread.

Texels (T, 4) are a colour and a code of its blur: 0 full in front, 1/2 sharp, 1 full behind. All numbers are of the
texels' type, every operation is rounded. Without compilation the same is done by NumPy.
"""

from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from refdof._jit import JIT_DISABLED, inline
from refdof._jit.texel_registers import blend_to, blend_vectors, load, pick, plain_lerp, spread, store

__all__ = ["add_tap"]

_CODE = [3] * 4  # lanes


@intrinsic
def _add_tap(
    typingctx: Any, sharp: Any, near: Any, near_weights: Any, soft: Any, far: Any, far_weights: Any, center: Any,
    sums: Any, k: Any,
) -> Any:  # fmt: skip
    signature = types.void(sharp, near, near_weights, soft, far, far_weights, sharp.dtype, sums, k)

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        bases = [context.make_array(t)(context, builder, arguments[n]).data for t, n in ((sharp, 0), (soft, 3))]
        places = zip(*(cgutils.unpack_tuple(builder, arguments[n], 4) for n in (1, 4)), strict=True)
        shares = zip(*(cgutils.unpack_tuple(builder, arguments[n], 2) for n in (2, 5)), strict=True)
        # Both reads at once: the sharp one's channels are the lower lanes.
        corners = [_joined(builder, load(builder, bases[0], p, 4), load(builder, bases[1], q, 4)) for p, q in places]
        across, down = (_joined(builder, spread(builder, p, 4), spread(builder, q, 4)) for p, q in shares)
        reads = blend_vectors(builder, corners, across, down)
        high, low = pick(builder, reads, reads, [0, 1, 2, 3]), pick(builder, reads, reads, [4, 5, 6, 7])
        value = plain_lerp(builder, high, low, _blur(builder, high))
        own = spread(builder, arguments[6], 4)
        one = ir.Constant(value.type, [1.0] * 4)
        spreads = builder.fcmp_ordered(">=", pick(builder, value, value, _CODE), own)
        weight = builder.select(spreads, one, _blur(builder, value))
        target = context.make_array(sums)(context, builder, arguments[7]).data
        share = builder.fmul(weight, pick(builder, value, one, [0, 1, 2, 7]))
        store(builder, builder.fadd(load(builder, target, arguments[8], 4), share), target, arguments[8])
        return context.get_dummy_value()

    return signature, generate


def _joined(builder: Any, lower: Any, upper: Any) -> Any:
    return pick(builder, lower, upper, list(range(8)))


def _blur(builder: Any, texel: Any) -> Any:
    """|2 code - 1| in all lanes."""
    one, two = (ir.Constant(texel.type, [value] * 4) for value in (1.0, 2.0))
    signed = builder.fsub(builder.fmul(two, pick(builder, texel, texel, _CODE)), one)
    kind = "f64" if isinstance(texel.type.element, ir.DoubleType) else "f32"
    function_type = ir.FunctionType(texel.type, [texel.type])
    function = cgutils.get_or_insert_function(builder.module, function_type, f"llvm.fabs.v4{kind}")
    return builder.call(function, [signed])


def _add_interpreted(
    sharp: Any, near: Any, near_weights: Any, soft: Any, far: Any, far_weights: Any, center: Any, sums: Any, k: int
) -> None:
    reads = np.empty((2, 4), sums.dtype)
    for n, (texels, (a, b, c, d), (across, down)) in enumerate(((sharp, near, near_weights), (soft, far, far_weights))):
        blend_to(texels, a, b, c, d, across, down, reads, n)
    high, low = reads
    one, two = sums.dtype.type(1), sums.dtype.type(2)
    value = high + (low - high) * abs(two * high[3] - one)
    weight = one if value[3] >= center else abs(two * value[3] - one)
    for n in range(4):
        sums[k, n] += weight * value[n] if n < 3 else weight


if JIT_DISABLED:
    add_tap = _add_interpreted
else:

    @inline
    def add_tap(sharp, near, near_weights, soft, far, far_weights, center, sums, k):
        """Add a tap to sums[k], three colours and the sum of weights.

        near, far: four texels of `sharp` and of `soft`, and two weights, as `blend_to` takes them; they are blended
        by the blur of the sharp one. The tap counts in full if its code is not below `center`, else by its blur.
        """
        _add_tap(sharp, near, near_weights, soft, far, far_weights, center, sums, k)
