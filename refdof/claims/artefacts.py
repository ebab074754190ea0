"""Measures on cards and patterns whose right pictures are known: leaks, steps, rings, blur widths, flicker."""

import math
import tracemalloc
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from scipy import ndimage, optimize

from refdof._check import Float
from refdof.claims.bench import Bench, params_of, preset_of
from refdof.claims.cards import Card, card_view, room_view, slanted_view
from refdof.methods import METHODS
from refdof.methods.mipmap.anisotropic import begin, downsample, new_chain
from refdof.rendering import make_params, render_view

__all__ = ["ARTEFACTS"]

Render = Mapping[str, Any]
_WIDE = 400.0  # px, beyond any picture


def _shown(render: Render, view: Any) -> Float:
    image = render_view(render["method"], view, preset=preset_of(render), **params_of(render)).image
    channel: Float = image[..., 0].astype(np.float64)
    return channel


def leak(_: Bench, renders: Mapping[str, Render]) -> float | dict[str, float]:
    """Light outside of a sharp white square of 24 px, over its own; behind it black is blurred by 8 px in radius.

    In truth there is none. Of a single render a number.
    """
    found = {}
    for name, render in renders.items():
        image = _shown(render, card_view([Card(0.0, 0.0, 12.0, 12.0, 0.0, 1.0)], (96, 72), 0.08))
        image[24:48, 36:60] = 0.0
        found[name] = float(image.sum()) / 24.0**2
    return found if len(found) > 1 else found[next(iter(found))]


def leak_ratio(bench: Bench, render: Render, beside: Render) -> float:
    """`leak` of one render over another's."""
    first, second = (leak(bench, {"it": of}) for of in (render, beside))
    assert isinstance(first, float)
    assert isinstance(second, float)
    return first / second


def leak_onto_focus(_: Bench, render: Render) -> float:
    """Light of a white background, 8 px in radius, on a sharp black half of the picture, over that half's area."""
    cards = [Card(-_WIDE, 0.0, _WIDE, _WIDE, 0.0, 0.0)]
    return float(_shown(render, card_view(cards, (96, 72), 0.08, 1.0))[:, :48].mean())


def edge_step(_: Bench, render: Render) -> float:
    """Largest difference of neighbours along a row through a black card, 10 px in radius, before a sharp white wall.

    A disc of that radius has 2 / (10 pi) = 0.064.
    """
    cards = [Card(0.0, 0.0, 24.0, _WIDE, -10.0, 0.0), Card(0.0, 0.0, _WIDE, _WIDE, 0.0, 1.0)]
    return float(np.abs(np.diff(_shown(render, card_view(cards, (128, 64), 0.2))[32])).max())


def step_ratio(bench: Bench, rough: Sequence[Render], smooth: Sequence[Render]) -> float:
    """The least `edge_step` of some renders over the greatest of others."""
    return min(edge_step(bench, render) for render in rough) / max(edge_step(bench, render) for render in smooth)


def ring(_: Bench, render: Render) -> float:
    """How far a white plane, slanted through the focal plane before black, falls below white inside the picture."""
    return 1.0 - float(_shown(render, slanted_view(6.0, (96, 48), 0.4, 1.0, 0.0))[12:-12, 16:-16].min())


def ring_ratio(bench: Bench, render: Render, beside: Render) -> float:
    """`ring` of one render over another's."""
    return ring(bench, render) / ring(bench, beside)


def slipped(_: Bench, render: Render, rooms: int) -> float:
    """Share of the pixels of closed rooms with boxes in them that see light from outside."""
    return float(np.mean([np.mean(_shown(render, room_view(seed, (64, 48), 0.02)) > 1.001) for seed in range(rooms)]))


def white_furnace(_: Bench, render: Render) -> float:
    """Largest deviation from white where all cards and the background are white."""
    cards = [Card(-8.0, 3.0, 10.0, 9.0, -6.0, 1.0), Card(12.0, 0.0, 9.0, 20.0, 0.0, 1.0)]
    return float(np.abs(_shown(render, card_view(cards, (64, 48), 0.2, 1.0)) - 1.0).max())


def shares_of_discs(_: Bench) -> float:
    """Sum of the shares that pixels give to those which their discs cover, all inside the picture, over the pixels."""
    cards = [Card(x, y, 7.0, 7.0, c, 1.0) for x, y, c in ((-14.0, 0.0, -3.0), (6.0, 4.0, -5.0), (10.0, -12.0, -1.5))]
    cards.append(Card(0.0, 0.0, _WIDE, _WIDE, 0.0, 1.0))
    shares = render_view("scatter", card_view(cards, (64, 48), 0.2), True).stages["shares"]
    return float(shares.sum()) / shares.size


def order_of_passes(bench: Bench, shot: Mapping[str, Any]) -> float:
    """What it changes whether the separable filter goes along x or y first: root mean square of linear light."""
    view, separable = bench.view(shot), METHODS["separable"]
    color, depth = view.pinhole()
    parts = color, depth, view.coc_px()
    first = separable.blur(*parts)
    turned = separable.blur(*(np.ascontiguousarray(np.swapaxes(part, 0, 1)) for part in parts))
    return float(np.sqrt(np.mean((first - np.swapaxes(turned, 0, 1)) ** 2)))


def blur_width(_: Bench, radius: float) -> float:
    """Standard deviation of mipmap's blur of a vertical edge over the diameter of its circle of confusion.

    The circle has a radius of `radius` [px]; the mean of eight places of the edge.
    """
    depth, coc = np.full((128, 128), 2.0), np.full((128, 128), radius)
    found = []
    for place in range(60, 68):
        color = np.where(np.arange(128) < place, 0.0, 1.0)[None, :, None] * np.ones((128, 1, 3))
        spread = np.diff(METHODS["mipmap"].blur(color, depth, coc)[64, :, 0])
        x = np.arange(127)
        found.append(math.sqrt(float((spread * (x - (spread * x).sum()) ** 2).sum())))
    return float(np.mean(found)) / (2.0 * radius)


def _gaussian_levels(image: Float, last: int) -> list[Float]:
    """Mip levels 0 .. last of an image (H, W, 3), by the method's 3 x 3 Gaussian, nothing left out."""
    height, width = image.shape[:2]
    colors, circles = (new_chain((height, width, channels), last, image.dtype) for channels in (4, 2))
    begin(image, np.zeros((height, width), image.dtype), colors.level(0), circles.level(0))
    for k in range(last):
        downsample(colors.level(k), circles.level(k), math.inf, colors.level(k + 1), circles.level(k + 1))
    return [colors.level(k)[..., :3] for k in range(last + 1)]


def _magnified(level: Float, size: tuple[int, int]) -> Float:
    """A level (h, w) read bilinearly at the pixels of the picture."""
    places = np.meshgrid(
        *((np.arange(n) + 0.5) * m / n - 0.5 for n, m in zip(size, level.shape, strict=True)), indexing="ij"
    )
    magnified: Float = ndimage.map_coordinates(level, places, order=1, mode="nearest")
    return magnified


def level_deviation(bench: Bench, shots: Sequence[Mapping[str, Any]], last: int) -> float:
    """Deviation of the Gaussian most like a magnified mip level m, over the printed 1.5 2^(m - 1); the mean.

    Over levels 1 .. last and shots; like means the least root of the mean squared error, of grey values.
    """
    ratios = []
    for shot in shots:
        grey = bench.view(shot).pinhole().color.mean(axis=-1, dtype=np.float64)
        levels = _gaussian_levels(np.repeat(grey[..., None], 3, axis=-1), last)
        for m in range(1, last + 1):
            magnified = _magnified(levels[m][..., 0], grey.shape)

            def error(sigma: float, magnified: Float = magnified, grey: Float = grey) -> float:
                return float(np.mean((ndimage.gaussian_filter(grey, sigma, mode="nearest") - magnified) ** 2))

            printed = 1.5 * 2.0 ** (m - 1)
            best = optimize.minimize_scalar(error, bounds=(0.3 * printed, 2.0 * printed), method="bounded")
            ratios.append(float(best.x) / printed)
    return float(np.mean(ratios))


def jaggedness(_: Bench, radius: float) -> float:
    """How much an oblique edge strays from its line after mipmap's blur, over that of the bilinearly magnified level.

    Root mean square, along the edge, of where it crosses half of the contrast; `radius` of the circle [px].
    """
    y, x = np.mgrid[:128, :128]
    edge = np.clip(x - 64.0 - 0.3 * (y - 64.0) + 0.5, 0.0, 1.0)
    color = np.repeat(edge[..., None], 3, axis=-1)
    ours = METHODS["mipmap"].blur(color, np.full((128, 128), 2.0), np.full((128, 128), radius))[..., 0]
    level = 1.0 + math.log2(2.0 * radius / 3.0)
    levels = _gaussian_levels(color, math.ceil(level))
    near, far = (_magnified(levels[k][..., 0], edge.shape) for k in (int(level), math.ceil(level)))
    return _straying(ours) / _straying(near + (level - int(level)) * (far - near))


def _straying(image: Float) -> float:
    """Root mean square distance along x of the half contrast from its straight line, in rows away from the border."""
    rows = np.arange(40, 88)
    left = np.argmax(image[rows] > 0.5, axis=1) - 1
    low, high = image[rows, left], image[rows, left + 1]
    place = left + (0.5 - low) / (high - low)
    line = np.polyval(np.polyfit(rows, place, 1), rows)
    return float(np.sqrt(np.mean((place - line) ** 2)))


def flicker(bench: Bench, shot: Mapping[str, Any], renders: Mapping[str, Render]) -> float | dict[str, float]:
    """How much a picture changes where all that a method sees moves by whole pixels: root mean square of linear light.

    The pinhole's picture, depth and circles are moved by 1 .. 7 px; a filter that treats all pixels alike gives the
    same picture, moved. Of a single render a number.
    """
    view = bench.view(shot)
    color, depth = view.pinhole()
    coc = view.coc_px()
    reach = int(5 * np.abs(coc).max()) + 8
    found = {}
    for name, render in renders.items():
        method = METHODS[render["method"]]
        params = make_params(render["method"], params_of(render), preset_of(render))

        def seen(shift: int, method: Any = method, params: Any = params) -> Float:
            window = np.s_[:, shift : shift + color.shape[1] - 8]
            parts = (np.ascontiguousarray(part[window]) for part in (color, depth, coc))
            image = method.blur(*parts, params).astype(np.float64)
            inner: Float = image[:, reach - shift : color.shape[1] - 8 - reach - shift]
            return inner

        still = seen(0)
        squares = [np.mean((seen(shift) - still)[reach // 2 : -reach // 2] ** 2) for shift in range(1, 8)]
        found[name] = float(np.sqrt(np.mean(squares)))
    return found if len(found) > 1 else found[next(iter(found))]


def flicker_ratio(bench: Bench, shot: Mapping[str, Any], renders: Sequence[Render], beside: Render) -> float:
    """The least `flicker` of some renders over that of another."""
    names = {str(k): render for k, render in enumerate([beside, *renders])}
    found = flicker(bench, shot, names)
    assert isinstance(found, dict)
    first = found.pop("0")
    return min(found.values()) / first


def spiral_error(_: Bench, scales: Sequence[float], circle: float) -> dict[str, float]:
    """Error of the single pass by RAD_SCALE: root mean square difference from one with 0.05, random pixels."""
    random = np.random.default_rng(3)
    color, depth, coc = random.random((48, 48, 3)), np.full((48, 48), 2.0), np.full((48, 48), circle)
    single = METHODS["singlepass"]

    def picture(scale: float) -> Float:
        image: Float = single.blur(color, depth, coc, single.Params(rad_scale=scale))
        return image

    dense = picture(0.05)
    return {f"{scale:g}": float(np.sqrt(np.mean((picture(scale) - dense) ** 2))) for scale in scales}


def background_share(_: Bench, factors: Sequence[float]) -> dict[str, float]:
    """Light of a white background in the middle 8 px of a black card of 16, blurred by 4 px, by the clamp's factor."""
    found = {}
    for factor in factors:
        view = card_view([Card(0.0, 0.0, 8.0, _WIDE, -4.0, 0.0)], (96, 48), 0.15, 1.0)
        image = _shown({"method": "singlepass", "behind_factor": factor}, view)
        found[f"{factor:g}"] = float(image[12:36, 44:52].mean())
    return found


def memory_growth(_: Bench, radius_factor: float) -> float:
    """Peak memory of cascaded with a lens so many times wider, which needs more layers, over that before."""
    cards = [Card(x, 0.0, 12.0, _WIDE, c, 1.0) for x, c in ((-40.0, -4.0), (0.0, -1.0), (40.0, 3.0))]
    peaks = []
    for factor in (1.0, radius_factor):
        view = card_view(cards, (160, 120), 0.4)
        view = view.with_lens(type(view.lens)(view.lens.radius * factor, 1.0))
        render_view("cascaded", view)
        tracemalloc.start()
        render_view("cascaded", view)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    return peaks[1] / peaks[0]


ARTEFACTS: dict[str, Any] = {
    function.__name__: function
    for function in (
        leak, leak_ratio, leak_onto_focus, edge_step, step_ratio, ring, ring_ratio, slipped, white_furnace,
        shares_of_discs, order_of_passes, blur_width, level_deviation, jaggedness, flicker, flicker_ratio, spiral_error,
        background_share, memory_growth,
    )
}  # fmt: skip
