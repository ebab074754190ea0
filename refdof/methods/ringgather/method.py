"""Ring gather: rings of taps at half the size, sorted by depth into near and far; as in Wicked Engine.

1. Circles without sign, in pixels of half the size; least and greatest of tiles and of those around
                                                                                          `taken.taken`
2. Prefilter, and sort by depth: how much of a pixel's light is near        `prefilter.prefilter`
3. Sum taps that reach the pixel, near and far, and lay near over far       `gather.rings`
4. Median of nine                                                           `refdof.raster.filters.median`
5. Over the sharp picture, by circle                                        `upsample.upsampled`

Stages: "coc" px, "circle" px of half the size, (H, W) each; "nearest", "greatest", "least", (h, w) tiles with those
around; of half the size "filtered", "rings", "median", (h, w, 4), alpha last.

Departures from the paper
-------------------------
- The talk [1] gives the idea; constants are those of the engine [2].
- The engine's circle is no lens's: the picture's circles are taken, half as large since they are of half the size.
- Depth has the picture's unit, and three constants of the engine are in that unit: `foreground`, and the steps of 1/2
  and 1 that prefilter and last pass blend over. The nearest depth is not cut at the far plane; infinite is 1e30.
- The engine uses three of its table's four rings, so that taps reach 0.75 of the blur; `fill` mends it.
- The engine's newest form sums tone-mapped colours: `working`. Its curve was not at hand; this is c / (1 + max c).
- Half the size is rounded up. A texel of it reads circle and depth at the texel right below its centre.

References
----------
.. [1] Jimenez (2014), Next Generation Post Processing in Call of Duty: Advanced Warfare, SIGGRAPH Courses.
.. [2] Wicked Engine (2025), WickedEngine/shaders/depthoffield_*.hlsl.
"""

import numpy as np

from refdof._check import Float, as_instance
from refdof.methods._contract import Method
from refdof.methods._image_validation import as_images, depth_in_unit, within
from refdof.methods.ringgather.gather import rings
from refdof.methods.ringgather.params import TILE, Params, from_working, points, to_working
from refdof.methods.ringgather.prefilter import prefilter
from refdof.methods.ringgather.taken import taken
from refdof.methods.ringgather.upsample import upsampled
from refdof.raster.filters.median import median
from refdof.stages import Stage, Staged, StageRecorder, Stages, as_stages
from refdof.view import View

__all__ = ["METHOD", "Params", "blur", "render", "texture_reads"]


def texture_reads(params: Params, width: int, height: int) -> float:
    """Texture reads per pixel: at half the size 18 of prefilter, 98 of rings, nine of the median; 4 at the end."""
    return (18.0 + 98.0 + 9.0) / 4.0 + 4.0


METHOD = Method(
    citation="jimenez2014",
    source="Jimenez 2014, as in Wicked Engine 2025",
    kind="single image",
    basis="engine",
    inputs=("pinhole colour", "pinhole depth"),
    params=Params,
    promises=("pinhole",),
    texture_reads=texture_reads,
    kernel=(0.92, 0.97),
    known_defects=(
        "Taps reach three quarters of the blur: the kernel's RMS radius is 0.86 of the disc's.",
        "Circles have no sign: in focus over blurred cannot be told from blurred over in focus.",
        "Tiles show edges, and blur of more than a tile of 32 px leaks.",
        "Where hardly any tap is behind, near taps that do not cover a pixel are laid over black: dark seams.",
        "Taps are spread over the greatest blur around: pixels of less blur keep few, hence noise.",
        "From one pixel of half the size on, nothing of the sharp picture is left.",
        "The median takes small lights away: three quarters of one with a blur of 2 px, a third at 32 px.",
        "Near and far depend on the unit of depth.",
        "Circles of confusion are cut, by default at 32 px.",
    ),
    stages=(
        Stage("coc", "(H, W)", "px", "signed circle of confusion, radius", "formula"),
        Stage("circle", "(H, W)", "px of half the size", "radius, cut", "formula"),
        Stage("nearest", "(h, w)", "unit of depth", "nearest depth of a tile and of those around", "exact"),
        Stage("greatest", "(h, w)", "px of half the size", "greatest circle of them", "exact"),
        Stage("least", "(h, w)", "px of half the size", "least circle of them", "exact"),
        Stage("filtered", "(h, w, 4)", "linear RGB, 1", "prefiltered picture", "filter"),
        Stage("rings", "(h, w, 4)", "linear RGB, alpha", "sums over the rings", "filter"),
        Stage("median", "(h, w, 4)", "linear RGB, alpha", "median of nine of these", "filter"),
    ),
    paper={},
)


def render(view: View, params: Params, recorder: StageRecorder) -> Float:
    """Render `view`: (H, W, 3) float32 linear RGB."""
    pinhole, coc = view.pinhole(), within(np.float32, view.coc_px())
    return _blur(pinhole.color, pinhole.depth, coc, params, recorder)


def blur(
    color: Float, depth: Float, coc: Float, params: Params = Params(), stages: bool | Stages = False
) -> Float | Staged:
    """Blur a pinhole image.

    Parameters
    ----------
    color : (H, W, 3) float32 or float64
        Linear RGB; its type is the type of all arithmetic.
    depth : (H, W)
        Planar depth [the unit of `Params.foreground`], > 0; inf is background.
    coc : (H, W)
        Signed circle of confusion, radius [px].
    params : Params
    stages : bool or refdof.Stages
        Record stages, too.

    Returns
    -------
    (H, W, 3) of the type of `color`; with stages a `Staged`, a pair of that and of the stages by name.

    Raises
    ------
    InputError
        If shapes disagree, an array is empty, a value is NaN, a colour or circle is infinite, or a depth is not
        above 0.

    Notes
    -----
    Costs at most 49 taps for every four pixels, whatever the blur.
    """
    as_instance("params", params, Params)
    recorder = StageRecorder(as_stages(stages))
    return recorder.answer(_blur(*as_images(color, depth, coc), params, recorder))


def _blur(color: Float, depth: Float, coc: Float, params: Params, recorder: StageRecorder) -> Float:
    """`blur` after validation."""
    kind = color.dtype.type
    depth = depth_in_unit(kind, depth)
    texels, circle, nearest, greatest, least = taken(to_working(color, params.working), depth, coc, params.largest_px)
    taps, side = points(params.fill).astype(kind), TILE // 2
    margin = int(np.ceil(greatest.max() * np.abs(taps).max())) + 2
    planes = prefilter(texels, circle, nearest, taps, side, margin, params.foreground)
    summed = rings(planes, margin, greatest, least, side, taps, params.gain)
    smooth = median(summed)
    recorder.record("coc", lambda: coc)
    recorder.record("circle", lambda: circle)
    recorder.record("nearest", lambda: nearest)
    recorder.record("greatest", lambda: greatest)
    recorder.record("least", lambda: least)
    recorder.record("filtered", lambda: _picture_of(planes[:, :3, margin:-margin]))
    recorder.record("rings", lambda: summed)
    recorder.record("median", lambda: smooth)
    return upsampled(color, from_working(smooth, params.working), circle, depth, greatest, nearest, TILE)


def _picture_of(planes: Float) -> Float:
    """Rows of planes (h, 3, w) as a picture (h, w, 4), 1 last."""
    picture = np.ones((planes.shape[0], planes.shape[2], 4), dtype=planes.dtype)
    picture[..., :3] = np.moveaxis(planes, 1, -1)
    return picture
