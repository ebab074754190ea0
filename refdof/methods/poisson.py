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
from refdof._jit.texel_registers import blend_texels
from refdof.image.bilinear import texels_around
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
    code = _code(depth, coc, params).astype(color.dtype)
    coded = np.concatenate([color, code[..., None]], axis=-1)
    small = _shrink(coded)
    recorder.record("coc", lambda: coc)
    recorder.record("code", lambda: code)
    recorder.record("small", lambda: small)
    return _gather(coded, small, TAPS.astype(color.dtype), color.dtype.type(params.max_radius))


def _code(depth: Float, coc: Float, params: Params) -> Float:
    """Blur and its side in 0 .. 1: (H, W) float64."""
    circles = coc.astype(np.float64)
    if params.code == "thin_lens":
        return 0.5 + 0.5 * np.clip(circles / params.max_radius, -1.0, 1.0)
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
    low_height, low_width = small.shape[:2]
    flat, low_flat = coded.reshape(height * width, 4), small.reshape(low_height * low_width, 4)
    out = np.empty((height, width, 3), dtype=coded.dtype)
    for y in prange(height):
        sharp, soft, places = borrow(flat), borrow(low_flat), borrow(taps)
        scalar = coded.dtype.type
        half, one, two = scalar(0.5), scalar(1), scalar(2)
        right, down = scalar(low_width / width), scalar(low_height / height)
        for x in range(width):
            center = sharp[y * width + x, 3]
            radius = abs(two * center - one) * max_radius
            wide = radius * scalar(_SMALL_RADIUS * _SMALL)
            u, v = scalar(x) + half, scalar(y) + half
            red, green, blue, total = scalar(0), scalar(0), scalar(0), scalar(0)
            for k in range(len(places)):
                high = _read(sharp, u + places[k, 0] * radius, v + places[k, 1] * radius, height, width)
                low_u, low_v = (u + places[k, 0] * wide) * right, (v + places[k, 1] * wide) * down
                low = _read(soft, low_u, low_v, low_height, low_width)
                blend = abs(two * high[3] - one)
                code = high[3] + (low[3] - high[3]) * blend
                weight = one if code >= center else abs(two * code - one)
                red += weight * (high[0] + (low[0] - high[0]) * blend)
                green += weight * (high[1] + (low[1] - high[1]) * blend)
                blue += weight * (high[2] + (low[2] - high[2]) * blend)
                total += weight
            if total > scalar(0):
                out[y, x, 0], out[y, x, 1], out[y, x, 2] = red / total, green / total, blue / total
            else:
                for c in range(3):
                    out[y, x, c] = sharp[y * width + x, c]
    return out


@inline
def _read(texels, u, v, height, width):
    """A bilinear read at u, v [texels from the corner], clamped to the edge: a tuple of four."""
    x, x1, wx = texels_around(u, width)
    y, y1, wy = texels_around(v, height)
    first, second = y * width, y1 * width
    return blend_texels(texels, first + x, first + x1, second + x, second + x1, wx, wy)
