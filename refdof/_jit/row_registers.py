"""Rows of texels halved and stretched in vector registers, where loops over four channels do not vectorise.

1. every second of eight texels, and the others     `_every_second`
2. blend neighbours                                 `blend_along`
3. blends and means of 2 x 2 texels                 `blend_squares`, `mean_squares`
4. blend any two, of a row of texels (W, 4)         `blend_pair`

Other rows are flat, (4 W), and contiguous; places are int64 and count texels. Every operation is rounded. Without
compilation the same is done by NumPy.
"""

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from refdof._jit import JIT_DISABLED, inline
from refdof._jit.texel_registers import load, pick, plain_lerp, spread, store

__all__ = ["blend_along", "blend_pair", "blend_squares", "mean_squares"]

_EVEN = [8 * (k // 4) + k % 4 for k in range(16)]  # numbers of every second of eight texels
_ODD = [k + 4 for k in _EVEN]


@intrinsic
def _blend_along(typingctx: Any, row: Any, place: Any, even: Any, k: Any, odd: Any, m: Any) -> Any:
    signature = types.void(row, place, even, k, odd, m)

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        source, first, second = _bases(context, builder, signature, arguments, (0, 2, 4))
        left, middle = _every_second(builder, source, arguments[1])
        right, _ = _every_second(builder, source, builder.add(arguments[1], ir.Constant(arguments[1].type, 2)))
        store(builder, _midway(builder, left, middle), first, arguments[3])
        store(builder, _midway(builder, middle, right), second, arguments[5])
        return context.get_dummy_value()

    return signature, generate


@intrinsic
def _blend_squares(typingctx: Any, upper: Any, lower: Any, place: Any, out: Any, k: Any) -> Any:
    signature = types.void(upper, lower, place, out, k)

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        blend, target = _combined(context, builder, signature, arguments, _midway)
        store(builder, blend, target, arguments[4])
        return context.get_dummy_value()

    return signature, generate


@intrinsic
def _mean_squares(typingctx: Any, upper: Any, lower: Any, place: Any, out: Any, k: Any) -> Any:
    signature = types.void(upper, lower, place, out, k)

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        total, target = _combined(context, builder, signature, arguments, ir.IRBuilder.fadd)
        store(builder, builder.fmul(total, ir.Constant(total.type, [0.25] * 16)), target, arguments[4])
        return context.get_dummy_value()

    return signature, generate


@intrinsic
def _blend_pair(typingctx: Any, texels: Any, a: Any, b: Any, share: Any, out: Any, k: Any) -> Any:
    signature = types.void(texels, a, b, texels.dtype, out, k)

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        base, target = (context.make_array(t)(context, builder, arguments[n]).data for t, n in ((texels, 0), (out, 4)))
        first, second = (load(builder, base, place, 4) for place in arguments[1:3])
        store(builder, plain_lerp(builder, first, second, spread(builder, arguments[3], 4)), target, arguments[5])
        return context.get_dummy_value()

    return signature, generate


def _combined(context: Any, builder: Any, signature: Any, arguments: Any, combine: Any) -> tuple[Any, Any]:
    """Neighbours combined in either row, and the two results combined; and where the output begins."""
    *rows, target = _bases(context, builder, signature, arguments, (0, 1, 3))
    above, below = (combine(builder, *_every_second(builder, row, arguments[2])) for row in rows)
    return combine(builder, above, below), target


def _bases(context: Any, builder: Any, signature: Any, arguments: Any, which: tuple[int, ...]) -> list[Any]:
    """Where the numbers of some arguments begin."""
    return [context.make_array(signature.args[n])(context, builder, arguments[n]).data for n in which]


def _every_second(builder: Any, base: Any, place: Any) -> tuple[Any, Any]:
    """Eight texels from `place` on: the even ones and the odd ones, sixteen numbers each."""
    first, last = (load(builder, base, builder.add(place, ir.Constant(place.type, k)), 16) for k in (0, 4))
    return pick(builder, first, last, _EVEN), pick(builder, first, last, _ODD)


def _midway(builder: Any, a: Any, b: Any) -> Any:
    return plain_lerp(builder, a, b, ir.Constant(a.type, [0.5] * a.type.count))


def _pair_interpreted(texels: Any, a: int, b: int, share: Any, out: Any, k: int) -> None:
    out[k] = texels[a] + (texels[b] - texels[a]) * share


def _along_interpreted(row: Any, place: int, even: Any, k: int, odd: Any, m: int) -> None:
    left, middle, right = (row[4 * (place + n) :][:32].reshape(-1, 8)[:, :4].ravel() for n in range(3))
    even[4 * k : 4 * k + 16] = left + (middle - left) * row.dtype.type(0.5)
    odd[4 * m : 4 * m + 16] = middle + (right - middle) * row.dtype.type(0.5)


def _squares_interpreted(upper: Any, lower: Any, place: int, out: Any, k: int) -> None:
    half, rows = out.dtype.type(0.5), (row[4 * place : 4 * place + 32].reshape(4, 8) for row in (upper, lower))
    above, below = (row[:, :4] + (row[:, 4:] - row[:, :4]) * half for row in rows)
    out[4 * k : 4 * k + 16] = (above + (below - above) * half).ravel()


def _mean_interpreted(upper: Any, lower: Any, place: int, out: Any, k: int) -> None:
    above, below = (row[4 * place : 4 * place + 32].reshape(4, 8) for row in (upper, lower))
    total = (above[:, :4] + above[:, 4:]) + (below[:, :4] + below[:, 4:])
    out[4 * k : 4 * k + 16] = (total * out.dtype.type(0.25)).ravel()


if JIT_DISABLED:
    blend_along, blend_pair = _along_interpreted, _pair_interpreted
    blend_squares, mean_squares = _squares_interpreted, _mean_interpreted
else:

    @inline
    def blend_along(row, place, even, k, odd, m):
        """Of ten texels from `place` on, midway between 0, 1 .. 6, 7: even from k on; 1, 2 .. 7, 8: odd from m on."""
        _blend_along(row, place, even, k, odd, m)

    @inline
    def blend_squares(upper, lower, place, out, k):
        """Of eight texels from `place` on, midway between 2 x 2, first along the rows: four of out from k on."""
        _blend_squares(upper, lower, place, out, k)

    @inline
    def mean_squares(upper, lower, place, out, k):
        """Of eight texels from `place` on, means of 2 x 2, the rows' sums added: four of out from k on."""
        _mean_squares(upper, lower, place, out, k)

    @inline
    def blend_pair(texels, a, b, share, out, k):
        """Write texel a blended with b to texel k of out, every operation rounded."""
        _blend_pair(texels, a, b, share, out, k)
