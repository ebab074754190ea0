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
    columns = cuts(low[0], high[0], width)
    rows = cuts(low[1], high[1], height)
    for u0, u1 in pairwise(columns):
        sides = np.linspace(u0, u1, STRIPS + 1)
        for v0, v1 in pairwise(rows):
            ends = np.array(
                [[inside(opacity, u, v, wrap, (u0 + u1) / 2, (v0 + v1) / 2) for u in sides] for v in (v0, v1)]
            )
            for k in range(STRIPS):
                quads += strip(sides[k : k + 2], (v0, v1), ends[:, k : k + 2] - cutoff)
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
    spans = []
    for side in range(2):
        begin, end = over[0, side], over[1, side]
        if begin < 0 and end < 0:
            spans.append((0.0, 0.0) if begin > end else (1.0, 1.0))
        elif begin >= 0 and end >= 0:
            spans.append((0.0, 1.0))
        else:
            cut = begin / (begin - end)
            spans.append((0.0, cut) if begin >= 0 else (cut, 1.0))
    height = v[1] - v[0]
    (a, b), (c, d) = spans
    corners = [
        (u[0], v[0] + a * height),
        (u[1], v[0] + c * height),
        (u[1], v[0] + d * height),
        (u[0], v[0] + b * height),
    ]
    return [] if b - a + d - c <= 0.0 else [corners]


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
