"""Filament: tiles of half the size choose the taps; rings of background hide each other, near taps are laid over; as in
Google's Filament.

1. Halve the picture, bright colours less; the nearest of four circles; mip levels of both             `half.half_of`
2. Least and greatest circle of tiles of 8 texels, and of two tiles around                             `half.half_of`
3. Where all circles are alike, the mean of rings of taps                                           `alike.alike`
4. Else background: rings from outside in, of which nearer taps hide the outer ones            `background.background`
5. and foreground: near taps in two layers, over the background                                `foreground.foreground`
6. Median of nine                                                            `refdof.raster.filters.median`
7. Over the sharp picture, by alpha                                                          `combine.combined`

Stages: "coc" (H, W) px; of half the size, filled up to whole tiles: "half", "gathered", "median", (h, w, 4), circle or
alpha last; "least", "greatest", a number for every tile.

Departures from the paper
-------------------------
- The talk [1] gives the idea, [2] the foreground; steps and constants are the engine's [3].
- The engine's pictures have sides of multiples of 16; others are filled up here by repeating the edge.
- Colours and circles keep their type; the engine stores halves, opaque colours in 11 and 10 bits.
- Circles are cut at `largest_px`, the engine's 32; on phones it is 24 with three rings.
- The noise of the taps is made in float64: products of thousands of pixels lose all digits in float32 on some devices.
- A ring's distance from the pixel is that of its first tap, moved by the noise.
- Where nothing is blurred the engine writes the colour with alpha 0, which its last pass, reading bilinearly, adds
  once more at the border of a tile. Here nothing is written.

References
----------
.. [1] Abadie (2018), A Life of a Bokeh, SIGGRAPH Courses.
.. [2] Jimenez (2014), Next Generation Post Processing in Call of Duty: Advanced Warfare, SIGGRAPH Courses.
.. [3] Filament (2025), filament/src/materials/dof.
"""

from dataclasses import dataclass

import numpy as np

from refdof._check import Float, as_instance, as_integer, as_number
from refdof.methods._contract import Method
from refdof.methods._image_validation import as_images, within
from refdof.methods.filament.combine import NOT_BLURRED, combined, sorts_of
from refdof.methods.filament.gather import gather
from refdof.methods.filament.half import TILE, half_of, noise
from refdof.methods.filament.rings import MOST_RINGS
from refdof.raster.filters.median import median
from refdof.stages import Stage, Staged, StageRecorder, Stages, as_stages
from refdof.view import View

__all__ = ["METHOD", "Params", "blur", "render", "texture_reads"]


@dataclass(frozen=True)
class Params:
    """What ports change.

    Parameters
    ----------
    largest_px : float
        Circles of confusion are cut at this radius [px], 0 .. 32: tiles reach no farther.
    rings : int
        Rings of taps at most, the centre counted, 1 .. 5; the engine has 5, and 3 on phones.
    """

    largest_px: float = 32.0
    rings: int = MOST_RINGS

    def __post_init__(self) -> None:
        largest = as_number("largest_px", self.largest_px, minimum=0.0, maximum=32.0)
        object.__setattr__(self, "largest_px", largest)
        object.__setattr__(self, "rings", as_integer("rings", self.rings, minimum=1, maximum=MOST_RINGS))


def texture_reads(params: Params, width: int, height: int) -> float:
    """Texture reads per pixel where background and foreground meet: two gathers and a median at half the size."""
    return (2.0 * (2 * params.rings - 1) ** 2 + 9.0 + 4.0) / 4.0 + 3.0


METHOD = Method(
    citation="abadie2018",
    source="Abadie 2018, as in Filament 2025",
    kind="single image",
    basis="engine",
    inputs=("pinhole colour", "pinhole depth"),
    params=Params,
    promises=("constant", "pinhole", "focus"),
    texture_reads=texture_reads,
    kernel=(1.02, 0.54),
    known_defects=(
        "Silhouettes of things in focus are aliased: they are drawn at half the size beside blurred ones.",
        "The nearest of four circles makes near things fatter by a pixel.",
        "What a near thing hides is not filled in; with two depths behind it there are halos.",
        "The median takes lone small lights away, and, each channel apart, can give colours that were not there.",
        "A tap's light is cut by 2 texels of its level where their area would be 4.",
        "Noise of the taps shows where they are few.",
        "Circles of confusion are cut at 32 px.",
    ),
    stages=(
        Stage("coc", "(H, W)", "px", "signed circle of confusion, radius", "formula"),
        Stage("half", "(h, w, 4)", "linear RGB, px", "picture and nearest circle at half the size", "filter"),
        Stage("least", "(j, i)", "px", "least circle of a tile and of two around", "exact"),
        Stage("greatest", "(j, i)", "px", "greatest circle of them", "exact"),
        Stage("gathered", "(h, w, 4)", "linear RGB times alpha, alpha", "sums of the taps", "filter"),
        Stage("median", "(h, w, 4)", "linear RGB times alpha, alpha", "median of nine of these", "filter"),
    ),
    paper={},
    tradeoff=("rings", (2, 3, 4, 5)),
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
    (H, W, 3) of the type of `color`; with stages a `Staged`, a pair of that and of the stages by name.

    Raises
    ------
    InputError
        If shapes disagree, an array is empty, a value is NaN, a colour or circle is infinite, or a depth is not
        above 0.

    Notes
    -----
    Costs up to 162 taps for every four pixels, and nothing where nothing is blurred.
    """
    as_instance("params", params, Params)
    recorder = StageRecorder(as_stages(stages))
    color, _, coc = as_images(color, depth, coc)
    return recorder.answer(_blur(color, coc, params, recorder))


def _blur(color: Float, coc: Float, params: Params, recorder: StageRecorder) -> Float:
    """`blur` after validation."""
    half = half_of(color, coc, params.largest_px)
    moved = noise(half.finest.shape[0], half.finest.shape[1], color.dtype)
    gathered = gather(half.texels, half.places, half.tiles.least, half.tiles.greatest, moved, params.rings)
    smooth = median(gathered)
    sorts = sorts_of(half.tiles)
    _by_tile(smooth)[sorts == NOT_BLURRED] = 0
    recorder.record("coc", lambda: coc)
    recorder.record("half", lambda: half.finest)
    recorder.record("gathered", lambda: gathered)
    recorder.record("median", lambda: smooth)
    recorder.record("least", lambda: half.tiles.least)
    recorder.record("greatest", lambda: half.tiles.greatest)
    image: Float = combined(color, smooth, sorts, 2 * TILE)
    return image


def _by_tile(picture: Float) -> Float:
    """A view (h / 8, w / 8, 8, 8, 4) of (h, w, 4)."""
    height, width, channels = picture.shape
    return picture.reshape(height // TILE, TILE, width // TILE, TILE, channels).swapaxes(1, 2)
