"""Naive twins: published loops written pixel by pixel, in the order in which the papers print them.

They share no code with the package. Every operation is rounded to the type of the colour image, so that a twin and a
kernel can be compared bit for bit.
"""

import math

import numpy as np

LISTING = {
    "rad_scale": 0.5,
    "max_blur_size": 20.0,
    "behind_factor": 2.0,
    "angle_start": 0.0,
    "angle_step": 2.39996323,
    "radius_start": None,
    "loop_bound": None,
    "max_taps": None,
    "row_order": "down",
    "scale_x": 1.0,
    "scale_y": 1.0,
    "shift_x": 0.0,
    "shift_y": 0.0,
    "color_filter": "bilinear",
    "order": "depth",
    "border": "clamp",
    "precision": "float64",
}


def single_pass(color, depth, coc, depth_filter, circle_of=None, **changes):
    """Gustafsson's loop over a whole image: color (H, W, 3), depth (H, W), coc (H, W) px -> (H, W, 3)."""
    out = np.empty_like(color)
    for y, x in np.ndindex(depth.shape):
        out[y, x] = single_pass_at(x, y, color, depth, coc, depth_filter, circle_of, **changes)
    return out


def single_pass_at(x, y, color, depth, coc, depth_filter, circle_of=None, **changes):
    """The listing's `depthOfField` for one pixel, with some of its constants changed: (3,).

    Offsets are taken in double precision, "bilinear" blends inverse depth and signed circles of confusion,
    "bilinear_depth" blends depth and asks `circle_of` for its circle, and smoothstep is t (t (3 - 2 t)).
    """
    steps = taps_at(x, y, color, depth, coc, depth_filter, circle_of, **changes)
    return steps[-1]["total_color"] / steps[-1]["total"]


def taps_at(x, y, color, depth, coc, depth_filter, circle_of=None, nudges=(), **changes):
    """All steps of the loop for one pixel: what was read, and the running sums; the first one is the pixel alone.

    `nudges` are added to the places at which taps read nearest texels, one pair a tap.
    """
    assert set(changes) <= set(LISTING)
    use = {**LISTING, **changes}
    own = color.dtype.type
    zero, one, two, three = (own(v) for v in (0, 1, 2, 3))
    largest, factor = own(use["max_blur_size"]), own(use["behind_factor"])

    def blur_size(signed):
        return min(abs(signed), largest)

    def wrapped(i, count):
        if use["border"] == "clamp":
            return min(max(i, 0), count - 1)
        period = i % count
        if use["border"] == "mirror" and (i // count) % 2 == 1:
            return count - 1 - period
        return period

    def texel(image, i, j):
        return image[wrapped(j, image.shape[0]), wrapped(i, image.shape[1])]

    def four(image, dx, dy):
        i, j = math.floor(dx), math.floor(dy)
        a, b = texel(image, x + i, y + j), texel(image, x + i + 1, y + j)
        c, d = texel(image, x + i, y + j + 1), texel(image, x + i + 1, y + j + 1)
        return a, b, c, d, own(dx - i), own(dy - j)

    def bilinear(image, dx, dy):
        a, b, c, d, u, v = four(image, dx, dy)
        above, below = a + (b - a) * u, c + (d - c) * u
        return above + (below - above) * v

    def nearest(image, dx, dy):
        k = len(steps) - 1
        right, down = nudges[k] if 0 <= k < len(nudges) else (0.0, 0.0)
        return texel(image, x + math.floor(dx + right + 0.5), y + math.floor(dy + down + 0.5))

    def depth_and_circle(dx, dy):
        """What grows with depth, and the signed circle."""
        if depth_filter == "nearest":
            return nearest(depth, dx, dy), nearest(coc, dx, dy)
        if depth_filter == "bilinear":
            return -bilinear(one / depth, dx, dy), bilinear(coc, dx, dy)
        a, b, c, d, u, v = four(depth, dx, dy)
        rows = [q if u == one else p if u == zero else p * (one - u) + q * u for p, q in ((a, b), (c, d))]
        distance = rows[1] if v == one else rows[0] if v == zero else rows[0] * (one - v) + rows[1] * v
        return distance, own(circle_of(distance))

    def place(dx, dy):
        return dx + use["shift_x"], dy + use["shift_y"]

    steps = []
    read_color = {"bilinear": bilinear, "nearest": nearest}[use["color_filter"]]
    center_depth, center_circle = depth_and_circle(*place(0.0, 0.0))
    center_size = blur_size(center_circle)
    total_color, total = read_color(color, *place(0.0, 0.0)).copy(), one
    steps.append({"total_color": total_color, "total": total})

    sums = np.float32 if use["precision"] == "float32" else float
    rad_scale = sums(use["rad_scale"])
    radius = rad_scale if use["radius_start"] is None else sums(use["radius_start"])
    bound = sums(use["max_blur_size"] if use["loop_bound"] is None else use["loop_bound"])
    angle = sums(use["angle_start"])
    while radius < bound and len(steps) - 1 != use["max_taps"]:
        reach = float(radius)
        dx = math.cos(float(angle)) * reach * use["scale_x"]
        dy = math.sin(float(angle)) * reach * use["scale_y"]
        if use["row_order"] == "up":
            dy = -dy
        dx, dy = place(dx, dy)
        sample = read_color(color, dx, dy)
        distance, circle = depth_and_circle(dx, dy)
        size = read = blur_size(circle)
        clamped = [max(min(c, largest), -largest) for c in (circle, center_circle)]
        behind = {"depth": distance > center_depth, "size": clamped[0] > clamped[1], "always": True}
        if behind[use["order"]]:  # sampleDepth > centerDepth
            size = min(size, factor * center_size)
        t = min(max(size - own(reach - 0.5), zero), one)
        m = t * (t * (three - two * t))
        total_color = total_color + (total_color / total * (one - m) + sample * m)
        total = total + one
        step = {"x": x + 0.5 + dx, "y": y + 0.5 + dy, "color": sample, "depth": distance, "size": read, "reach": size}
        steps.append({**step, "weight": m, "total_color": total_color, "total": total})
        radius += rad_scale / radius
        angle += sums(use["angle_step"])
    return steps
