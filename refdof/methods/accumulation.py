"""Accumulation: the average of pinhole views from points of the lens.

1. Choose lens points: one pattern for the whole picture, or one per pixel   `refdof.optics.owen_sobol`
2. See the scene from each of them, sheared to keep the focal plane in place  `refdof.truth.lens_rays`
3. Average                                                                  `refdof.truth.lens_rays`

Departures from the paper
-------------------------
- Views are ray cast, not rasterised: no vertex is snapped to a sub-pixel grid and no depth is rounded.
- The average is taken in float64; an accumulation buffer rounds every view.
- Lens points are a scrambled Sobol' net; the papers jitter a grid. Counts are rounded up to a power of two, where
  nets are balanced.
- Default is a pattern per pixel (Cook): its error is noise. `shared_pattern` is Haeberli and Akeley's: the same
  error shows as ghost edges. The two differ at few samples only.

References
----------
.. [1] Haeberli & Akeley (1990), The Accumulation Buffer: Hardware Support for High-Quality Rendering, SIGGRAPH.
.. [2] Cook, Porter & Carpenter (1984), Distributed Ray Tracing, SIGGRAPH.
"""

from dataclasses import dataclass

from refdof._check import Float, as_bool, as_integer
from refdof.methods._contract import Method
from refdof.stages import StageRecorder
from refdof.truth.reference import estimate
from refdof.truth.tile_sampler import Spend
from refdof.view import View

__all__ = ["METHOD", "Params", "render", "texture_reads"]


@dataclass(frozen=True)
class Params:
    """What the papers leave open.

    Parameters
    ----------
    samples : int
        Lens samples per pixel, 1 .. 2^20; rounded up to a power of two.
    shared_pattern : bool
        One pattern for all pixels [1] instead of one per pixel [2].
    seed : int
        0 .. 2^32 - 1.
    """

    samples: int = 64
    shared_pattern: bool = False
    seed: int = 1  # not the reference's default: the same points would share its error

    def __post_init__(self) -> None:
        as_bool("shared_pattern", self.shared_pattern)
        object.__setattr__(self, "samples", as_integer("samples", self.samples, minimum=1, maximum=2**20))
        object.__setattr__(self, "seed", as_integer("seed", self.seed, minimum=0, maximum=2**32 - 1))


def texture_reads(params: Params, width: int, height: int) -> float:
    """Texture reads per pixel: none, it traces rays."""
    return 0.0


METHOD = Method(
    citation="haeberli1990",
    source="Haeberli and Akeley 1990; Cook, Porter and Carpenter 1984",
    kind="reference views",
    inputs=("triangles",),
    params=Params,
    promises=("constant", "pinhole", "focus", "convexity", "energy", "symmetry", "occlusion"),
    texture_reads=texture_reads,
    kernel=(1.0, 0.92),
    known_defects=("With few samples its error is noise, or ghost edges where all pixels share one pattern.",),
    paper={
        "shared_pattern": True,  # [1]: every view is one point of the lens for the whole picture
    },
    tradeoff=("samples", (4, 8, 16, 32, 64, 128, 256)),
)


def render(view: View, params: Params, recorder: StageRecorder) -> Float:
    """Render `view`: (H, W, 3) float32 linear RGB."""
    spend = Spend(params.samples, None, params.samples)
    return estimate(view, 1, params.seed, spend, shared_pattern=params.shared_pattern).image
