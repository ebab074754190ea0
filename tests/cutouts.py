"""Cut-outs as polygons: where the bilinear opacity of a texture reaches a cutoff, by strips as narrow as one likes.

Between four neighbouring texels the opacity at a given u is linear in v. So a strip of u is cut along v where the two
linear functions at its sides reach the cutoff, and the strip's parts are quadrilaterals; what their straight sides miss
falls with the square of the strips' width.
"""

from itertools import pairwise

import numpy as np

from refdof import Material, Part

STRIPS = 16  # a cell is cut into this many: the curves' error is below 1 / 8 / STRIPS^2 = 5e-4 of a cell


def fold(index, size, wrap):
    """The texel behind a whole number outside 0 .. size - 1."""
    if wrap == "clamp":
        return min(max(index, 0), size - 1)
    if wrap == "mirror":
        index %= 2 * size
        return index if index < size else 2 * size - 1 - index
    return index % size


def texel_of(image, x, y, wrap):
    """A texel of the endless wall that an image is the lower left corner of; y up."""
    height, width = image.shape[:2]
    return image[height - 1 - fold(y, height, wrap[1]), fold(x, width, wrap[0])]


def bilinear(image, s, t, wrap):
    """The wall at (s, t), t up."""
    height, width = image.shape[:2]
    x, y = s * width - 0.5, t * height - 0.5
    i, j = int(np.floor(x)), int(np.floor(y))
    a, b = x - i, y - j
    low = (1 - a) * texel_of(image, i, j, wrap) + a * texel_of(image, i + 1, j, wrap)
    high = (1 - a) * texel_of(image, i, j + 1, wrap) + a * texel_of(image, i + 1, j + 1, wrap)
    return (1 - b) * low + b * high


def solid_quads(opacity, cutoff, wrap, low, high):
    """Quadrilaterals (N, 4, 2) in (u, v) that tile the part of the box low .. high where the opacity is >= cutoff."""
    height, width = opacity.shape
    quads = []
    for u in pairwise(cuts(low[0], high[0], width)):
        for v in pairwise(cuts(low[1], high[1], height)):
            middle = np.mean(u), np.mean(v)
            corner = np.array([[inside(opacity, x, y, wrap, *middle) for x in u] for y in v]) - cutoff
            step = corner[:, 1] - corner[:, 0]
            # Where the rim leaves the cell through an end, which is a line in u, a strip ends.
            leaves = [-corner[k, 0] / step[k] for k in range(2) if corner[k, 0] * corner[k, 1] < 0.0]
            sides = np.unique([*np.linspace(0.0, 1.0, STRIPS + 1), *leaves])
            over = corner[:, :1] + step[:, None] * sides
            over[np.abs(over) < 1e-12] = 0.0  # at a rim that leaves
            for k in range(len(sides) - 1):
                quads += strip(u[0] + (u[1] - u[0]) * sides[k : k + 2], v, over[:, k : k + 2])
    return np.array(quads).reshape(-1, 4, 2)


def cuts(low, high, size):
    """low, high, and every texel centre in between."""
    centres = (np.arange(np.floor(low * size) - 1, np.ceil(high * size) + 1) + 0.5) / size
    return np.array([low, *centres[(centres > low) & (centres < high)], high])


def inside(image, u, v, wrap, near_u, near_v):
    """The bilinear value at (u, v) of the cell that holds (near_u, near_v), of which (u, v) may be an end."""
    return bilinear(image, u + 1e-9 * (near_u - u), v + 1e-9 * (near_v - v), wrap)


def strip(u, v, over):
    """The quadrilaterals of a strip where `over` (2 ends in v, 2 sides in u) is not negative; linear along v."""
    if (over <= 0.0).all():
        return []
    spans = []
    for begin, end in over.T:
        cut = begin / (begin - end) if begin * end < 0.0 else 0.0
        if begin * end < 0.0:
            spans.append((0.0, cut) if begin > 0.0 else (cut, 1.0))
        elif begin >= 0.0 and end >= 0.0:
            spans.append((0.0, 1.0))
        else:  # the rim leaves here, and at most a point is solid
            spans.append((0.0, 0.0) if begin > end else (1.0, 1.0))
    height = v[1] - v[0]
    (a, b), (c, d) = spans
    low, high = v[0] + height * np.array([a, c]), v[0] + height * np.array([b, d])
    return [[(u[0], low[0]), (u[1], low[1]), (u[1], high[1]), (u[0], high[0])]]


def cut_card(box, depth, uv, material, opacity=None):
    """An upright rectangle x0, x1, y0, y1 at a depth, with texture coordinates u0, u1, v0, v1 along its sides."""
    x0, x1, y0, y1 = box
    u0, u1, v0, v1 = uv
    corners = np.array([[x0, y0, -depth], [x1, y0, -depth], [x1, y1, -depth], [x0, y1, -depth]])
    places = np.array([[u0, v0], [u1, v0], [u1, v1], [u0, v1]])
    return Part(corners, [[0, 1, 2], [0, 2, 3]], material, uv=places, opacity=opacity)


def hole_material(opacity, cutoff, wrap=("repeat", "repeat"), color=(1.0, 1.0, 1.0), scale=1.0):
    """An unlit material with holes."""
    return Material("unlit", color, opacity=scale, opacity_texture=opacity, cutoff=cutoff, wrap=wrap)
