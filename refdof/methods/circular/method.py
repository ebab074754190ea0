"""Circular: complex kernels along rows and then along columns, whose products sum up to a disc; Garcia's two passes.

1. Taps of each component, normalised so that a constant picture stays             `coefficients.kernels`
2. Along rows: real and imaginary colours, taps as far apart as the circle says    `passes.disc`
3. Along columns: complex products, weighed and summed to a colour                 `passes.disc`
4. With near and far fields: blur each apart and lay them over the picture         `_near_far`

Stages: "coc", (H, W) px; "parts" (H, W, 6n), of every component real and imaginary colours of the first pass.

Departures from the paper
-------------------------
- The paper prints one and two components; three to five are from its generator, whose four have a wrong sign in one
  number, reported and open: a spike of 12 plateaus in the middle. It is mended here; `misprinted` shows the damage.
- The paper's taps end at x = 1, a square cut; a later script goes on by a fifth, `transition`.
- The fitted disc is half as high at x = 1.10, so taps are spread to 1 / 1.10 radii. Ports spread them to the radius,
  which is 7 % too wide.
- The complex product's real and imaginary part are weighed as they are summed, which is the same sum.
- Targets of 8 and 10 bits, which the paper has a remedy for, are left out: colours keep their type.
- How near and far fields become a picture is not printed. `fields="near_far"` is a reconstruction after a published
  port: far taps that are in focus repeat the pixel, near circles are the nearest of tiles of 8 px and of those around,
  and fields replace the picture by as much as their circles have pixels, up to 1.

References
----------
.. [1] Garcia (2017), Circular Separable Convolution Depth of Field, SIGGRAPH Talks.
.. [2] Niemitalo (2010), Circularly Symmetric Convolution and Lens Blur, yehar.com.
"""

import numpy as np

from refdof._check import Float, as_instance
from refdof.methods._contract import Method
from refdof.methods._image_validation import as_images, within
from refdof.methods.circular.coefficients import RADIUS, Kernels, kernels
from refdof.methods.circular.params import Params
from refdof.methods.circular.passes import disc
from refdof.raster.filters.resize import resize
from refdof.raster.filters.tiles import tiles_of
from refdof.stages import Stage, Staged, StageRecorder, Stages, as_stages
from refdof.view import View

__all__ = ["METHOD", "Params", "blur", "render", "texture_reads"]

_TILE = 8  # px


def texture_reads(params: Params, width: int, height: int) -> float:
    """Texture reads per pixel: of colours in the first pass, of two parts of every component in the second."""
    reads = (2.0 * RADIUS + 1.0) * (1.0 + 2.0 * params.components)
    return reads if params.fields == "own" else reads + (2.0 * RADIUS + 1.0) * 3.0 + 2.0


METHOD = Method(
    citation="garcia2017",
    source="Garcia 2017, after Niemitalo 2010",
    kind="single image",
    inputs=("pinhole colour", "pinhole depth"),
    params=Params,
    promises=("constant", "pinhole", "focus", "symmetry"),
    texture_reads=texture_reads,
    kernel=(1.0, 1.0),
    known_defects=(
        "The disc ripples: by 8 % with two components, 23 % with one, 0.4 % with five; it is negative outside.",
        "Where circles vary there are streaks: the second pass reads columns that were blurred by their own circles.",
        "No depth is looked at: blurred things read what is sharp beside them.",
        "Taps end at a square cut, which shows in the corners of bright lights.",
        "Circles of confusion are cut, by default at 32 px; taps are then 4 px apart.",
    ),
    stages=(
        Stage("coc", "(H, W)", "px", "signed circle of confusion, radius", "formula"),
        Stage("parts", "(H, W, 6n)", "linear RGB", "real and imaginary colours after the first pass", "filter"),
    ),
    paper={"fitted_radius": 1.0},
    tradeoff=("components", (1, 2, 3, 4, 5)),
)


def render(view: View, params: Params, recorder: StageRecorder) -> Float:
    """Render `view`: (H, W, 3) float32 linear RGB."""
    return _blur(view.pinhole().color, within(np.float32, view.coc_px()), params, recorder)


def blur(
    color: Float, depth: Float, coc: Float, params: Params = Params(), stages: bool | Stages = False
) -> Float | Staged:
    """Blur a pinhole image.

    Parameters
    ----------
    color : (H, W, 3) float32 or float64
        Linear RGB; its type is the type of all arithmetic.
    depth : (H, W)
        Planar depth [any unit], > 0; inf is background. Only checked.
    coc : (H, W)
        Signed circle of confusion, radius [px].
    params : Params
    stages : bool or refdof.Stages
        Record stages, too.

    Returns
    -------
    (H, W, 3) of the type of `color`; with stages a `Staged`, a pair of that and of the stages by name. Where the
    kernel is negative, colours may be, too.

    Raises
    ------
    InputError
        If shapes disagree, an array is empty, a value is NaN, a colour or circle is infinite, or a depth is not
        above 0.

    Notes
    -----
    Costs 17 taps a pass, whatever the blur.
    """
    as_instance("params", params, Params)
    recorder = StageRecorder(as_stages(stages))
    color, _, coc = as_images(color, depth, coc)
    return recorder.answer(_blur(color, coc, params, recorder))


def _blur(color: Float, coc: Float, params: Params, recorder: StageRecorder) -> Float:
    """`blur` after validation."""
    recorder.record("coc", lambda: coc)
    if params.fields == "near_far":
        return _near_far(color, coc, params, recorder)
    return _disc(color, np.abs(coc), None, params.components, params, recorder)


def _disc(
    color: Float, circles: Float, reach: Float | None, components: int, params: Params, recorder: StageRecorder
) -> Float:
    """Both passes: circles (H, W) px; taps where reach (H, W) is 0 repeat the pixel."""
    kind = color.dtype
    cut = np.minimum(circles, kind.type(params.largest_px))
    spacing = cut * kind.type((1.0 + params.transition) / (params.fitted_radius * RADIUS))
    taps = Kernels(*(part.astype(kind) for part in kernels(components, params.transition, params.misprinted)))
    parts = np.empty((*circles.shape, components, 2, 3) if recorder.on else (0, 0, 0, 0, 0), dtype=kind)
    image = disc(color, spacing, taps, reach, parts)
    recorder.record("parts", lambda: parts.reshape(*circles.shape, -1))
    return image


def _near_far(color: Float, coc: Float, params: Params, recorder: StageRecorder) -> Float:
    """Far, then near field over the picture; the reconstruction."""
    kind = color.dtype.type
    behind = np.maximum(coc, kind(0))
    far = _disc(color, behind, behind, params.components, params, recorder)
    tiles = np.maximum(-tiles_of(coc, _TILE).dilated().least, kind(0))
    spread = np.zeros((*tiles.shape, 4), dtype=color.dtype)
    spread[..., 0] = tiles
    before = np.ascontiguousarray(resize(spread, *coc.shape)[..., 0])
    near = _disc(color, before, None, 1, params, StageRecorder())
    out = color
    for field, circles in ((far, behind), (near, before)):
        share = np.minimum(circles, kind(1))[..., None]
        out = out * (kind(1) - share) + field * share
    return out
