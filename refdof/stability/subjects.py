"""Subjects: small pictures and scenes that cases are made of, as views that methods render.

A mosaic is a scene whose pinhole picture is given pixel by pixel: each pixel is a card of its own at its own depth, and
the cards of the border go on outside the picture. So every method can be given any picture. Colours that no scene may
have, and depths that no triangle should, are given as a frame instead, which has no triangles.

The camera stands at the origin and looks down -z, with `PIXELS` per unit tangent. A circle of confusion is
PIXELS E (1 / focus - 1 / depth) px.
"""

import math
from collections.abc import Sequence

import numpy as np

from refdof._check import Float, Index
from refdof.frame.frame import Frame
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens
from refdof.raster.rays.exact_layers import Layers
from refdof.scene.material import Material
from refdof.scene.scene import Part, Scene
from refdof.view import View

__all__ = ["PIXELS", "camera_of", "depth_of", "frame", "mosaic", "random_picture", "view_of_parts", "wall"]

PIXELS = 32.0
_BEYOND = 64.0  # px: how far the border's cards go on


def camera_of(size: tuple[int, int]) -> Camera:
    """The camera of a picture of (width, height) px."""
    fov_y = 2.0 * math.degrees(math.atan(size[1] / (2.0 * PIXELS)))
    return Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov_y=fov_y, size=size)


def depth_of(circle: float, lens: ThinLens) -> float:
    """The depth with a circle of confusion [px] before a lens of finite focus."""
    return 1.0 / (1.0 / lens.focus_distance - circle / (PIXELS * lens.radius))


def random_picture(seed: int, size: tuple[int, int], low: float = 0.1, high: float = 0.9) -> Float:
    """Colours (H, W, 3) float64 between two numbers."""
    width, height = size
    return low + (high - low) * np.random.default_rng(seed).random((height, width, 3))


def mosaic(
    color: Float, depth: Float, lens: ThinLens, background: Sequence[float] = (0.5, 0.5, 0.5), scale: float = 1.0
) -> View:
    """A view whose pinhole picture is `color` (H, W, 3) at `depth` (H, W); inf is the background.

    All lengths are multiplied by `scale`, also the lens's.
    """
    height, width = depth.shape
    camera = camera_of((width, height))
    x, y = np.arange(width + 1) - 0.5 * width, 0.5 * height - np.arange(height + 1)
    x[[0, -1]] += [-_BEYOND, _BEYOND]
    y[[0, -1]] += [_BEYOND, -_BEYOND]
    rows, columns = np.nonzero(np.isfinite(depth))
    d = depth[rows, columns]
    corners = [
        np.stack([x[columns + i] / PIXELS * d, y[rows + j] / PIXELS * d, -d], axis=1)
        for i, j in ((0, 1), (1, 1), (1, 0), (0, 0))
    ]
    count = len(d)
    first: Index = 4 * np.arange(count)[:, None]
    faces: Index = np.add(first[:, None], [[0, 1, 2], [0, 2, 3]]).transpose(1, 0, 2).reshape(-1, 3)
    vertices = np.stack(corners, axis=1).reshape(-1, 3)
    paint = np.repeat(color[rows, columns], 4, axis=0)
    part = Part(vertices * scale, faces, Material("unlit"), color=paint)
    if scale != 1.0:
        lens = ThinLens(lens.radius * scale, lens.focus_distance * scale, lens.aperture)
    return view_of_parts([part], camera.size, lens, background)


def view_of_parts(
    parts: Sequence[Part], size: tuple[int, int], lens: ThinLens, background: Sequence[float] = (0.5, 0.5, 0.5)
) -> View:
    """A view of parts of a scene."""
    camera = camera_of(size)
    red, green, blue = (float(c) for c in background)
    return View(Scene.from_parts("stability", list(parts), camera, lens, (red, green, blue)), camera, lens)


def wall(depth: float, color: Sequence[float], half: float = 200.0) -> Part:
    """An upright square at one depth, `half` px to each side of the picture's middle."""
    side = half * depth / PIXELS
    corners = np.array([[-side, -side, -depth], [side, -side, -depth], [side, side, -depth], [-side, side, -depth]])
    red, green, blue = (float(c) for c in color)
    return Part(corners, np.array([[0, 1, 2], [0, 2, 3]]), Material("unlit", base_color=(red, green, blue)))


def frame(
    color: Float, depth: Float, lens: ThinLens, background: Sequence[float] = (0.5, 0.5, 0.5), coc: Float | None = None
) -> View:
    """A view of a frame with one surface a pixel: no triangles. `coc`: circles instead of the lens's."""
    height, width = depth.shape
    camera, color = camera_of((width, height)), np.asarray(color, dtype=np.float32)
    seen = np.isfinite(depth)
    layers = Layers(
        np.where(seen[..., None], color, np.float32(0.0))[None],
        depth[None],
        np.zeros((1, height, width, 3), np.float32),
        np.where(seen, np.int32(0), np.int32(-1))[None],
    )
    red, green, blue = (float(c) for c in background)
    given = {"lens": lens, "layers": layers} if coc is None else {"coc": coc}
    return Frame(color, depth, camera, background=(red, green, blue), **given).view()
