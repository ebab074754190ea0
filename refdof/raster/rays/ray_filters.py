"""Ray filters: what Embree asks at every triangle that a ray meets, in its own layout of memory.

1. collect every triangle along a ray                       `collect`
2. let rays pass through holes and transparent surfaces     `let_through`

A filter is called with six pointers: valid lanes, user data, query context, ray, hit, number of lanes. The context
starts with two words of Embree's; ours follow.
"""

import numpy as np

from refdof._check import Index
from refdof._jit import array_at, callback, inline
from refdof.optics.owen_sobol import axis_seed
from refdof.raster.materials.cutouts import Cutouts, opacity_at
from refdof.raster.rays.surfaces import Surfaces, intersect

__all__ = ["collect", "hole_words", "let_through"]

_VALID, _CONTEXT, _RAY, _HIT, _LANES = 0, 2, 3, 4, 5
_ORG_X, _ORG_Y, _DIR_X, _DIR_Y, _ID = 0, 1, 4, 5, 10  # rows of a ray
_PRIM = 5  # row of a hit
_UNIT = 2.0**-32


@callback
def collect(arguments):
    """Note the triangle behind the query context and let the ray go on.

    The context's own fields: capacity, count, then `capacity` triangle ids, int32.
    """
    context = array_at(arguments[_CONTEXT], (4,), np.int32)
    capacity, count = context[2], context[3]
    if count < capacity:
        found = array_at(arguments[_CONTEXT] + 16, (capacity,), np.int32)
        found[count] = array_at(arguments[_HIT] + 4 * _PRIM, (1,), np.int32)[0]
    context[3] = count + 1
    array_at(arguments[_VALID], (1,), np.int32)[0] = 0


@callback
def let_through(arguments):
    """Let rays along (dx, dy, -1) from z = 0 go on where a surface is a hole, or by chance where it is transparent.

    The chance is one number for a ray's id and a triangle, so that the order in which Embree asks is of no matter.
    The context's own fields: `hole_words`.
    """
    lanes = arguments[_LANES] & 0xFFFFFFFF
    valid = array_at(arguments[_VALID], (lanes,), np.int32)
    ray = array_at(arguments[_RAY], (12, lanes), np.float32)
    ids = array_at(arguments[_RAY] + 4 * _ID * lanes, (lanes,), np.int32)
    triangles = array_at(arguments[_HIT] + 4 * _PRIM * lanes, (lanes,), np.int32)
    words = array_at(arguments[_CONTEXT], (9,), np.int64)
    corner = array_at(words[1], (words[2], 9), np.float64)
    cutouts = Cutouts(
        array_at(words[3], (words[2],), np.int32),
        array_at(words[4], (words[2], 9), np.float32),
        array_at(words[5], (words[6], 7), np.float64),
        array_at(words[7], (words[8],), np.float32),
        True,
    )
    for lane in range(lanes):
        face = triangles[lane]
        if valid[lane] == 0 or cutouts.material[face] < 0:
            continue
        ox, oy, dx, dy = ray[_ORG_X, lane], ray[_ORG_Y, lane], ray[_DIR_X, lane], ray[_DIR_Y, lane]
        _, u, v = intersect(corner, face, np.float64(ox), np.float64(oy), 0.0, np.float64(dx), np.float64(dy), -1.0)
        if _chance(ids[lane], face) >= opacity_at(cutouts, face, u, v):
            valid[lane] = 0


@inline
def _chance(ray, face):
    """A number in 0 .. 1, without 1, that a ray's id and a triangle draw."""
    return axis_seed(np.uint64(np.uint32(ray)), face) * _UNIT


def hole_words(surfaces: Surfaces) -> Index:
    """The query context (9,) int64 of `let_through`: addresses and lengths of arrays, which the caller keeps alive."""
    cutouts = surfaces.cutouts
    words = np.zeros(9, dtype=np.int64)
    words[:1].view(np.int32)[:] = -1
    words[1:] = (
        surfaces.corner.ctypes.data,
        len(surfaces.corner),
        cutouts.material.ctypes.data,
        cutouts.corner.ctypes.data,
        cutouts.table.ctypes.data,
        len(cutouts.table),
        cutouts.texels.ctypes.data,
        len(cutouts.texels),
    )
    return words
