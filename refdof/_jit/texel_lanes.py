"""Texels in lanes: what is done with eight of them at once, at places that a loop which vectorises has found.

1. eight texels become eight numbers of each channel        `fetch_lanes`
2. eight bilinear reads are summed                          `add_reads`

Texels (T, 4), sums and planes are contiguous; places are int32 and count texels. Without compilation the same is done
by NumPy.
"""

from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from refdof._jit import JIT_DISABLED, inline
from refdof._jit.texel_registers import load, pick, plain_lerp, spread, store

__all__ = ["LANES", "add_reads", "fetch_lanes"]

LANES = 8
_LOW, _HIGH = [0, 8, 1, 9, 4, 12, 5, 13], [2, 10, 3, 11, 6, 14, 7, 15]  # channels 0, 1 and 2, 3 of two pairs of texels
_FIRST, _SECOND = [0, 1, 8, 9, 4, 5, 12, 13], [2, 3, 10, 11, 6, 7, 14, 15]  # one channel of four pairs


@intrinsic
def _fetch_lanes(typingctx: Any, texels: Any, places: Any, n: Any, planes: Any) -> Any:
    signature = types.void(texels, places, n, planes)

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        base, start = (
            context.make_array(t)(context, builder, arguments[k]).data for k, t in ((0, texels), (1, places))
        )
        target = context.make_array(planes)(context, builder, arguments[3])
        found = [load(builder, base, _lane(builder, start, arguments[2], lane), 4) for lane in range(LANES)]
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


@intrinsic
def _add_reads(
    typingctx: Any, texels: Any, upper: Any, lower: Any, across: Any, down: Any, n: Any, sums: Any, k: Any
) -> Any:
    signature = types.void(texels, upper, lower, across, down, n, sums, k)

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        kinds = signature.args
        base, above, below, right, under = (
            context.make_array(kinds[i])(context, builder, arguments[i]).data for i in range(5)
        )
        target = context.make_array(sums)(context, builder, arguments[6]).data
        # Two neighbours in one register; of their sums with and without `across`, the blend is made in the end.
        plain: Any = None
        weighed: Any = None
        for lane in range(LANES):
            top, bottom = (load(builder, base, _lane(builder, at, arguments[5], lane), 8) for at in (above, below))
            w, h = (spread(builder, _lane(builder, at, arguments[5], lane), 8) for at in (right, under))
            both = plain_lerp(builder, top, bottom, h)
            share = builder.fmul(both, w)
            plain = both if lane == 0 else builder.fadd(plain, both)
            weighed = share if lane == 0 else builder.fadd(weighed, share)
        first, second = (pick(builder, weighed, weighed, lanes) for lanes in ([0, 1, 2, 3], [4, 5, 6, 7]))
        total = builder.fadd(pick(builder, plain, plain, [0, 1, 2, 3]), builder.fsub(second, first))
        store(builder, builder.fadd(load(builder, target, arguments[7], 4), total), target, arguments[7])
        return context.get_dummy_value()

    return signature, generate


def _lane(builder: Any, start: Any, n: Any, lane: int) -> Any:
    """Number n + lane of an array; integers as wide as n."""
    value = builder.load(builder.gep(start, [builder.add(n, ir.Constant(n.type, lane))], inbounds=True))
    return builder.sext(value, n.type) if isinstance(value.type, ir.IntType) else value


def _fetch_interpreted(texels: Any, places: Any, n: int, planes: Any) -> None:
    planes[:4, n : n + LANES] = texels[places[n : n + LANES]].T


def _reads_interpreted(texels: Any, upper: Any, lower: Any, across: Any, down: Any, n: int, sums: Any, k: int) -> None:
    here = np.s_[n : n + LANES]
    first, second = (
        texels[upper[here] + beside] + (texels[lower[here] + beside] - texels[upper[here] + beside]) * down[here, None]
        for beside in (0, 1)
    )
    weight = across[here, None]
    sums[k] += first.sum(axis=0) + ((weight * second).sum(axis=0) - (weight * first).sum(axis=0))


if JIT_DISABLED:
    fetch_lanes, add_reads = _fetch_interpreted, _reads_interpreted
else:

    @inline
    def fetch_lanes(texels, places, n, planes):
        """Write eight texels, at `places` from number n on, to the columns of planes (4 or more, N) from n on."""
        _fetch_lanes(texels, places, n, planes)

    @inline
    def add_reads(texels, upper, lower, across, down, n, sums, k):
        """Add eight bilinear reads to row k of sums (K, 4): numbers n .. n + 7 of places and weights.

        upper, lower: the left one of two texels of a row and of the next. The right ones are loaded even where
        `across` is 0, so after the last texel of all there must be one more.
        """
        _add_reads(texels, upper, lower, across, down, n, sums, k)
