"""Measures on pictures of built-in scenes: scores against the reference, and what methods record of their work.

Shots and renders are tables as in `refdof.claims.bench`.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from scipy import ndimage

from refdof.claims.bench import Bench, params_of, preset_of
from refdof.methods.cascaded import Params as CascadedParams
from refdof.methods.cascaded import buffers_of, layering_of
from refdof.methods.lensblur.method import prepare as prepare_lensblur
from refdof.methods.multiview import method as multiview
from refdof.metrics import METRICS
from refdof.rendering import make_params, render_view
from refdof.stages import StageRecorder

__all__ = ["PICTURES"]

Shot = Mapping[str, Any]
Shots = Sequence[Shot]
Render = Mapping[str, Any]


def score(bench: Bench, shots: Shots, render: Render, metric: str = "psnr") -> float:
    """The mean score of a render over shots."""
    return float(np.mean([bench.score(shot, render, metric) for shot in shots]))


def gain(bench: Bench, shots: Shots, better: Render, worse: Render, metric: str = "psnr") -> float:
    """By how much one render scores more than another, the mean over shots."""
    return score(bench, shots, better, metric) - score(bench, shots, worse, metric)


def order(bench: Bench, shots: Shots, renders: Mapping[str, Render], metric: str = "psnr") -> dict[str, float]:
    """Scores of renders by name, the mean over shots."""
    return {name: score(bench, shots, render, metric) for name, render in renders.items()}


def order_of_shots(bench: Bench, shots: Mapping[str, Shot], render: Render, metric: str = "psnr") -> dict[str, float]:
    """Scores of a render by the name of the shot."""
    return {name: bench.score(shot, render, metric) for name, shot in shots.items()}


def gain_of_shot(bench: Bench, better: Shot, worse: Shot, render: Render, metric: str = "psnr") -> float:
    """By how much a render scores more on one shot than on another."""
    return bench.score(better, render, metric) - bench.score(worse, render, metric)


def share_of_gain(bench: Bench, shots: Shots, render: Render, low: Render, high: Render, metric: str = "psnr") -> float:
    """How far a render gets on the way from the score of `low` (0) to that of `high` (1)."""
    first, last = score(bench, shots, low, metric), score(bench, shots, high, metric)
    return (score(bench, shots, render, metric) - first) / (last - first)


def likeness(bench: Bench, shots: Shots, first: Render, second: Render, metric: str = "psnr") -> float:
    """The score of the second render with the first as reference, the mean over shots."""
    function = METRICS[metric].function
    return float(np.mean([function(bench.image(shot, first), bench.image(shot, second)) for shot in shots]))


def largest_difference(bench: Bench, shots: Shots, first: Render, second: Render, border: bool = False) -> float:
    """The largest difference of linear values of two renders; without what lies next to the picture's border.

    That is all within the largest circle of confusion, and a few pixels.
    """
    found = []
    for shot in shots:
        difference = np.abs(bench.image(shot, first).astype(np.float64) - bench.image(shot, second))
        reach = 0 if border else int(np.ceil(np.abs(bench.view(shot).coc_px()).max())) + 5
        inner = slice(reach, -reach or None)
        found.append(float(difference[inner, inner].max()))
    return max(found)


def grain(bench: Bench, shot: Shot, render: Render, beside: Render, blurred_px: int) -> float:
    """Grain of a render over that of another: fine differences from the reference where all around is much blurred."""
    blurred = ndimage.minimum_filter(bench.view(shot).coc_px(), size=2 * blurred_px + 1) > blurred_px

    def roughness(of: Render) -> float:
        error = bench.image(shot, of).astype(np.float64) - bench.truth(shot)
        fine = error - ndimage.gaussian_filter(error, (1.5, 1.5, 0.0))
        return float(np.sqrt(np.mean(fine[blurred] ** 2)))

    return roughness(render) / roughness(beside)


def texels_walked(bench: Bench, shots: Shots, render: Render, beside: Render) -> float:
    """Texels that rays of lensblur walk over, of one render over another, the mean over shots."""

    def steps(shot: Shot, of: Render) -> float:
        return float(bench.result(shot, of, stages=True).stages["steps"].mean())

    return float(np.mean([steps(shot, render) / steps(shot, beside) for shot in shots]))


def saved_share(bench: Bench, shots: Shots, render: Render, none: Render, all_of_it: Render) -> float:
    """Of the texels that lensblur could save, from `none` to `all_of_it`, the share that a render saves."""

    def steps(shot: Shot, of: Render) -> float:
        return float(bench.result(shot, of, stages=True).stages["steps"].mean())

    shares = [
        (steps(shot, none) - steps(shot, render)) / (steps(shot, none) - steps(shot, all_of_it)) for shot in shots
    ]
    return float(np.mean(shares))


def umbra_layers_of(bench: Bench, shots: Shots, extent: int = 2, occupied: float = 0.0) -> dict[str, float]:
    """Layers by scene that more than a share of the pixels need; extent 0 peels surfaces, 2 extended umbrae."""
    found = {}
    for shot in shots:
        counts = bench.view(shot).surface_counts(extent)
        shares = [float(np.mean(counts >= k)) for k in range(1, int(counts.max()) + 1)]
        found[shot["scene"]] = float(sum(share > occupied for share in shares))
    return found


def most_layers(bench: Bench, shots: Shots, extent: int = 2, occupied: float = 0.0) -> float:
    """The most of `umbra_layers_of`."""
    return max(umbra_layers_of(bench, shots, extent, occupied).values())


def layers_saved(bench: Bench, shots: Shots, occupied: float) -> float:
    """All layers of extended umbra peeling over those of plain peeling that stops at a share of the pixels."""
    plain, umbra = umbra_layers_of(bench, shots, 0, occupied), umbra_layers_of(bench, shots)
    return float(np.mean([umbra[name] / plain[name] for name in plain]))


def reopened_pixels(bench: Bench, shots: Shots) -> float:
    """Pixels that are empty in a peeled layer and filled in a later one."""
    filled = [bench.view(shot).umbra_layers(4).triangle >= 0 for shot in shots]
    return float(sum(np.count_nonzero(layers[1:] & ~layers[:-1]) for layers in filled))


def spaced_layers(bench: Bench, shots: Shots, spacing_px: float, most: int) -> float:
    """Share of shots that multiview decomposes into at most so many layers."""
    counts = []
    for shot in shots:
        render = {"method": "multiview", "samples": 1, "spacing_px": spacing_px, "cones": "none"}
        drawn = render_view("multiview", bench.view(shot), True, preset_of(render), **params_of(render))
        counts.append(len(drawn.stages["bounds"]) - 1)
    return float(np.mean([count <= most for count in counts]))


def values_held(bench: Bench, shot: Shot, render: Render, beside: Render) -> float:
    """Numbers that one method stores to trace rays in, layers, search structures and colours, over another's."""
    return _held(bench, shot, render) / _held(bench, shot, beside)


def _held(bench: Bench, shot: Shot, render: Render) -> int:
    view, params = bench.view(shot), make_params(render["method"], params_of(render), preset_of(render))
    if render["method"] == "lensblur":
        peeled = prepare_lensblur(view, params)
        stack = peeled.stack
        return peeled.values.size + stack.packs.size + stack.lowest.size + stack.highest.size
    drawn = multiview.prepare(view, params, StageRecorder())
    return drawn.surface.size + drawn.fields.coc.size + drawn.fields.lowest.size


def empty_layers(bench: Bench, shots: Shots, placements: Sequence[str]) -> dict[str, float]:
    """Depth layers of cascaded without any surface in their core, by placement, over all shots."""
    found = {}
    for placement in placements:
        params = CascadedParams(placement=placement)
        count = 0
        for shot in shots:
            view = bench.view(shot)
            _, depth = buffers_of(view, params)
            bounds = layering_of(depth, view.camera, view.lens, params).bounds
            places = np.searchsorted(bounds[1:-1], depth[~np.isnan(depth)])
            count += len(bounds) - 1 - len(np.unique(places))
        found[placement] = float(count)
    return found


PICTURES: dict[str, Any] = {
    function.__name__: function
    for function in (
        score, gain, order, order_of_shots, gain_of_shot, share_of_gain, likeness, largest_difference, grain,
        texels_walked, saved_share, most_layers, layers_saved, reopened_pixels, spaced_layers, values_held,
        empty_layers,
    )
}  # fmt: skip
