"""Lens blur: a few layers that hide each other as the lens sees them, and lens rays traced through them.

1. Peel layers, each beyond the umbra of the one before                         `View.umbra_layers`
2. Pack them four by four, with N-buffers of their extremes                     `_stack`
3. Per pixel, cut all lens rays to the depths at which they can meet a layer    `refdof.methods.lensblur.footprint`
4. Walk each ray from texel to texel to the nearest surface                     `refdof.methods.lensblur.texel_walk`
5. Average what the rays meet                                                   `refdof.methods.lensblur.layer_trace`

Stages: "parallax" (N, H, W), inverse depth in px of parallax; "layer_count" (H, W), layers there are, stored or not;
"points" (K, R, 2), lens points, and "set" (n, n), which of the K sets each pixel of a tile takes; "near" and "far" (G,
H, W), the range of parallax left of each pack of four; "lowest" and "highest" (G, L, h, w), its N-buffers; "steps" (H,
W), texels walked per ray; "missed" (H, W), the share of rays that count as missed.

Departures from the paper
-------------------------
- The paper extends every silhouette pixel to its neighbours' centres. On all sides, that moves silhouettes outwards by
  half a pixel. Peeling needs less: only a ray that comes into a pixel from the side, below its sample and above a
  surface of the pixel before that lies inside the sample's umbra, can have passed a dropped surface or slipped through
  a slanted one. That ray meets the sample.
- The test of a texel is not given: here a ray meets a sample if it passes the sample's depth inside the texel.
- Rays that leave the picture are not spoken of. Here a ray is a miss if it ends outside the picture, comes into it
  behind its border's surfaces, or ends behind a full stack of layers; `misses` says what it counts. Other rays that
  meet nothing see the background.
- `filter="linear"` reads colours bilinearly inside one surface; "nearest" takes the sample, as the text has it.
- [1] states a fourth of the rays as enough to bound a footprint, and uses all; a thin lens needs none.
- "1/4th resolution" of the N-buffer with "a factor of four" in memory: half the resolution along each axis.
- Peeled layers come from exact ray casting, back faces included.
- The closed form of the footprint bounds a round lens. Texels on the rim of an image aperture have corners outside
  it; where such a point is drawn, all rays are bounded. Umbrae are those of the aperture's reach.
- A lens system's rays are those of points of the unit square that pass the lens; a pixel is as bright as their weights
  say, which 256 points know to half a percent. Umbrae are those of the thin lens with the same pupil.
- Places are computed in float32, to 2^-24 of the parallax: where that is some pixels (a very wide lens), what is in
  focus no longer is.

References
----------
.. [1] Lee, Eisemann & Seidel (2010), Real-Time Lens Blur Effects and Focus Control, ACM Transactions on Graphics 29(4).
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from refdof._check import Float, as_bool, as_choice, as_integer
from refdof.methods._contract import Method
from refdof.methods.lensblur.layer_trace import MISSES, Choices, Stack, Traced, new_stack, trace_layers
from refdof.optics.aperture import Aperture
from refdof.optics.lens_samples import PATTERNS, square_points
from refdof.optics.pixel_samples import JITTERS, LensPointSets, lens_point_sets
from refdof.optics.systems.spectrum import add_wave, channel_weights
from refdof.raster.rays.exact_layers import Layers
from refdof.raster.rays.gbuffer import gbuffer_of
from refdof.raster.rays.surfaces import Surfaces
from refdof.stages import StageRecorder
from refdof.view import View

__all__ = ["METHOD", "Params", "Prepared", "prepare", "render", "trace"]


PEELS = {"plain": 0, "umbra": 1, "extended": 2}  # extent of the blocker [px]
FOOTPRINTS = {"closed": 0, "rays": 1, "quarter": 4}  # every how many rays are bounded; 0: none
FILTERS = ("nearest", "linear")
_BLOCK = 2  # px, [1]: a quarter of the pixels
_FALL = 0.25  # px of parallax by which a dropped surface may be farther in the texel before; 0 leaves pinholes
_LARGEST = 1e30  # px of parallax: beyond it products leave float32


@dataclass(frozen=True)
class Params:
    """What the paper leaves open.

    Parameters
    ----------
    samples : int
        Lens rays per pixel, 1 .. 4096.
    layers : int
        Layers to store, 0 .. 1024; 0 takes as many as there are.
    peel : "extended", "umbra" or "plain"
        What a layer hides of the next: the umbra of a pixel that reaches its neighbours' centres (the paper's), of the
        pixel itself, or nothing but itself.
    jitter : one of `refdof.optics.pixel_samples.JITTERS`
    pattern : one of `refdof.optics.lens_samples.PATTERNS`
        Of the lens points; "halton" jitter always takes Halton.
    footprint : "closed", "rays" or "quarter"
        Bounds of a pixel's rays: closed form of the thin lens, the quad around all rays, or around every fourth, which
        may cut off rays.
    iterations : int
        How often rays are cut to the depths in their footprint, 0 .. 16; 0 leaves the N-buffers unused.
    misses : "renormalise", "black" or "pinhole"
        A missed ray is left out, is black, or sees what the pinhole sees.
    filter : "linear" or "nearest"
        How the colour of a hit is read.
    deferred : bool
        Shade every hit against its own ray, not the pinhole's.
    seed : int
        >= 0.
    """

    samples: int = 100  # [1], all figures
    layers: int = 4
    peel: str = "extended"
    jitter: str = "none"
    pattern: str = "vogel"
    footprint: str = "closed"
    iterations: int = 3  # [1]: a good trade-off
    misses: str = "renormalise"
    filter: str = "linear"
    deferred: bool = False
    seed: int = 0

    def __post_init__(self) -> None:
        for name, least, most in (("samples", 1, 4096), ("layers", 0, 1024), ("iterations", 0, 16)):
            object.__setattr__(self, name, as_integer(name, getattr(self, name), minimum=least, maximum=most))
        object.__setattr__(self, "seed", as_integer("seed", self.seed, minimum=0))
        for name, allowed in (
            ("peel", PEELS),
            ("jitter", JITTERS),
            ("pattern", PATTERNS),
            ("footprint", FOOTPRINTS),
            ("misses", MISSES),
            ("filter", FILTERS),
        ):
            as_choice(name, getattr(self, name), allowed)
        as_bool("deferred", self.deferred)


METHOD = Method(
    citation="lee2010",
    source="Lee, Eisemann, Seidel 2010",
    kind="layers",
    inputs=("triangles",),
    params=Params,
    promises=("constant", "pinhole", "focus", "convexity", "symmetry", "occlusion"),
    texture_reads=None,
    kernel=(1.01, 1.0),
    known_defects=(
        "Energy is not kept: rays that leave the picture do not count, and the others weigh more.",
        "Silhouettes near a surface behind them are extended.",
        "Places are float32: with a very wide lens what is in focus is not sharp.",
    ),
    paper={
        "filter": "nearest",  # Section 3.1: of the intersection found, "the corresponding color is retrieved"
    },
    tradeoff=("samples", (8, 16, 32, 64, 100, 200)),
)


def render(view: View, params: Params, recorder: StageRecorder) -> Float:
    """Render `view`: (H, W, 3) float32 linear RGB."""
    if view.lens.radius == 0.0:
        return view.pinhole().color
    scene = prepare(view, params)
    traced = trace(view, scene)
    extent, stack = PEELS[params.peel], scene.stack
    recorder.record("parallax", lambda: _parallax_of_layers(view, scene.layers))
    recorder.record("layer_count", lambda: view.surface_counts(extent))
    recorder.record("lowest", lambda: stack.lowest)
    recorder.record("highest", lambda: stack.highest)
    recorder.record("points", lambda: scene.pattern.points)
    recorder.record("set", lambda: scene.pattern.set)
    recorder.record("near", lambda: traced.near)
    recorder.record("far", lambda: traced.far)
    recorder.record("steps", lambda: traced.steps)
    recorder.record("missed", lambda: traced.missed)
    return traced.image


class Prepared(NamedTuple):
    """What rays are traced through and how: values (N, H, W, 3 or 13) are the layers' colours or attributes."""

    layers: Layers
    stack: Stack
    values: Float
    surfaces: Surfaces
    pattern: LensPointSets
    choices: Choices


def prepare(view: View, params: Params, dtype: npt.DTypeLike = np.float32) -> Prepared:
    """Steps 1 and 2, and the lens points; `dtype` is the type of places."""
    extent, count = PEELS[params.peel], params.layers or None
    layers = view.umbra_layers(count, extent) if extent else view.layers(count)
    name = f"{params.peel} {params.layers}"
    of_type = f"{name} {np.dtype(dtype).name}"
    stack = view.product(f"lensblur stack {of_type}", lambda: _stack(view, layers, params, dtype))
    values = layers.color
    if params.deferred:
        values = view.product(
            f"lensblur attributes {name}",
            lambda: gbuffer_of(view.surfaces(), view.projection(), layers.triangle, view.seen_through()),
        )
    mapped = view.ray_map() is not None
    aperture = Aperture.disc() if mapped else view.lens.aperture
    pattern = lens_point_sets(params.samples, aperture, params.jitter, params.pattern, params.seed)
    footprint = params.footprint
    if footprint == "closed" and np.hypot(*pattern.points.T).max() > 1.0 + 1e-12:  # but for roundings
        footprint = "rays"
    if mapped:  # no closed form; the map takes the unit square to its own aperture
        footprint = "rays" if footprint == "closed" else footprint
        pattern = pattern._replace(points=square_points(pattern.points))
    choices = Choices(FOOTPRINTS[footprint], params.iterations, params.misses, params.filter == "linear")
    return Prepared(layers, stack, values, view.surfaces(), pattern, choices)


def trace(view: View, scene: Prepared) -> Traced:
    """Steps 3 to 5, at every wavelength of a lens with dispersion; what is told of rays is of the middle one."""
    focus = float(_parallax(view, view.lens.focus_distance))
    given = scene.stack, scene.values, scene.surfaces, view.projection(), focus, scene.pattern, view.pinhole().color
    ray_map = view.ray_map()
    waves = 1 if ray_map is None else ray_map.waves
    middle = trace_layers(*given, scene.choices, ray_map, waves // 2)
    if waves == 1:
        return middle
    image = np.zeros(middle.image.shape)
    for wave, weights in enumerate(channel_weights(waves)):
        traced = middle if wave == waves // 2 else trace_layers(*given, scene.choices, ray_map, wave)
        add_wave(image, weights, traced.image)
    return middle._replace(image=image.astype(np.float32))


def _stack(view: View, layers: Layers, params: Params, dtype: npt.DTypeLike) -> Stack:
    """The layers packed, with N-buffers. Samples are extended as far as they hide others in peeling, and a little."""
    extent = PEELS[params.peel]
    extension = 0.5 * extent + _FALL if extent else 0.0
    return new_stack(_parallax_of_layers(view, layers, dtype), extension, params.layers == 0, _BLOCK)


def _parallax_of_layers(view: View, layers: Layers, dtype: npt.DTypeLike = np.float32) -> Float:
    """P E / depth (N, H, W) [px]; -inf where empty."""
    parallax = _parallax(view, layers.depth)
    parallax[layers.triangle < 0] = -np.inf
    return parallax.astype(dtype)


def _parallax(view: View, depth: Any) -> Float:
    """P E / depth [px], float64: how far apart two points of the lens, a radius apart, see a point."""
    with np.errstate(over="ignore"):
        return np.minimum(view.camera.pixels_per_tangent * view.lens.radius / np.asarray(depth), _LARGEST)
