"""Multiview synthesis: every pixel sends rays from the lens through a scene that was drawn once, as layers of depth.

1. Decompose the scene into layers evenly spaced in circle of confusion    `refdof.methods.multiview.decomposition`
2. Colour them, or store what is needed to shade them later                `_surface`
3. Choose lens points for every pixel                                      `refdof.optics.pixel_samples`
4. Skip the layers that no ray of a pixel can meet                         `refdof.methods.multiview.fields.visit`
5. Follow each ray front to back, from texel to texel or by false position  `refdof.methods.multiview.height_field`,
   `next_hit`
6. Average what the rays hit, or blend it along cones                      `gather`, `cones`

Stages, with K layers that are not empty out of L, S depth buffers of the first pass, N lens points, c in px:
"bounds" (L + 1,) c; "source_coc", "source_triangle" (S, H, W): first pass; "layer_number" (K,); "layer_interval" (K, 2)
c; "layer_coc" (K, H, W), inf: empty; "layer_triangle" (K, H, W), -1: empty; "layer_surface" (K, H, W, 3 or 13):
linear RGB or attributes (`refdof.raster.rays.gbuffer`); "culled" (K, H, W); "lens_points" (sets, N, 2),
"lens_weights" (sets, N), "lens_set" (h, w), repeated over the image; "hit_layer" (H, W, N), -1: background, -2: leaves
the image;
"hit_texel" (H, W, N): row * W + column; "hit_coc" (H, W, N) c; "ambiguous" (H, W, N):
`refdof.methods.multiview.ambiguous_rays`. With cones: "mip_texels" (K, T, C + 2), "mip_closed" (K, T, C + 1),
"mip_levels" (M, 3), and hits are the first ones of the cones' middle rays.

Departures from the paper
-------------------------
- Decomposition: see `refdof.methods.multiview.decomposition`.
- r = C v of Eq. (3) is on the inverted image of the sensor. On the upright one a ray passes p - c v.
- Heights are circles of confusion, not depths: a ray is a straight line in them, and false position assumes lines.
- False position misses surfaces that slant out of the layer before the ray's end: an opaque plane may leak. Layers are
  narrow, so that a walk over every texel under the ray looks at about as many of them, and misses none: the default.
- The text stops after three steps and names no tolerance. Heights are those of the nearest texel, so a hit is exact
  as soon as the ray is inside the texel where it has that height; no tolerance is needed.
- "If d < d^, there is a surface intersection before reaching I" makes every object as thick as its layer: a ray that
  passes behind its edge hits it, too. Here it does so where the surface of the texel before goes on in the object's, at
  most `wall_px` farther: 1 px, by which a plane changes that the whole lens sees. `wall_px=inf` is the text.
- A layer keeps no surface behind its nearest one: past an edge, rays would fall through. Here the surface from above
  which the ray came goes on there. With it one layer degrades gently, as in figure 10.
- With walls the part of a ray in a layer is `wall_px` longer, since its surfaces may go on in the next layer.
- An empty texel is far while the search steps forward: it does not block. Only at the far end does it count as near.
- After the steps the far end decides: if its texel blocks the ray, the search halves on, else the layer is missed.
- What rays see that hit no layer is not said: the scene's background.
- Rays that leave the image see its border ("clamp"): nearer to the truth on all built-in scenes. The text drops
  them ("discard"): here at the first layer in which they do, unless the layer has nothing within the pixel's reach;
  others weigh more, and a pixel that loses all shows the pinhole's colour.
- Cones are the default, and Vogel's points, the same for all pixels: what aliasing cones leave is nearer to the
  reference than the noise that jitter turns it into.
- Culling tests blocks of 4 x 4 px and a window of one more px than the circle of confusion; the printed size of the
  N-buffer's windows lost its exponent.
- lambda: "mean distance among the lens samples" and "half the distance to its neighbouring rays" would make cones
  twice as wide as the printed 0.137 for 32 points, which is half of the mean distance to the nearest neighbour of 32
  Poisson-disc points. `cones="paper"` is the printed one, `cones="text"` the other.
- Cones read mip levels of `glGenerateMipmap`, trilinearly; at less than one texel, the finest.
- Cones do not blend a fragment a second time from the layer that it was copied to, and cones whose middle meets a
  surface are not cut where it goes on in the next layer (unless walls are infinite): see `cones`.
- "Distinct" pairs of a noise texel are twelve; the sixteen of the text include a number with itself.

References
----------
.. [1] Lee, Eisemann & Seidel (2009), Depth-of-Field Rendering with Multiview Synthesis, ACM Transactions on
   Graphics 28(5).
"""

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float, InputError, as_bool, as_choice, as_integer, as_number
from refdof.methods._contract import Method
from refdof.methods.multiview.cones import FOOTPRINT, MipChain, chain_of, gather_cones
from refdof.methods.multiview.decomposition import Decomposition, Sources, decompose
from refdof.methods.multiview.fields import Fields, Search, fields_of
from refdof.methods.multiview.gather import gather, record_rays
from refdof.optics.lens_samples import PATTERNS, lens_samples
from refdof.optics.pixel_samples import JITTERS, LensPointSets, lens_point_sets, mean_nearest_distance
from refdof.raster.rays.gbuffer import GBUFFER_CHANNELS, gbuffer_of
from refdof.raster.rays.layer_color import colors_of
from refdof.stages import StageRecorder
from refdof.view import View

__all__ = [
    "CONES", "LEAST_SPACING", "METHOD", "OFFSCREEN", "SEARCHES", "SPACING", "SPACING_HEIGHT", "STARTS", "Params",
    "Prepared", "cone_width", "prepare", "render", "send_rays",
]  # fmt: skip


SEARCHES = ("false position", "march")
STARTS = ("ends", "middle")
OFFSCREEN = ("discard", "clamp")
CONES = ("none", "paper", "text")

SPACING, SPACING_HEIGHT = 3.0, 600  # Section 4.1: delta of 3 px at 800 x 600
LEAST_SPACING = 1.0  # px: walls reach as far


@dataclass(frozen=True)
class Params:
    """What the paper leaves open, and its numbers. Defaults are what comes nearest to the reference.

    Parameters
    ----------
    samples : int
        Lens points per pixel, 1 .. 4096.
    spacing_px : float, optional
        delta: growth of the circle of confusion per layer [px], > 0. None: the paper's 3 px for 600 rows, as much less
        as the picture has fewer rows (circles of confusion are smaller, too), and at least 1 px.
    layers : int, optional
        A budget: this many layers between near and far, whatever the spacing.
    overlap : float
        Share of the spacing by which layers overlap on each side, 0 .. 0.5.
    near, far : float, optional
        Planar depths of what is drawn [scene units]; None: the scene's own nearest and farthest.
    search : one of `SEARCHES`
        "march" looks at every texel under the ray: exact for heights of the nearest texel.
    start : one of `STARTS`
        Look up a layer's heights at both ends of the ray first; or in the middle, and at the ends only if that is
        empty: the text's "even more efficient".
    steps, bisections : int
        Of the search by false position: 1 .. 64 and 0 .. 64. "Three iterations are usually enough."
    wall_px : float
        How far the surface of the next texel under a ray may be nearer and still be the same surface [px of c], >= 0;
        inf is the text.
    culling : bool
        Skip layers early; changes no bit.
    offscreen : one of `OFFSCREEN`
        What rays do that leave the image: nothing, or see its border.
    jitter : one of `refdof.optics.pixel_samples.JITTERS`
    pattern : one of `refdof.optics.lens_samples.PATTERNS`
    cones : one of `CONES`
    view_dependent : bool
        Shade at the hit, along the lens ray, instead of in the layer, along the pinhole's.
    seed : int
        >= 0
    """

    samples: int = 64
    spacing_px: float | None = None
    layers: int | None = None
    overlap: float = 0.1
    near: float | None = None
    far: float | None = None
    search: str = "march"
    start: str = "ends"
    steps: int = 3
    bisections: int = 5
    wall_px: float = 1.0
    culling: bool = True
    offscreen: str = "clamp"
    jitter: str = "none"
    pattern: str = "vogel"
    cones: str = "paper"
    view_dependent: bool = False
    seed: int = 1

    def __post_init__(self) -> None:
        def settle(name: str, value: object) -> None:
            object.__setattr__(self, name, value)

        settle("samples", as_integer("samples", self.samples, minimum=1, maximum=4096))
        if self.spacing_px is not None:
            settle("spacing_px", as_number("spacing_px", self.spacing_px, above=0.0, maximum=1e30))
        if self.layers is not None:
            settle("layers", as_integer("layers", self.layers, minimum=1, maximum=4096))
        settle("overlap", as_number("overlap", self.overlap, minimum=0.0, maximum=0.5))
        if self.near is not None:
            settle("near", as_number("near", self.near, above=0.0))
        if self.far is not None:
            settle("far", as_number("far", self.far, above=0.0, finite=False))
        if self.near is not None and self.far is not None and not self.near < self.far:
            raise InputError(f"near: got {self.near:g} with far {self.far:g}; allowed is a number below far")
        as_choice("search", self.search, SEARCHES)
        as_choice("start", self.start, STARTS)
        settle("steps", as_integer("steps", self.steps, minimum=1, maximum=64))
        settle("bisections", as_integer("bisections", self.bisections, minimum=0, maximum=64))
        wall = as_number("wall_px", self.wall_px, minimum=0.0, finite=False)
        settle("wall_px", wall if wall < 1e30 else math.inf)  # float32 holds no more
        as_bool("culling", self.culling)
        as_bool("view_dependent", self.view_dependent)
        as_choice("offscreen", self.offscreen, OFFSCREEN)
        as_choice("jitter", self.jitter, JITTERS)
        as_choice("pattern", self.pattern, PATTERNS)
        as_choice("cones", self.cones, CONES)
        settle("seed", as_integer("seed", self.seed, minimum=0))


METHOD = Method(
    citation="lee2009multiview",
    source="Lee, Eisemann, Seidel 2009",
    kind="layers",
    inputs=("triangles",),
    params=Params,
    promises=("constant", "pinhole", "focus", "convexity", "symmetry", "occlusion"),
    texture_reads=None,
    kernel=(1.0, 1.0),
    known_defects=(
        "Energy is not kept: rays that leave the picture see its border.",
        "A layer keeps no surface behind its nearest one; what goes on there is guessed.",
    ),
    paper={
        "search": "false position",  # Section 4.3, Ray Traversal
        "wall_px": math.inf,  # Section 4.3: "if d < d^, there is a surface intersection before reaching I"
        "offscreen": "discard",  # Section 4.3: "discard all rays that leave the frustum"
        "jitter": "noise",  # Section 4.5, its last paragraph
        "pattern": "poisson",  # Section 4.3: "a Poisson disk sampling leads to an ideal distribution"
    },
    tradeoff=("samples", (8, 16, 32, 64, 128)),
)


def render(view: View, params: Params, recorder: StageRecorder) -> Float:
    """Render `view`: (H, W, 3) float32 linear RGB."""
    return send_rays(view, prepare(view, params, recorder))


class Prepared(NamedTuple):
    """What rays are sent through and how: colours or attributes of layers (K, H, W, 3 or 13), or a chain for cones."""

    layers: Decomposition
    surface: Float
    chain: MipChain | None
    pattern: LensPointSets
    widening: float
    fields: Fields
    search: Search
    background: Any


def prepare(view: View, params: Params, recorder: StageRecorder) -> Prepared:
    """Steps 1 to 3."""
    layers = _decomposition(view, params, recorder)
    surface = _surface(view, layers, params)
    recorder.record("layer_surface", lambda: surface)
    pattern = lens_point_sets(params.samples, view.lens.aperture, params.jitter, params.pattern, params.seed)
    recorder.record("lens_points", lambda: pattern.points)
    recorder.record("lens_weights", lambda: pattern.weights)
    recorder.record("lens_set", lambda: pattern.set)

    widening = 0.0 if params.cones == "none" else cone_width(view, params)
    largest = float(np.hypot(*pattern.points.T).max())
    fields = fields_of(layers.coc, layers.near, layers.far, largest, FOOTPRINT * widening, params.wall_px)
    search = Search(
        params.start == "middle",
        params.steps,
        params.bisections,
        params.wall_px,
        params.search == "march",
        bool(params.culling),
        params.offscreen == "discard",
    )
    record_rays(recorder, fields, pattern, search)
    chain: MipChain | None = None
    if params.cones != "none":
        chain = made = chain_of(surface, layers, widening, params.wall_px)
        recorder.record_all(lambda: {"mip_texels": made.texels, "mip_closed": made.closed, "mip_levels": made.level})
    return Prepared(layers, surface, chain, pattern, widening, fields, search, view.scene.background)


def send_rays(view: View, scene: Prepared) -> Float:
    """Steps 4 to 6: (H, W, 3) float32."""
    rays = scene.pattern, scene.search, view.projection(), view.surfaces(), scene.background
    if scene.chain is None:
        return gather(scene.fields, scene.surface, *rays)
    return gather_cones(scene.fields, scene.chain, scene.widening, *rays)


def cone_width(view: View, params: Params) -> float:
    """lambda: a cone's diameter over the circle of confusion's radius."""
    pattern = "halton" if params.jitter == "halton" else params.pattern
    points, _ = lens_samples(params.samples, pattern, params.seed, view.lens.aperture)
    return mean_nearest_distance(points) * (0.5 if params.cones == "paper" else 1.0)


def _decomposition(view: View, params: Params, recorder: StageRecorder) -> Decomposition:
    """Step 1: layers of the view."""
    choice = _choice(view, params)

    def build() -> tuple[Decomposition, Sources | None]:
        layers, sources = decompose(
            *view.triangles(),
            view.camera,
            view.lens,
            **choice,
            texel_bytes=_texel_bytes(params),
            cutouts=view.surfaces().cutouts,
        )
        return layers, sources if recorder.on else None  # as large as the layers, and not used again

    layers, sources = view.product(f"multiview layers {choice}{' and sources' if recorder.on else ''}", build)
    recorder.record("bounds", lambda: layers.bounds)
    recorder.record("source_coc", lambda: sources.coc)
    recorder.record("source_triangle", lambda: sources.triangle)
    recorder.record("layer_number", lambda: layers.layer)
    recorder.record("layer_interval", lambda: np.stack([layers.near, layers.far], axis=1))
    recorder.record("layer_coc", lambda: layers.coc)
    recorder.record("layer_triangle", lambda: layers.triangle)
    return layers


def _choice(view: View, params: Params) -> dict[str, Any]:
    """What the decomposition depends on besides the view."""
    return {
        "spacing": params.spacing_px or max(SPACING * view.camera.height / SPACING_HEIGHT, LEAST_SPACING),
        "count": params.layers,
        "overlap": params.overlap,
        "depths": (params.near, params.far),
    }


def _texel_bytes(params: Params) -> int:
    """Memory per texel of a layer: heights, triangles, search structures, colours or attributes, and their mipmaps."""
    channels = GBUFFER_CHANNELS if params.view_dependent else 3
    mipped = channels + 2 + (0 if params.wall_px == np.inf else channels + 1)
    return 20 + 4 * channels + (0 if params.cones == "none" else 11 * mipped)


def _surface(view: View, layers: Decomposition, params: Params) -> Float:
    """Step 2: colours (K, H, W, 3) or attributes (K, H, W, 13) of the layers."""
    make = gbuffer_of if params.view_dependent else colors_of
    return view.product(
        f"multiview {make.__name__} {_choice(view, params)}",
        lambda: make(view.surfaces(), view.projection(), layers.triangle, view.seen_through()),
    )
