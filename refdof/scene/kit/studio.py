"""Studio: what mirrors see, as an octahedral map: soft boxes, a window, small hard lamps, walls and a table.

The map's columns run along world x, its rows along world z; the upper half is the inner diamond.

References
----------
.. [1] Cigolle et al. (2014), A Survey of Efficient Representations for Independent Unit Vectors.
"""

import numpy as np

from refdof._check import Float
from refdof.scene.kit.noise import smooth
from refdof.scene.kit.textures import blend, paint, ramp

__all__ = ["directions", "studio"]


def directions(size: int) -> Float:
    """World direction (n, n, 3) of every texel's centre, [1]."""
    s = (np.arange(size) + 0.5) / size * 2.0 - 1.0
    p, q = np.meshgrid(s, s)
    y = 1.0 - np.abs(p) - np.abs(q)
    x = np.where(y < 0, (1.0 - np.abs(q)) * np.where(p < 0, -1.0, 1.0), p)
    z = np.where(y < 0, (1.0 - np.abs(p)) * np.where(q < 0, -1.0, 1.0), q)
    vectors = np.stack([x, y, z], axis=-1)
    return vectors / np.sqrt((vectors * vectors).sum(axis=-1, keepdims=True))


def studio(size: int, table: str) -> Float:
    """Radiance (n, n, 3) float32 of the studio around the table of the given paint."""
    d = directions(size)
    up, bearing = d[..., 1], np.arctan2(d[..., 0], -d[..., 2])
    color: Float = (
        ramp(0.5 + 0.5 * up, ("#4a3d35", "#6d645c", "#8a8a8c", "#4a4c55"))
        * (0.75 + 0.35 * np.cos(bearing + 0.8))[..., None]
    )
    # The table's boards below, lighter under the lamps; the room's skirting as a thin line.
    below = smooth(0.01, -0.02, up)
    plank = 0.8 + 0.2 * np.sign(np.sin(14.0 * d[..., 0] / np.maximum(-up, 0.05)))
    color = blend(color, paint(table) * (0.35 + 0.5 * np.maximum(-up, 0))[..., None] * plank[..., None], below)
    color = blend(color, paint("#8a8078"), 0.6 * smooth(0.012, 0.004, np.abs(up - 0.10)))

    def panel(bearing0: float, up0: float, wide: float, high: float, bars: int = 0) -> Float:
        """Coverage of an upright rectangle, measured in bearing and height."""
        a = (bearing - bearing0 + np.pi) % (2 * np.pi) - np.pi
        edge = np.minimum(wide - np.abs(a) * np.sqrt(np.maximum(1 - up0**2, 0.05)), high - np.abs(up - up0))
        mask = smooth(-0.006, 0.006, edge)
        for k in range(1, bars):
            mask = mask * smooth(0.008, 0.016, np.abs(a * np.sqrt(1 - up0**2) - wide * (2 * k / bars - 1)))
            mask = mask * smooth(0.008, 0.016, np.abs(up - up0 - high * (2 * k / bars - 1)))
        return mask

    for bearing0, up0, wide, high, bars, light in (
        (-2.35, 0.52, 0.42, 0.30, 0, (5.2, 5.0, 4.6)),  # large soft box behind the camera on the left
        (0.95, 0.42, 0.13, 0.40, 0, (3.4, 3.6, 4.2)),  # strip light on the right
        (-0.95, 0.40, 0.30, 0.26, 3, (2.2, 2.7, 3.4)),  # window
        (2.2, 0.30, 0.20, 0.14, 0, (2.6, 1.3, 0.5)),  # orange gel
        (0.1, 0.75, 0.20, 0.07, 0, (4.0, 3.9, 3.7)),  # hair light
    ):
        mask = panel(bearing0, up0, wide, high, bars)
        color = blend(color, np.asarray(light) * (0.85 + 0.3 * (up - up0))[..., None], mask)
    for k in range(7):  # a row of bare bulbs
        b = 2.55 + 0.14 * k
        at = np.array([np.sin(b) * 0.8, 0.6, -np.cos(b) * 0.8])
        color = color + np.array([26.0, 20.0, 12.0]) * smooth(0.9994, 0.9998, d @ at)[..., None]
    return np.maximum(color, 0.0).astype(np.float32)
