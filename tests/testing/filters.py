"""Filters of a user: one that is right, and others with one mistake each."""

import numpy as np
from scipy import ndimage


def disc(radius, right=None):
    """(n, n) weights of a disc, 1 inside and falling to 0 over one pixel; without columns beyond `right`."""
    side = int(np.ceil(radius))
    y, x = np.mgrid[-side : side + 1, -side : side + 1]
    weights = np.clip(radius + 0.5 - np.hypot(x, y), 0.0, 1.0)
    weights[side, side] = 1.0
    return weights if right is None else np.where(x > right, 0.0, weights)


def gather(color, depth, coc, *, scale=1.0, right=None, mode="constant", share=1.0):
    """Every pixel is the mean over its own disc: right, as far as one picture can be."""
    out = color.copy()
    for radius in np.unique(np.abs(coc)):
        here = np.abs(coc) == radius
        weights = disc(scale * radius, right)
        total = ndimage.correlate(np.ones(depth.shape), weights, mode=mode)
        for c in range(color.shape[2]):
            sums = ndimage.correlate(color[..., c].astype(np.float64), weights, mode=mode)
            out[here, c] = (sums / total)[here] * (share if radius > 0.0 else 1.0)
    return out


def black(color, depth, coc):
    """All light is lost."""
    return 0.0 * color


def leaking(color, depth, coc):
    """What is blurred loses a hundredth of its light."""
    return gather(color, depth, coc, share=0.99)


def shifted(color, depth, coc):
    """Reads between pixels: half a pixel to the right."""
    after = np.concatenate([color[:, 1:], color[:, -1:]], axis=1)
    return gather(0.5 * (color + after), depth, coc)


def lopsided(color, depth, coc):
    """The loop over columns ends one too early."""
    return gather(color, depth, coc, right=0)


def clamped(color, depth, coc):
    """Light beyond white is lost."""
    return gather(np.minimum(color, 1.0), depth, coc)


def swapped(color, depth, coc):
    """Blue, green, red."""
    return gather(color, depth, coc)[..., ::-1]


def wrapped(color, depth, coc):
    """What leaves the picture enters it on the other side."""
    return gather(color, depth, coc, mode="wrap")


def twice(color, depth, coc):
    """A diameter where a radius is meant."""
    return gather(color, depth, coc, scale=2.0)


def quarter_in_front(color, depth, coc):
    """A near field at a lower resolution, forgotten when it is laid over."""
    return gather(color, depth, np.where(coc < 0.0, 0.5 * coc, coc))


def smeared(color, depth, coc):
    """The largest circle of the picture, everywhere."""
    return gather(color, depth, np.full_like(coc, np.abs(coc).max()))


def bright_first(color, depth, coc):
    """Weighs light by its own brightness, for discs that stand out."""
    weight = 1.0 + color.mean(axis=2, keepdims=True)
    return gather(color * weight, depth, coc) / gather(np.broadcast_to(weight, color.shape).copy(), depth, coc)


def own_circles(color, depth, camera, lens):
    """As `gather`, from camera and lens."""
    scale = camera.pixels_per_tangent * lens.radius
    return gather(color, depth, scale * (1.0 / lens.focus_distance - 1.0 / depth))


def by_width(color, depth, camera, lens):
    """The vertical field of view, taken for the horizontal one."""
    scale = camera.pixels_per_tangent * camera.width / camera.height * lens.radius
    return gather(color, depth, scale * (1.0 / lens.focus_distance - 1.0 / depth))


def in_metres(color, depth, camera, lens):
    """Sharp within a millimetre, whatever the unit."""
    scale = camera.pixels_per_tangent * lens.radius
    coc = scale * (1.0 / lens.focus_distance - 1.0 / depth)
    return gather(color, depth, np.where(np.abs(depth - lens.focus_distance) < 1e-3, 0.0, coc))


def far_plane(color, depth, camera, lens):
    """What is at infinity is left out."""
    scale = camera.pixels_per_tangent * lens.radius
    return gather(color, depth, np.where(np.isinf(depth), 0.0, scale * (1.0 / lens.focus_distance - 1.0 / depth)))
