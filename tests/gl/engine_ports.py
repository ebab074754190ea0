"""The passes of methods that engines use, as their hosts draw them: every stage and the picture that the shaders make.

`draw` is `tests.gl.port.drawn` with its context, or what does as much; `sources` are the texts of `SOURCES`, by name.
"""

import numpy as np

from refdof.methods import circular as complex_kernels
from tests.gl.port import source_of

__all__ = ["PORTS", "SOURCES", "circular", "filament", "halfres", "hexagon", "ringgather"]

_NAMES = {
    "hexagon": ("hexagon",),
    "halfres": ("halfres_near", "halfres_mean", "halfres_brightest", "halfres"),
    "circular": ("circular_across", "circular_down"),
    "ringgather": (
        "ringgather_circle", "tiles", "around", "ringgather_prefilter", "ringgather_rings", "median", "ringgather",
    ),
    "filament": ("filament_half", "filament_level", "tiles", "around", "filament_gather", "median", "filament"),
}  # fmt: skip
SOURCES = {method: {name: source_of(name) for name in names} for method, names in _NAMES.items()}


def hexagon(draw, color, depth, coc, params, sources=SOURCES["hexagon"]):
    """Stages "down" and "both", and the picture."""
    words = {"uLargest": params.largest_px, "uEqual": params.rhombi == "equal"}
    textures, linear = {"uDown": color, "uBoth": color, "uCircle": coc}, ("uDown", "uBoth")
    down, both = draw(sources["hexagon"], coc.shape, textures, 2, linear, uFirst=True, **words)
    textures = {"uDown": down, "uBoth": both, "uCircle": coc}
    picture, _ = draw(sources["hexagon"], coc.shape, textures, 2, linear, uFirst=False, **words)
    return {"down": down[..., :3], "both": both[..., :3]}, picture[..., :3]


def halfres(draw, color, depth, coc, params, sources=SOURCES["halfres"]):
    """Stages of near and far, means and greatest values, and the picture."""
    blur = np.minimum(np.abs(coc) / np.float32(params.largest_px), 1.0)
    spread, far = np.where(coc <= 0, blur, 0.0), np.where(coc >= 0, blur, 0.0)
    size = coc.shape
    half = tuple(int(side / 2 + 0.5) for side in size)
    for axis in ((1, 0), (0, 1)):
        spread = draw(sources["halfres_near"], size, {"uNear": spread}, uAxis=axis)[0][..., 0]
    found = []
    for circle in (spread, far):
        textures = {"uColor": color, "uBlur": circle}
        words = {"uHalf": half[::-1], "uLargest": params.largest_px}
        found += draw(sources["halfres_mean"], half, textures, 1, ("uColor", "uBlur"), **words)
    for mean in found[:2]:
        words = {"uFull": size[::-1], "uLargest": params.largest_px}
        found += draw(sources["halfres_brightest"], half, {"uMean": mean}, 1, ("uMean",), **words)
    textures = {"uColor": color, "uNear": found[2], "uFar": found[3]}
    picture = draw(sources["halfres"], size, textures, 1, ("uNear", "uFar"))[0]
    names = ("near_mean", "far_mean", "near_brightest", "far_brightest")
    return dict(zip(names, found, strict=True)), picture[..., :3]


def circular(draw, color, depth, coc, params, sources=SOURCES["circular"]):
    """Stage "parts" (H, W, 6 n), and the picture."""
    taps = complex_kernels.kernels(params.components, params.transition).first.astype(np.float32)
    words = {"uStep": (1.0 + params.transition) / (8.0 * params.fitted_radius), "uLargest": params.largest_px}
    parts, picture = [], np.float32(0)
    for n, (_, _, real, imaginary) in enumerate(complex_kernels.COMPONENTS[params.components]):
        words["uTaps"] = [tuple(map(float, tap)) for tap in taps[:, n]]
        textures = {"uColor": color, "uCircle": coc}
        pair = draw(sources["circular_across"], coc.shape, textures, 2, ("uColor",), **words)
        parts += [part[..., :3] for part in pair]
        textures = {"uReal": pair[0], "uImaginary": pair[1], "uCircle": coc}
        linear = ("uReal", "uImaginary")
        weighed = draw(sources["circular_down"], coc.shape, textures, 1, linear, uWeights=(real, imaginary), **words)
        picture = picture + weighed[0][..., :3]
    return {"parts": np.concatenate(parts, axis=2)}, picture


def ring_points(rings, radii):
    """Rings 1 .. `rings` of 8 j points, y down, odd ones from half a step on; `radii` of all: [(x, y), ...]."""
    found = []
    for j in range(1, rings + 1):
        turns = 2.0 * np.pi * (np.arange(8 * j) + (0.5 if j % 2 else 0.0)) / (8 * j)
        found += [(float(radii[j - 1] * np.cos(a)), float(radii[j - 1] * np.sin(a))) for a in turns]
    return found


def ringgather(draw, color, depth, coc, params, sources=SOURCES["ringgather"]):
    """Stages from circles to the median, and the picture. Colours are summed as given."""
    size, depth = coc.shape, np.minimum(depth, np.float32(1e30))
    half, tile_size = tuple((side + 1) // 2 for side in size), tuple(-(-side // 32) for side in size)
    textures = {"uCircle": coc, "uDepth": depth}
    (planes,) = draw(sources["ringgather_circle"], size, textures, uLargest=params.largest_px)
    (tiles,) = draw(sources["tiles"], tile_size, {"uValues": planes}, uChannels=(0, 1), uSide=32)
    (tiles,) = draw(sources["around"], tile_size, {"uTiles": tiles})
    points = ring_points(3, np.arange(1, 4) / (3.0 if params.fill else 4.0))
    words = {"uPoints": points[:8], "uForeground": params.foreground, "uHalf": half[::-1]}
    textures = {"uColor": color, "uPlanes": planes, "uTiles": tiles}
    filtered, weights = draw(sources["ringgather_prefilter"], half, textures, 2, ("uColor",), **words)
    textures = {"uFiltered": filtered, "uWeights": weights, "uTiles": tiles}
    words = {"uPoints": points, "uGain": params.gain}
    (rings,) = draw(sources["ringgather_rings"], half, textures, 1, ("uFiltered",), **words)
    (median,) = draw(sources["median"], half, {"uPicture": rings})
    textures = {"uColor": color, "uPlanes": planes, "uSoft": median, "uTiles": tiles}
    (picture,) = draw(sources["ringgather"], size, textures, 1, ("uSoft",))
    stages = {"circle": planes[..., 0], "least": tiles[..., 0], "nearest": tiles[..., 1], "greatest": tiles[..., 2]}
    return stages | {"filtered": filtered, "rings": rings, "median": median}, picture[..., :3]


def interleaved_noise(height, width):
    """Where the centre of the taps is moved [distances of rings]: (h, w, 2). In float32 its digits would be lost."""
    y, x = np.arange(height)[:, None] + 0.5, np.arange(width) + 0.5

    def gradient(x, y):
        return np.modf(52.9829189 * np.modf(0.06711056 * x + 0.00583715 * y)[0])[0]

    turn, reach = 2.0 * np.pi * gradient(x, y), 0.5 * np.sqrt(gradient(5099.0 * x, 3499.0 * y))
    return np.stack([reach * np.cos(turn), reach * np.sin(turn)], axis=2).astype(np.float32)


def filament(draw, color, depth, coc, params, sources=SOURCES["filament"], settled=lambda gathered: gathered):
    """Stages from the halved picture to the median, and the picture. `settled` is what the median takes."""
    half = tuple(-(-side // 16) * 8 for side in coc.shape)
    tile_size = tuple(side // 8 for side in half)
    textures = {"uColor": color, "uCircle": coc}
    levels = draw(sources["filament_half"], half, textures, uLargest=params.largest_px)
    for k in (1, 2, 3):
        levels += draw(sources["filament_level"], tuple(side >> k for side in half), {"uFiner": levels[-1]})
    (tiles,) = draw(sources["tiles"], tile_size, {"uValues": levels[0]}, uChannels=(3, 3), uSide=8)
    for _ in range(2):
        (tiles,) = draw(sources["around"], tile_size, {"uTiles": tiles})
    textures = {"uHalf": levels, "uTiles": tiles, "uMoved": interleaved_noise(*half)}
    words = {"uPoints": ring_points(4, np.ones(4)), "uRings": params.rings}
    (gathered,) = draw(sources["filament_gather"], half, textures, **words)
    (median,) = draw(sources["median"], half, {"uPicture": settled(gathered), "uTiles": tiles}, uSide=8)
    textures = {"uColor": color, "uSoft": median, "uTiles": tiles}
    (picture,) = draw(sources["filament"], coc.shape, textures, 1, ("uSoft",))
    stages = {"half": levels[0], "least": tiles[..., 0], "greatest": tiles[..., 2]}
    return stages | {"gathered": gathered, "median": median}, picture[..., :3]


PORTS = {
    "hexagon": hexagon, "halfres": halfres, "circular": circular, "ringgather": ringgather, "filament": filament,
}  # fmt: skip
