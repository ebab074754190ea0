"""Texels in lanes: eight texels anywhere become eight numbers of each channel, for loops over pixels that vectorise.

Texels (T, 4) and planes are contiguous. Without compilation the same is done by NumPy.
"""

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from refdof._jit import JIT_DISABLED, inline
from refdof._jit.texel_registers import load, pick

__all__ = ["LANES", "fetch_lanes"]

LANES = 8
_LOW, _HIGH = [0, 8, 1, 9, 4, 12, 5, 13], [2, 10, 3, 11, 6, 14, 7, 15]  # channels 0, 1 and 2, 3 of two pairs of texels
_FIRST, _SECOND = [0, 1, 8, 9, 4, 5, 12, 13], [2, 3, 10, 11, 6, 7, 14, 15]  # one channel of four pairs


@intrinsic
def _fetch_lanes(typingctx: Any, texels: Any, places: Any, n: Any, planes: Any) -> Any:
    signature = types.void(texels, places, n, planes)

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        base, start = (context.make_array(t)(context, builder, arguments[k]).data for k, t in ((0, texels), (1, places)))
        target = context.make_array(planes)(context, builder, arguments[3])
        found = []
        for lane in range(LANES):
            place = builder.add(arguments[2], ir.Constant(arguments[2].type, lane))
            place = builder.load(builder.gep(start, [place], inbounds=True))
            found.append(load(builder, base, builder.sext(place, arguments[2].type), 4))
        # Texels k and k + 4 in one register, then channels side by side.
        a, b, c, d = (pick(builder, found[k], found[k + 4], list(range(LANES))) for k in range(4))
        sides = [(pick(builder, a, b, half), pick(builder, c, d, half)) for half in (_LOW, _HIGH)]
        channels = [pick(builder, *side, half) for side in sides for half in (_FIRST, _SECOND)]
        width = builder.extract_value(target.shape, 1)
        for k, channel in enumerate(channels):
            place = builder.add(builder.mul(width, ir.Constant(width.type, k)), arguments[2])
            place = builder.gep(target.data, [place], inbounds=True)
            builder.store(channel, builder.bitcast(place, channel.type.as_pointer()), align=4)
        return context.get_dummy_value()

    return signature, generate


def _fetch_interpreted(texels: Any, places: Any, n: int, planes: Any) -> None:
    planes[:4, n : n + LANES] = texels[places[n : n + LANES]].T


if JIT_DISABLED:
    fetch_lanes = _fetch_interpreted
else:

    @inline
    def fetch_lanes(texels, places, n, planes):
        """Write eight texels, at int32 `places` from number n on, to the columns of planes (4 or more, N) from n on."""
        _fetch_lanes(texels, places, n, planes)
