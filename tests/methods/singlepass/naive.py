"""Naive twins: published loops written pixel by pixel, in the order in which the papers print them.

They share no code with the package. Every operation is rounded to the type of the colour image, so that a twin and a
kernel can be compared bit for bit.
"""

import math

import numpy as np


def single_pass(color, depth, coc, depth_filter):
    """Gustafsson's loop over a whole image: color (H, W, 3), depth (H, W), coc (H, W) px -> (H, W, 3)."""
    out = np.empty_like(color)
    for y, x in np.ndindex(depth.shape):
        out[y, x] = single_pass_at(x, y, color, depth, coc, depth_filter)
    return out


def single_pass_at(x, y, color, depth, coc, depth_filter):
    """The listing's `depthOfField` for one pixel: (3,).

    Offsets are taken in double precision, "bilinear" blends inverse depth and signed circles of confusion, and
    smoothstep is t (t (3 - 2 t)).
    """
    own = color.dtype.type
    zero, one, two, three, largest = (own(v) for v in (0, 1, 2, 3, 20))
    depth_order = depth if depth_filter == "nearest" else -(one / depth)  # grows with depth

    def blur_size(signed):
        return min(abs(signed), largest)

    def texel(image, i, j):
        return image[min(max(j, 0), image.shape[0] - 1), min(max(i, 0), image.shape[1] - 1)]

    def bilinear(image, dx, dy):
        i, j = math.floor(dx), math.floor(dy)
        u, v = own(dx - i), own(dy - j)
        a, b = texel(image, x + i, y + j), texel(image, x + i + 1, y + j)
        c, d = texel(image, x + i, y + j + 1), texel(image, x + i + 1, y + j + 1)
        above, below = a + (b - a) * u, c + (d - c) * u
        return above + (below - above) * v

    def nearest(image, dx, dy):
        return texel(image, x + math.floor(dx + 0.5), y + math.floor(dy + 0.5))

    read = {"nearest": nearest, "bilinear": bilinear}[depth_filter]
    center_size = blur_size(coc[y, x])
    total_color, total = color[y, x].copy(), one
    radius, angle = 0.5, 0.0
    while radius < 20.0:
        dx, dy = math.cos(angle) * radius, math.sin(angle) * radius
        sample = bilinear(color, dx, dy)
        size = blur_size(read(coc, dx, dy))
        if read(depth_order, dx, dy) > depth_order[y, x]:  # sampleDepth > centerDepth
            size = min(size, two * center_size)
        t = min(max(size - own(radius - 0.5), zero), one)
        m = t * (t * (three - two * t))
        total_color = total_color + (total_color / total * (one - m) + sample * m)
        total = total + one
        radius += 0.5 / radius
        angle += 2.39996323
    return total_color / total
