"""Reads of pictures in vector registers, where loops over four channels do not vectorise.

1. weigh a few texels               `weigh_texels`
2. blend four texels                `blend_to`, `blend_over`
3. read a circle of nine points     `read_circle`
4. share a texel out                `add_share`, `lay_share`

Texels (T, 4) are contiguous, so two neighbours of a row are one load of eight numbers. All numbers are of the texels'
type, indices are int64 and count texels. Without compilation the same sums are done by NumPy.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from refdof._jit import JIT_DISABLED, inline

__all__ = [
    "INWARD", "add_share", "blend_four", "blend_over", "blend_to", "blend_vectors", "lay_share", "load", "pick",
    "plain_lerp", "read_circle", "spread", "store", "weigh_texels",
]  # fmt: skip

INWARD = float(np.sqrt(0.5))
_OFFSETS = (0.0, 1.0, -1.0, INWARD, -INWARD)  # of columns and rows
_INDEX = ir.IntType(32)


def spread(builder: Any, value: Any, lanes: int) -> Any:
    """A number in all lanes."""
    empty = ir.Constant(ir.VectorType(value.type, lanes), ir.Undefined)
    one = builder.insert_element(empty, value, ir.Constant(_INDEX, 0))
    return builder.shuffle_vector(one, empty, ir.Constant(ir.VectorType(_INDEX, lanes), [0] * lanes))


def pick(builder: Any, first: Any, second: Any, lanes: list[int]) -> Any:
    """A vector of lanes of two others, the second's counted on from the first's."""
    return builder.shuffle_vector(first, second, ir.Constant(ir.VectorType(_INDEX, len(lanes)), lanes))


def load(builder: Any, base: Any, place: Any, lanes: int) -> Any:
    """`lanes` numbers from texel `place` on."""
    start = builder.gep(base, [builder.mul(place, ir.Constant(place.type, 4))], inbounds=True)
    vector = ir.VectorType(base.type.pointee, lanes)
    return builder.load(builder.bitcast(start, vector.as_pointer()), align=4)


def store(builder: Any, vector: Any, base: Any, place: Any) -> None:
    """Write a vector from texel `place` on."""
    start = builder.gep(base, [builder.mul(place, ir.Constant(place.type, 4))], inbounds=True)
    builder.store(vector, builder.bitcast(start, vector.type.as_pointer()), align=4)


def plain_lerp(builder: Any, a: Any, b: Any, w: Any) -> Any:
    """As `_lerp`, with every operation rounded."""
    return builder.fadd(a, builder.fmul(builder.fsub(b, a), w))


def _lerp(builder: Any, a: Any, b: Any, w: Any) -> Any:
    return _add_product(builder, builder.fsub(b, a), w, a)


def _add_product(builder: Any, a: Any, b: Any, c: Any) -> Any:
    """a b + c, in one rounding where the processor has it."""
    kind = "f64" if isinstance(a.type.element, ir.DoubleType) else "f32"
    name, function_type = f"llvm.fmuladd.v{a.type.count}{kind}", ir.FunctionType(a.type, [a.type] * 3)
    return builder.call(cgutils.get_or_insert_function(builder.module, function_type, name), [a, b, c])


def _around(builder: Any, place: Any, size: Any) -> tuple[Any, Any]:
    """First of two texels around `place` [texels from the corner], at most size - 2, and the second's weight."""
    lanes, kind = place.type.count, place.type.element
    zero, one = ir.Constant(_INDEX, 0), ir.Constant(_INDEX, 1)
    small = builder.trunc(size, _INDEX)
    largest = spread(builder, builder.sitofp(builder.sub(small, one), kind), lanes)
    last = builder.sub(small, ir.Constant(_INDEX, 2))
    last = spread(builder, builder.select(builder.icmp_signed("<", last, zero), zero, last), lanes)
    centred = builder.fsub(place, ir.Constant(place.type, [0.5] * lanes))
    border = ir.Constant(place.type, [0.0] * lanes)
    centred = builder.select(builder.fcmp_ordered("<", centred, border), border, centred)
    centred = builder.select(builder.fcmp_ordered("<", centred, largest), centred, largest)
    first = builder.fptosi(centred, ir.VectorType(_INDEX, lanes))
    first = builder.select(builder.icmp_signed("<", first, last), first, last)
    return first, builder.fsub(centred, builder.sitofp(first, place.type))


@intrinsic
def _read_circle(
    typingctx: Any, texels: Any, start: Any, width: Any, height: Any, u: Any, v: Any, a: Any, b: Any, shares: Any
) -> Any:
    kind = texels.dtype
    signature = types.UniTuple(kind, 3)(texels, start, width, height, kind, kind, kind, kind, shares)

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        base = context.make_array(texels)(context, builder, arguments[0]).data
        begin, broad, tall = arguments[1:4]
        vector = ir.VectorType(base.type.pointee, 8)
        offsets = ir.Constant(vector, [*_OFFSETS, 0.0, 0.0, 0.0])
        u, v, a, b = (spread(builder, value, 8) for value in arguments[4:8])
        columns, across = _around(builder, _add_product(builder, offsets, a, u), broad)
        rows, down = _around(builder, _add_product(builder, offsets, b, v), tall)
        rest = builder.fsub(ir.Constant(vector, [1.0] * 8), across)
        texel = ir.Constant(begin.type, 4 * kind.bitwidth // 8)  # bytes: what addresses are added up from
        stride, zero = builder.mul(broad, texel), ir.Constant(begin.type, 0)
        below = builder.select(builder.icmp_signed(">", tall, ir.Constant(tall.type, 1)), stride, zero)
        size = ir.Constant(columns.type, [4 * kind.bitwidth // 8] * 8)
        columns = builder.mul(columns, size)

        def lane(values: Any, k: int) -> Any:
            return builder.zext(builder.extract_element(values, ir.Constant(_INDEX, k)), begin.type)

        place = [lane(columns, k) for k in range(5)]
        corner = builder.gep(
            builder.bitcast(base, ir.IntType(8).as_pointer()), [builder.mul(begin, texel)], inbounds=True
        )
        upper = [builder.gep(corner, [builder.mul(lane(rows, k), stride)], inbounds=True) for k in range(5)]
        lower = [builder.gep(line, [below], inbounds=True) for line in upper]
        sink = [pick(builder, down, down, [k] * 8) for k in range(5)]
        blend = [pick(builder, rest, across, [k] * 4 + [8 + k] * 4) for k in range(5)]

        def two_rows(row: int, column: int) -> Any:
            starts = [builder.gep(line[row], [place[column]], inbounds=True) for line in (upper, lower)]
            top, bottom = (builder.load(builder.bitcast(at, vector.as_pointer()), align=4) for at in starts)
            return _lerp(builder, top, bottom, sink[row])

        near, side, far = (spread(builder, builder.extract_value(arguments[8], k), 8) for k in range(3))
        upright = builder.fmul(side, builder.fadd(two_rows(1, 0), two_rows(2, 0)))
        total = builder.fmul(_add_product(builder, near, two_rows(0, 0), upright), blend[0])
        beside = builder.fmul(two_rows(0, 1), blend[1])
        total = _add_product(builder, side, _add_product(builder, two_rows(0, 2), blend[2], beside), total)
        corners = builder.fmul(builder.fadd(two_rows(3, 3), two_rows(4, 3)), blend[3])
        corners = _add_product(builder, builder.fadd(two_rows(3, 4), two_rows(4, 4)), blend[4], corners)
        total = _add_product(builder, far, corners, total)
        total = builder.fadd(pick(builder, total, total, [0, 1, 2, 3]), pick(builder, total, total, [4, 5, 6, 7]))
        channels = [builder.extract_element(total, ir.Constant(_INDEX, k)) for k in range(3)]
        return context.make_tuple(builder, signature.return_type, channels)

    return signature, generate


@intrinsic
def _add_share(typingctx: Any, out: Any, k: Any, texel: Any, share: Any, over: Any) -> Any:
    kind, blended = out.dtype, not isinstance(over, types.NoneType)
    signature = types.void(out, k, types.UniTuple(kind, 4), kind, over)

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        target = context.make_array(out)(context, builder, arguments[0]).data
        vector, weight = ir.Constant(ir.VectorType(target.type.pointee, 4), ir.Undefined), arguments[3]
        for n, value in enumerate(cgutils.unpack_tuple(builder, arguments[2], 4)):
            vector = builder.insert_element(vector, value, ir.Constant(_INDEX, n))
        before = load(builder, target, arguments[1], 4)
        if blended:
            rest = builder.fsub(ir.Constant(weight.type, 1.0), weight)
            before = builder.fmul(before, spread(builder, rest, 4))
        added = builder.fadd(before, builder.fmul(vector, spread(builder, weight, 4)))
        store(builder, added, target, arguments[1])
        return context.get_dummy_value()

    return signature, generate


@intrinsic
def _weigh_texels(typingctx: Any, texels: Any, places: Any, weights: Any) -> Any:
    signature = types.UniTuple(texels.dtype, 4)(texels, places, weights)

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        base = context.make_array(texels)(context, builder, arguments[0]).data
        total = None
        for k in range(len(places)):
            texel = load(builder, base, builder.extract_value(arguments[1], k), 4)
            weight = spread(builder, builder.extract_value(arguments[2], k), 4)
            total = _add_product(builder, texel, weight, total) if total else builder.fmul(texel, weight)
        channels = [builder.extract_element(total, ir.Constant(_INDEX, k)) for k in range(4)]
        return context.make_tuple(builder, signature.return_type, channels)

    return signature, generate


def blend_four(builder: Any, base: Any, a: Any, b: Any, c: Any, d: Any, across: Any, down: Any) -> Any:
    """Blend texels a, b above c, d, every operation rounded."""
    corners = [load(builder, base, place, 4) for place in (a, b, c, d)]
    return blend_vectors(builder, corners, spread(builder, across, 4), spread(builder, down, 4))


def blend_vectors(builder: Any, corners: Sequence[Any], across: Any, down: Any) -> Any:
    """Blend four vectors, two above two, every operation rounded; weights are vectors, too."""
    a, b, c, d = corners
    return plain_lerp(builder, plain_lerp(builder, a, b, across), plain_lerp(builder, c, d, across), down)


@intrinsic
def _blend_over(
    typingctx: Any, texels: Any, a: Any, b: Any, c: Any, d: Any, across: Any, down: Any, share: Any, out: Any, k: Any
) -> Any:
    kind, whole = texels.dtype, isinstance(share, types.NoneType)
    signature = types.void(texels, a, b, c, d, kind, kind, share if whole else kind, out, k)

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        base, target = (context.make_array(t)(context, builder, arguments[n]).data for t, n in ((texels, 0), (out, 8)))
        read = blend_four(builder, base, *arguments[1:7])
        if not whole:
            before = load(builder, target, arguments[9], 4)
            read = plain_lerp(builder, before, read, spread(builder, arguments[7], 4))
        store(builder, read, target, arguments[9])
        return context.get_dummy_value()

    return signature, generate


def _blend_interpreted(texels: Any, a: int, b: int, c: int, d: int, across: Any, down: Any) -> tuple[Any, ...]:
    upper, lower = (texels[p] + (texels[q] - texels[p]) * across for p, q in ((a, b), (c, d)))
    return tuple(upper + (lower - upper) * down)


def _over_interpreted(
    texels: Any, a: int, b: int, c: int, d: int, across: Any, down: Any, share: Any, out: Any, k: int
) -> None:
    out[k] += (_blend_interpreted(texels, a, b, c, d, across, down) - out[k]) * share


def _to_interpreted(texels: Any, a: int, b: int, c: int, d: int, across: Any, down: Any, out: Any, k: int) -> None:
    out[k] = _blend_interpreted(texels, a, b, c, d, across, down)


def _add_interpreted(out: Any, k: int, texel: tuple[Any, ...], share: Any) -> None:
    out.reshape(-1, 4)[k] += np.array(texel) * share


def _lay_interpreted(out: Any, k: int, texel: tuple[Any, ...], share: Any) -> None:
    flat = out.reshape(-1, 4)
    flat[k] = flat[k] * (1 - share) + np.array(texel) * share


def _weigh_interpreted(texels: Any, places: tuple[int, ...], weights: tuple[Any, ...]) -> tuple[Any, ...]:
    return tuple(sum(weight * texels[place] for place, weight in zip(places, weights, strict=True)))


def _places_interpreted(centre: Any, radius: Any, size: int) -> tuple[Any, Any]:
    places = np.array([centre + type(centre)(offset) * radius for offset in _OFFSETS])
    centred = np.clip(places - places.dtype.type(0.5), 0, size - 1)
    first = np.minimum(centred.astype(np.int64), max(size - 2, 0))
    return first, centred - first.astype(centred.dtype)


def _circle_interpreted(
    texels: Any, start: int, width: int, height: int, u: Any, v: Any, a: Any, b: Any, shares: Any
) -> tuple[Any, ...]:
    columns, across = _places_interpreted(u, a, width)
    rows, down = _places_interpreted(v, b, height)
    below = width if height > 1 else 0

    def read(row: int, column: int) -> Any:
        top, w, h = start + rows[row] * width + columns[column], across[column], down[row]
        left, right = (texels[at] + (texels[at + below] - texels[at]) * h for at in (top, top + 1))
        return left + (right - left) * w

    near, side, far = shares
    total = near * read(0, 0) + side * (read(1, 0) + read(2, 0) + read(0, 1) + read(0, 2))
    return tuple((total + far * (read(3, 3) + read(4, 3) + read(3, 4) + read(4, 4)))[:3])


if JIT_DISABLED:
    blend_over, blend_to, read_circle = _over_interpreted, _to_interpreted, _circle_interpreted
    add_share, lay_share, weigh_texels = _add_interpreted, _lay_interpreted, _weigh_interpreted
else:

    @inline
    def blend_to(texels, a, b, c, d, across, down, out, k):
        """Write the bilinear blend of texels a, b above c, d to texel k of out, every operation rounded."""
        _blend_over(texels, a, b, c, d, across, down, None, out, k)

    @inline
    def blend_over(texels, a, b, c, d, across, down, share, out, k):
        """Blend a share of what `blend_to` writes over what is there."""
        _blend_over(texels, a, b, c, d, across, down, share, out, k)

    @inline
    def add_share(out, k, texel, share):
        """Add a share of a texel, a tuple of four, to texel k of out."""
        _add_share(out, k, texel, share, None)

    @inline
    def lay_share(out, k, texel, share):
        """Lay a texel, a tuple of four, over texel k of out with the share as opacity."""
        _add_share(out, k, texel, share, True)

    @inline
    def weigh_texels(texels, places, weights):
        """Sum of the texels at `places`, a tuple of any length, times their weights: a tuple of four."""
        return _weigh_texels(texels, places, weights)

    @inline
    def read_circle(texels, start, width, height, u, v, a, b, shares):
        """Sum of nine weighted bilinear reads around u, v [texels from the corner], cut at the border: three channels.

        The level of width x height begins at texel `start`; after the last one, one more must be there to be loaded.
        Points lie at (u, v), (u +- a, v), (u, v +- b), and at INWARD of both; shares: the weights of one of each.
        """
        return _read_circle(texels, start, width, height, u, v, a, b, shares)
