"""Wrong ports of the single pass, written apart from the emulation of them: all pixels at once, a loop over taps."""

import numpy as np
from scipy import ndimage

from refdof.methods.singlepass.params import GOLDEN_ANGLE

__all__ = ["WRONG", "in_place", "mixed", "port", "short_and_shifted", "turned"]


def smoothstep(low, high, value):
    t = np.clip((value - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def port(
    color, depth, coc, params, *,
    size=lambda coc, largest: np.minimum(np.abs(coc), largest), behind=lambda tap, own, s, s0: tap > own,
    factor=2.0, step=GOLDEN_ANGLE, start=0.0, bound=20.0, y_sign=1.0, shift=0.0, nearest=False, wrap=False,
    rim=smoothstep, mean=lambda total_color, total: total_color / total, first=1.0, aspect=False, scale=0.5,
    turn=lambda x, y: 0.0,
):  # fmt: skip
    """The listing, in float64, with everything that a test has wrong."""
    height, width = depth.shape
    y, x = np.indices(depth.shape) + 0.5 + shift
    index = (lambda k, n: k.astype(int) % n) if wrap else (lambda k, n: np.clip(k, 0, n - 1).astype(int))

    def texel(image, px, py):
        return image[index(np.floor(py), height), index(np.floor(px), width)]

    def blended(px, py):
        if nearest:
            return texel(color, px, py)
        left, top = np.floor(px - 0.5), np.floor(py - 0.5)
        a, b = (px - 0.5 - left)[..., None], (py - 0.5 - top)[..., None]
        upper = texel(color, left, top) * (1 - a) + texel(color, left + 1, top) * a
        lower = texel(color, left, top + 1) * (1 - a) + texel(color, left + 1, top + 1) * a
        return upper * (1 - b) + lower * b

    color = color.astype(np.float64)
    own_depth, own_size = texel(depth, x, y), size(texel(coc, x, y), 20.0)
    total_color, total, radius, angle = blended(x, y), first, scale, start
    while radius < bound:
        px = x + np.cos(angle + turn(x, y)) * radius
        py = y + y_sign * np.sin(angle + turn(x, y)) * radius * (height / width if aspect else 1.0)
        tap_size = size(texel(coc, px, py), 20.0)
        limited = behind(texel(depth, px, py), own_depth, tap_size, own_size)
        reach = np.where(limited, np.minimum(tap_size, factor * own_size), tap_size)
        m = rim(radius - 0.5, radius + 0.5, reach)[..., None]
        total_color = total_color + (1 - m) * mean(total_color, total) + m * blended(px, py)
        total += 1.0
        angle += step
        radius += scale / radius
    return (total_color / total).astype(np.float32)


def wrong(**faults):
    return lambda color, depth, coc, params: port(color, depth, coc, params, **faults)


def after(change):
    return lambda color, depth, coc, params: change(port(color, depth, coc, params)).astype(np.float32)


def short_and_shifted(color, depth, coc, params):
    return port(color, depth, coc, params, bound=8.8, shift=0.5)


def turned(color, depth, coc, params):
    """Every pixel starts at another angle."""
    return port(
        color, depth, coc, params, turn=lambda x, y: 6.2832 * np.modf(np.sin(12.9898 * x + 78.233 * y) * 43.5)[0]
    )


def mixed(color, depth, coc, params):
    """Two mistakes: half of the limit, and a mirrored spiral."""
    return port(color, depth, coc, params, factor=1.0, y_sign=-1.0)


def in_place(color, depth, coc, params):
    """Every pixel is written into the picture that is read, in rows."""
    color = color.astype(np.float64)
    for y, x in np.ndindex(depth.shape):
        color[y, x] = pixel(color, depth, coc, x, y)
    return color.astype(np.float32)


def pixel(color, depth, coc, x, y):
    """The listing at one pixel."""
    height, width = depth.shape
    radii = [0.5]
    while radii[-1] < 20.0:
        radii.append(radii[-1] + 0.5 / radii[-1])
    radii = np.array(radii[:-1])
    angles = GOLDEN_ANGLE * np.arange(len(radii))
    px, py = x + radii * np.cos(angles), y + radii * np.sin(angles)
    near = np.clip(np.floor(py + 0.5), 0, height - 1).astype(int), np.clip(np.floor(px + 0.5), 0, width - 1).astype(int)
    size = np.minimum(np.abs(coc), 20.0)
    reach = np.where(depth[near] > depth[y, x], np.minimum(size[near], 2.0 * size[y, x]), size[near])
    m = smoothstep(radii - 0.5, radii + 0.5, reach)
    taps = [ndimage.map_coordinates(color[..., c], [py, px], order=1, mode="nearest") for c in range(3)]
    mean = color[y, x].copy()
    for k, tap in enumerate(np.transpose(taps)):
        mean += m[k] * (tap - mean) / (k + 2)
    return mean


WRONG = {  # (key, stage): a port that has it
    ("behind_factor", "limit"): wrong(factor=1.0),
    ("order_rule", "limit"): wrong(behind=lambda tap, own, s, s0: tap < own),
    ("coc_scale", "coc"): wrong(size=lambda coc, largest: np.minimum(2.0 * np.abs(coc), largest)),
    ("coc_near_lost", "coc"): wrong(size=lambda coc, largest: np.clip(coc, 0.0, largest)),
    ("rad_scale", "taps"): wrong(scale=0.7),
    ("angle_step", "taps"): wrong(step=2.39963),
    ("loop_cut", "taps"): wrong(bound=8.8),
    ("row_order", "taps"): wrong(y_sign=-1.0),
    ("shift", "taps"): wrong(shift=0.5),
    ("color_filter", "taps"): wrong(nearest=True),
    ("pixel_size", "taps"): wrong(aspect=True),
    ("border", "taps"): wrong(wrap=True),
    ("smoothstep_shape", "weight"): wrong(rim=lambda low, high, s: np.clip((s - low) / (high - low), 0.0, 1.0)),
    ("mean_rule", "mean"): wrong(mean=lambda total_color, total: 0.0 * total_color),
    ("initial_total", "mean"): wrong(first=2.0),
    ("channels", "image"): after(lambda image: image[..., ::-1]),
    ("gamma", "image"): after(lambda image: np.minimum(image, 1.0) ** (1 / 2.2)),
    ("flipped", "image"): after(lambda image: image[::-1]),
}
