"""Poisson disc: twelve taps inside the blur, each between the picture and a small blurred copy of it.

1. Code depth as blur: 0 full in front, 1/2 sharp, 1 full behind             `_code`
2. Shrink picture and code to a quarter of their sides and blur them          `_shrink`
3. Gather twelve taps from both, less of those that are nearer and sharp      `_gather`

Stages: "coc" (H, W) px, "code" (H, W), "small" (h, w, 4): colour and code.

Departures from the paper
-------------------------
This is a **reconstruction**: the slides of [1] were not at hand, but its listing, as programs carry it. They do not
agree on the taps: at least four tables are in use, some of eight taps. The twelve here begin at (-0.326, -0.406); [2]
uses twelve. Ports with another table blur otherwise.

- Planes of full blur are left to the scene's author: here they are the nearest and the farthest surface in the picture,
  and the background is at full blur, however small their circles of confusion: worse than no blur on the scene `fence`,
  and on `atrium` in small pictures. The focal plane is where the line through the pixels of least and greatest circle
  of confusion, over inverse depth, crosses 0.
- `code="thin_lens"` takes the circle of confusion instead, for whoever wants to know what the rest of the method does.
- Colour and code are not rounded to 8 bits, but the code is cut as an 8-bit channel cuts it.
- Where all taps weigh nothing, which gives 0 / 0, the pixel keeps its colour.
- The quarter-size picture comes from the driver (2 x 2 means, twice). [2] prints its size as 1/16^2 of the pixels.

References
----------
.. [1] Scheuermann (2004), Advanced Depth of Field, Game Developers Conference (ATI Research).
.. [2] Lee, Kim, Choi (2009), Real-Time Depth-of-Field Rendering Using Anisotropically Filtered Mipmap Interpolation,
   IEEE Transactions on Visualization and Computer Graphics 15(3).
"""

from dataclasses import dataclass

import numpy as np

from refdof._check import Float, as_choice, as_instance, as_number
from refdof._jit import borrow, inline, kernel, prange
from refdof._jit.tap_registers import add_tap
from refdof.image.bilinear import first_of_two, four_around
from refdof.image.channels import joined
from refdof.methods._contract import Method
from refdof.methods._image_validation import as_images, depth_in_range, within
from refdof.raster.filters.mip_chain import box_mipmaps
from refdof.stages import StageRecorder
from refdof.view import View

__all__ = ["METHOD", "Params", "blur", "render", "texture_reads"]


TAPS = np.array(  # [1], unit disc, y down
    [
        (-0.326212, -0.40581),
        (-0.840144, -0.07358),
        (-0.695914, 0.457137),
        (-0.203345, 0.620716),
        (0.96234, -0.194983),
        (0.473434, -0.480026),
        (0.519456, 0.767022),
        (0.185461, -0.893124),
        (0.507431, 0.064425),
        (0.89642, 0.412458),
        (-0.32194, -0.932615),
        (-0.791559, -0.59771),
    ]
)
_SMALL = 4  # [1]: the small picture's texels are this many pixels wide
_SMALL_RADIUS = 0.4  # [1]: radius in its texels, of the radius in pixels
_PIECE = 256  # pixels of a row at a time: what is kept of them fits the nearest cache


@dataclass(frozen=True)
class Params:
    """What the listing leaves open.

    Parameters
    ----------
    code : "linear" or "thin_lens"
        Blur grows with distance from the focal plane [1], or as the circle of confusion does.
    max_radius : float > 0
        Radius of full blur [px]; [1] has 5.
    """

    code: str = "linear"
    max_radius: float = 5.0

    def __post_init__(self) -> None:
        as_choice("code", self.code, ("linear", "thin_lens"))
        object.__setattr__(self, "max_radius", as_number("max_radius", self.max_radius, above=0.0, maximum=65536.0))


def texture_reads(params: Params, width: int, height: int) -> float:
    """Texture reads per pixel: twelve taps in two textures, and nine for each of the small one's texels."""
    return _units(max(1, width // _SMALL) * max(1, height // _SMALL) / (width * height))


METHOD = Method(
    citation="scheuermann2004",
    source="after Scheuermann 2004",
    kind="single image",
    inputs=("pinhole colour", "pinhole depth"),
    params=Params,
    promises=("constant", "pinhole", "focus", "convexity"),
    texture_reads=texture_reads,
    known_defects=(
        "Blur grows linearly with depth up to a fixed radius, not as the circle of confusion does.",
        "Worse than no blur on the scene `atrium`: in small pictures, up to 160x120, whose circles its 5 px exceed.",
        "Worse than no blur on the scene `fence`: its nearest surface is blurred in full, whatever its circle.",
        "The mirrored scene does not give the mirrored picture: the twelve taps are not symmetric.",
    ),
    reconstruction=True,
)


def render(view: View, params: Params, recorder: StageRecorder) -> Float:
    """Render `view`: (H, W, 3) float32 linear RGB."""
    pinhole, coc = view.pinhole(), within(np.float32, view.coc_px())
    return _blur(pinhole.color, depth_in_range(pinhole.depth), coc, params, recorder)


def blur(color: Float, depth: Float, coc: Float, params: Params = Params()) -> Float:
    """Blur a pinhole image.

    Parameters
    ----------
    color : (H, W, 3) float32 or float64
        Linear RGB; its type is the type of all arithmetic.
    depth : (H, W)
        Planar depth [any unit], > 0; inf is background. Not used where `code` is "thin_lens".
    coc : (H, W)
        Signed circle of confusion, radius [px]. Where `code` is "linear", only tells the focal plane.
    params : Params

    Returns
    -------
    (H, W, 3) of the type of `color`.

    Raises
    ------
    InputError
        If shapes disagree, an array is empty, a value is NaN, a colour or circle is infinite, or a depth is not
        above 0.
    """
    return _blur(*as_images(color, depth, coc), as_instance("params", params, Params), StageRecorder())


def _units(small: float) -> float:
    """Reads per pixel, if the small picture has a share `small` of the pixels."""
    return 2.0 * len(TAPS) + 9.0 * small


def _blur(color: Float, depth: Float, coc: Float, params: Params, recorder: StageRecorder) -> Float:
    coded = joined(color, _code(depth, coc, params))
    small = _shrink(coded)
    recorder.record("coc", lambda: coc)
    recorder.record("code", lambda: coded[..., 3])
    recorder.record("small", lambda: small)
    return _gather(coded, small, TAPS.astype(color.dtype), color.dtype.type(params.max_radius))


def _code(depth: Float, coc: Float, params: Params) -> Float:
    """Blur and its side in 0 .. 1: (H, W) float64."""
    circles = coc.astype(np.float64)
    if params.code == "thin_lens":
        circles /= params.max_radius
        np.clip(circles, -1.0, 1.0, out=circles)
        circles *= 0.5
        circles += 0.5
        return circles
    least, greatest = np.unravel_index([circles.argmin(), circles.argmax()], circles.shape)
    least, greatest = np.transpose([least, greatest])
    if circles[tuple(least)] == circles[tuple(greatest)]:
        return 0.5 + 0.5 * np.sign(circles)
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        distance = depth.astype(np.float64)
        nearness = 1.0 / distance
        share = circles[tuple(least)] / (circles[tuple(least)] - circles[tuple(greatest)])
        # Over the focal distance, whose inverse may be 0: then all that is not at infinity is at full blur.
        focus = max(nearness[tuple(least)] * (1.0 - share) + nearness[tuple(greatest)] * share, 0.0)
        far = distance.max(initial=0.0, where=np.isfinite(distance))
        behind = np.where(np.isfinite(distance), (distance * focus - 1.0) / (far * focus - 1.0), 1.0)
        before = (distance * focus - 1.0) / (1.0 - distance.min() * focus)
    blurred = np.where(circles > 0, np.clip(behind, 0.0, 1.0), np.where(circles < 0, np.clip(before, -1.0, 0.0), 0.0))
    return 0.5 + 0.5 * np.nan_to_num(blurred, nan=0.0)


def _shrink(coded: Float) -> Float:
    """A quarter of each side, then a 3 x 3 Gaussian of weights 1, 2, 1: (h, w, 4)."""
    levels = box_mipmaps(coded)
    edged = np.pad(levels[min(2, len(levels) - 1)], ((1, 1), (1, 1), (0, 0)), mode="edge")
    quarter, half = coded.dtype.type(0.25), coded.dtype.type(0.5)
    rows = quarter * (edged[:-2] + edged[2:]) + half * edged[1:-1]
    return np.ascontiguousarray(quarter * (rows[:, :-2] + rows[:, 2:]) + half * rows[:, 1:-1])


@kernel
def _gather(coded, small, taps, max_radius):
    """The shader's loop: coded (H, W, 4), small (h, w, 4) -> (H, W, 3)."""
    height, width = coded.shape[:2]
    flat, low_flat = coded.reshape(height * width, 4), small.reshape(small.shape[0] * small.shape[1], 4)
    out = np.empty((height, width, 3), dtype=coded.dtype)
    for y in prange(height):
        sums, around = np.empty((_PIECE, 4), dtype=coded.dtype), np.empty((8, _PIECE), dtype=np.int64)
        weights, radii = np.empty((4, _PIECE), dtype=coded.dtype), np.empty(_PIECE, dtype=coded.dtype)
        work = (borrow(sums), borrow(around), borrow(weights), borrow(radii))
        pictures = (borrow(flat), borrow(low_flat))
        for first in range(0, width, _PIECE):
            row = borrow(out)[y, first : min(first + _PIECE, width)]
            _gather_piece(pictures, (height, width), small.shape, borrow(taps), max_radius, (first, y), work, row)
    return out


@inline
def _gather_piece(pictures, size, small_size, taps, max_radius, corner, work, out):
    """Pixels of a row from `corner` on: out (n, 3). Taps outside, pixels inside: loops over pixels vectorise."""
    (sharp, soft), (first, y), scalar = pictures, corner, out.dtype.type
    sums, radii, half, count = work[0], work[3], scalar(0.5), len(out)
    right, down = scalar(small_size[1] / size[1]), scalar(small_size[0] / size[0])
    for x in range(count):
        radii[x] = abs(scalar(2) * sharp[y * size[1] + first + x, 3] - scalar(1)) * max_radius
        for c in range(4):
            sums[x, c] = scalar(0)
    for k in range(len(taps)):
        around, weights, v = work[1], work[2], scalar(y) + half
        for x in range(count):
            u, radius = scalar(np.int32(first + x)) + half, radii[x]
            wide = radius * scalar(_SMALL_RADIUS * _SMALL)
            places = u + taps[k, 0] * radius, v + taps[k, 1] * radius
            _look(places, size, 0, around, weights, x)
            places = (u + taps[k, 0] * wide) * right, (v + taps[k, 1] * wide) * down
            _look(places, small_size, 4, around, weights, x)
        for x in range(count):
            near = around[0, x], around[1, x], around[2, x], around[3, x]
            far = around[4, x], around[5, x], around[6, x], around[7, x]
            shares, low_shares = (weights[0, x], weights[1, x]), (weights[2, x], weights[3, x])
            add_tap(sharp, near, shares, soft, far, low_shares, sharp[y * size[1] + first + x, 3], sums, x)
    for x in range(count):
        for c in range(3):
            total = sums[x, 3]
            out[x, c] = sums[x, c] / total if total > scalar(0) else sharp[y * size[1] + first + x, c]


@inline
def _look(places, size, n, around, weights, x):
    """Texels n .. n + 3 of pixel x, and their weights: around places[0], places[1] [texels from the corner]."""
    column, weights[n // 2, x] = first_of_two(places[0], size[1])
    row, weights[n // 2 + 1, x] = first_of_two(places[1], size[0])
    a, b, c, d = four_around(0, np.int32(size[1]), np.int32(size[0]), column, row)
    around[n, x], around[n + 1, x], around[n + 2, x], around[n + 3, x] = a, b, c, d
