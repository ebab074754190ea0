"""Motion: how much a method's picture flickers while the camera moves by less than a pixel.

The camera and what it looks at move to the right by 1/16 px of the focal plane per frame: what is in focus moves by
that, and a surface at depth d by focus / (16 d) px.

1. move the view                                          `moved_views`
2. find the pixels that no frame has sharp                `blurred_in_all`
3. render the reference twice, with independent noise     `_sequences`
4. render every method, and take second differences       `refdof.metrics.artefacts.flicker`

Of the reference, all frames have one seed: its noise then hardly changes from frame to frame, and most of it drops out
of the second differences. The second rendering has another.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import count
from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float, InputError, as_function, as_instance, as_integer
from refdof.compare import as_settings
from refdof.comparison import Comparison, Motion
from refdof.image.display import to_8_bit
from refdof.metrics.artefacts import ArtefactMaps, flicker
from refdof.rendering import make_params, render_view
from refdof.truth.reference import as_seed, reference_of_view, samples_taken
from refdof.view import View

__all__ = ["FRAMES", "MOST_FRAMES", "STEP_PX", "blurred_in_all", "flickers", "moved_views", "small_size", "with_motion"]

FRAMES = 16
MOST_FRAMES = 64  # of a comparison, which keeps the pictures of all
STEP_PX = 1.0 / 16.0  # of the focal plane, per frame
_LARGEST, _LEAST = (160, 120), 11  # px, of a comparison's frames: some thousand pixels do; the window of SSIM


class _Sequence(NamedTuple):
    """Frames (N, H, W, 3) of the reference or of a method, and their flicker."""

    name: str
    frames: Float
    flicker: float


def moved_views(view: View, frames: int = FRAMES) -> list[View]:
    """The view, and the same view moved to the right by `STEP_PX` more each time.

    Parameters
    ----------
    view : View
    frames : int
        3 .. 1000, the first one included.

    Raises
    ------
    InputError
        If the lens is focused at infinity, where nothing moves.
    """
    as_instance("view", view, View)
    frames = as_integer("frames", frames, minimum=3, maximum=1000)
    camera, focus = view.camera, view.lens.focus_distance
    if not np.isfinite(focus):
        raise InputError("view: got a lens focused at infinity; allowed is a finite focus distance")
    step = camera.rotation[0] * (STEP_PX * focus / camera.pixels_per_tangent)
    moved = []
    for k in range(frames):
        eye, target = (tuple((np.asarray(place) + k * step).tolist()) for place in (camera.eye, camera.target))
        moved.append(View(view.scene, replace(camera, eye=eye, target=target), view.lens))
    return moved


def blurred_in_all(views: Sequence[View]) -> np.typing.NDArray[np.bool_]:
    """Pixels that are sharp in no view: (H, W). See `ArtefactMaps.sharp`: blur in front of them counts, too."""
    return np.logical_and.reduce([~ArtefactMaps(view.pinhole().depth, view.coc_px()).sharp for view in views])


def small_size(size: tuple[int, int]) -> tuple[int, int]:
    """The size [px] of a comparison's frames: the picture's own, or made smaller to fit in 160 x 120.

    No side is made smaller than 11 px.
    """
    share = min(1.0, *(most / side for most, side in zip(_LARGEST, size, strict=True)))
    width, height = (max(round(share * side), min(side, _LEAST)) for side in size)
    return width, height


def with_motion(
    comparison: Comparison,
    views: Sequence[View],
    samples: int,
    reference: Callable[[View, int], Float],
    progress: Callable[[int, int], None],
) -> Comparison:
    """The comparison with the flicker of each row, and the frames that show it.

    `views` are of `moved_views`, and may be smaller than the comparison's pictures. `reference(view, other)` makes the
    reference of a view with `samples` samples per pixel; the one with `other` = 1 has another seed than that with 0.
    """
    rows = [(row.name, row.method, row.preset, row.params) for row in comparison.rows]
    done, steps = count(), (2 + len(rows)) * len(views)
    region = blurred_in_all(views)
    pictures, strips, found, shown = {}, {}, {}, 0
    for name, frames, value in _sequences(views, region, rows, reference, lambda *_: progress(next(done), steps)):
        if name == "reference":
            shown = _liveliest_row(frames, region)
        pictures[name] = np.stack([to_8_bit(frame) for frame in frames])
        strips[name] = frames[:, shown].astype(np.float32)
        found[name] = value
    moved = Motion(STEP_PX, samples_taken(samples), found, pictures, shown, strips)
    told = [replace(row, artefacts={**row.artefacts, "flicker": found[row.name]}) for row in comparison.rows]
    return replace(comparison, rows=tuple(told), motion=moved)


def flickers(
    view: View,
    methods: Sequence[str],
    params: Mapping[str, Mapping[str, Any]] | None = None,
    preset: str = "best",
    samples: int = 256,
    frames: int = FRAMES,
    seed: int = 0,
    progress: Callable[[str, int, int], None] | None = None,
) -> dict[str, float]:
    """Flicker of the reference, and of each method beyond it, where no frame is sharp.

    The reference is rendered twice per frame, from independent seeds, so that its noise does not count: see
    `refdof.metrics.artefacts.flicker`.

    Parameters
    ----------
    view : View
        Of the first frame. Small pictures do: 160 x 120 has some thousand pixels to average.
    methods : names in `refdof.METHODS`
    params : {method: {field: value}}
    preset : one of `refdof.rendering.PRESETS`
    samples, seed : of the references; all frames are rendered with `seed`, and again with the next one
    frames : int
    progress : callable, optional
        Called with (what, done, all).

    Returns
    -------
    dict
        "reference": its flicker; by method: flicker minus that. NaN where every pixel is sharp in some frame.

    Raises
    ------
    InputError
        If a method, preset, parameter or number is not allowed, or the lens is focused at infinity.
    """
    as_function("progress", progress)
    given = as_settings(methods, params)
    for name, settings in given.items():
        make_params(name, settings, preset)
    views, seed = moved_views(view, frames), as_seed(seed)

    def reference(one: View, other: int) -> Float:
        return reference_of_view(one, samples=samples, seed=(seed + other) % 2**32).image

    rows = [(name, name, preset, settings) for name, settings in given.items()]
    tell = progress or (lambda _what, _done, _all: None)
    return {one.name: one.flicker for one in _sequences(views, blurred_in_all(views), rows, reference, tell)}


def _sequences(
    views: Sequence[View],
    region: np.typing.NDArray[np.bool_],
    rows: Sequence[tuple[str, str, str, Mapping[str, Any]]],
    reference: Callable[[View, int], Float],
    tell: Callable[[str, int, int], None],
) -> Iterator[_Sequence]:
    """The reference, then each row: a name, a method, its preset and parameters."""

    def frames_of(what: str, picture: Callable[[View], Float]) -> Float:
        made = []
        for k, one in enumerate(views):
            tell(what, k, len(views))
            made.append(picture(one))
        return np.stack(made)

    first, second = (frames_of("reference", lambda one, other=other: reference(one, other)) for other in (0, 1))  # type: ignore[misc]
    truth = flicker(first, region, second)
    yield _Sequence("reference", first, truth)
    for name, method, preset, settings in rows:

        def rendered(one: View, method: str = method, preset: str = preset, settings: Any = settings) -> Float:
            image = render_view(method, one, preset=preset, **settings).image
            one.forget_layers()
            return image

        frames = frames_of(name, rendered)
        yield _Sequence(name, frames, flicker(frames, region) - truth)


def _liveliest_row(frames: Float, region: np.typing.NDArray[np.bool_]) -> int:
    """The row whose pixels in the region change most from the first frame to the last; of all, if it is empty."""
    change = np.abs(frames[-1].astype(np.float64) - frames[0]).sum(axis=2)
    return int(np.argmax((change * region if region.any() else change).sum(axis=1)))
