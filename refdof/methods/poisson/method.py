"""Poisson disc: some taps inside the blur, each between the picture and a small blurred copy of it.

1. Code depth as blur: 0 full in front, 1/2 sharp, 1 full behind             `coding.code_of`
2. Shrink picture and code to a quarter of their sides and blur them          `coding.shrink`
3. Gather twelve taps from both, less of those that are nearer and sharp      `gather.gather`

Stages: "coc" (H, W) px, "code" (H, W), "small" (h, w, 4): colour and code. As asked for, "mean K" (H, W, 3).

Departures from the paper
-------------------------
This is a **reconstruction**: the slides of [1] were not at hand, but its listing, as programs carry it. They do not
agree on the taps: `params.TAP_TABLES` has four that are in use. The twelve here begin at (-0.326, -0.406); [2] uses
twelve. Ports with another table blur otherwise: `taps`.

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

import numpy as np

from refdof._check import Float, as_instance
from refdof.image.channels import joined
from refdof.methods._contract import Method
from refdof.methods._image_validation import as_images, within
from refdof.methods.poisson.coding import code_of, depth_for_coding, shrink
from refdof.methods.poisson.gather import gather
from refdof.methods.poisson.params import TAPS, Params
from refdof.stages import Stage, Staged, StageRecorder, Stages, as_stages
from refdof.view import View

__all__ = ["METHOD", "Params", "blur", "coded_and_small", "render", "texture_reads"]


def texture_reads(params: Params, width: int, height: int) -> float:
    """Texture reads per pixel: taps in two textures, and nine for each of the small one's texels."""
    small = params.small_size
    return _units(max(1, width // small) * max(1, height // small) / (width * height), len(params.table))


STAGES = (
    Stage("coc", "H W", "px", "signed circle of confusion, a radius", "formula"),
    Stage("code", "H W", "", "blur and its side: 0 full in front, 1/2 sharp, 1 full behind", "formula"),
    Stage("small", "h w 4", "", "the small picture: linear RGB and code", "filter"),
    Stage("mean *", "H W 3", "", "linear RGB after so many taps, as if the loop ended there", "filter"),
)


METHOD = Method(
    citation="scheuermann2004",
    source="after Scheuermann 2004",
    kind="single image",
    inputs=("pinhole colour", "pinhole depth"),
    params=Params,
    promises=("constant", "pinhole", "focus", "convexity"),
    texture_reads=texture_reads,
    kernel=(1.46, 1.0),
    known_defects=(
        "Blur grows linearly with depth up to a fixed radius, not as the circle of confusion does.",
        "Worse than no blur on the scene `atrium`: in small pictures, up to 160x120, whose circles its 5 px exceed.",
        "Worse than no blur on the scene `fence`: its nearest surface is blurred in full, whatever its circle.",
        "The mirrored scene does not give the mirrored picture: the twelve taps are not symmetric.",
    ),
    basis="reconstruction",
    stages=STAGES,
    tradeoff=("max_taps", (2, 4, 8, 12)),
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
        Planar depth [any unit], > 0; inf is background. Not used where `code` is "thin_lens".
    coc : (H, W)
        Signed circle of confusion, radius [px]. Where `code` is "linear", only tells the focal plane, unless that is
        given.
    params : Params
    stages : bool or refdof.Stages
        Record stages, too: those that every run has, or also steps. It has no probes.

    Returns
    -------
    (H, W, 3) of the type of `color`; with stages a `Staged`, a pair of that and of the stages by name.

    Raises
    ------
    InputError
        If shapes disagree, an array is empty, a value is NaN, a colour or circle is infinite, or a depth is not
        above 0; or if a step is beyond the loop.
    """
    as_instance("params", params, Params)
    recorder = StageRecorder(as_stages(stages))
    return recorder.answer(_blur(*as_images(color, depth, coc), params, recorder))


def coded_and_small(color: Float, depth: Float, coc: Float, params: Params) -> tuple[Float, Float]:
    """Validated picture with its code (H, W, 4), and the small one of it (h, w, 4)."""
    coded = joined(color, code_of(depth, coc, params))
    return coded, shrink(coded, params.small_size)


def _units(small: float, taps: int = len(TAPS)) -> float:
    """Reads per pixel, if the small picture has a share `small` of the pixels."""
    return 2.0 * taps + 9.0 * small


def _blur(color: Float, depth: Float, coc: Float, params: Params, recorder: StageRecorder) -> Float:
    coded, small = coded_and_small(color, depth_for_coding(color.dtype.type, depth, params), coc, params)
    taps, reach = params.table.astype(color.dtype), params.small_radius * params.small_size
    recorder.record("coc", lambda: coc)
    recorder.record("code", lambda: coded[..., 3])
    recorder.record("small", lambda: small)
    for k in recorder.steps(len(taps)) if recorder.on else ():
        recorder.record(f"mean {k}", lambda k=k: gather(coded, small, taps[:k], params.max_radius, reach))  # type: ignore[misc]
    return gather(coded, small, taps, params.max_radius, reach)
