"""Pictures of a scene for a page: first coarse, then fine, from views that are kept.

A view keeps what its camera sees. Where only the lens changes, rays are traced anew and nothing else.
"""

from collections.abc import Callable, Iterator
from dataclasses import fields
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from refdof._check import Float, InputError
from refdof.focus.focus_lens import Focus, focus_lens
from refdof.image.display import to_8_bit
from refdof.methods import METHODS
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens
from refdof.optics.systems.paraxial import entrance_pupil
from refdof.optics.systems.prescription import LensSystem
from refdof.optics.systems.system_lens import SystemLens
from refdof.rendering import render_view
from refdof.scene.scene import Scene
from refdof.studio.overlays import Legend, draw_overlay, error_map
from refdof.studio.state import State
from refdof.truth.reference import reference_of_view
from refdof.view import View

__all__ = ["FINE_SAMPLES", "Picture", "Pictures", "settings_of_method"]

COARSE_SAMPLES, FINE_SAMPLES = 16, 64  # lens samples per pixel
_COARSE_PIXELS = 160 * 120
_KEPT = 4  # views: coarse and fine of two pages, or of two states of one
_BLOCK = 16  # lens samples per pixel of the reference between two pictures of the error
_MOST_BLOCKS = 64

Levels = npt.NDArray[np.uint8]


class Picture(NamedTuple):
    """A picture for a page: levels (H, W, 3), its overlay's scale, what it is ("coarse", "fine", "reference"), and the
    view that it is of.
    """

    levels: Levels
    legend: Legend | None
    step: str
    view: View


class _InterruptedError(Exception):
    """A block of the reference stopped for something newer."""


class Pictures:
    """The pictures of one scene.

    Parameters
    ----------
    scene : Scene
    system_of : callable
        The lens system of a name, or InputError.
    """

    def __init__(self, scene: Scene, system_of: Callable[[str], LensSystem]) -> None:
        self.scene, self._system_of = scene, system_of
        self._views: dict[Any, View] = {}

    def view(self, state: State, size: tuple[int, int] | None = None) -> View:
        """The view of a state, with its lens; at another size than its own if given.

        Raises
        ------
        InputError
            If the lens cannot be: no point in the picture, a focus that the lens does not reach, no such lens.
        """
        lens, camera = state.lens, state.camera if size is None else state.camera.with_size(size)
        key = camera, lens, state.points, state.frame
        made = self._views.pop(key, None) if lens.kind != "file" else None  # a file may have changed
        if made is None:
            made = self._made(state, camera)
        self._views[key] = made
        while len(self._views) > _KEPT:
            del self._views[next(iter(self._views))]
        return made

    def _made(self, state: State, camera: Camera) -> View:
        lens, thin = state.lens, ThinLens(state.lens.radius, state.lens.focus, self.scene.lens.aperture)
        if lens.kind == "thin":
            return self._seen(camera, thin, state.frame)
        if lens.kind == "file":
            system = self._system_of(lens.file)
            if lens.radius == 0.0:
                raise InputError("radius: got 0; allowed is a size to which the lens is scaled, above 0")
            real = SystemLens(system, lens.focus, lens.f_number, entrance_pupil(system).radius / lens.radius)
            return self._seen(real.seen_by(camera), real, state.frame)
        shot = self._seen(camera, thin, state.frame)
        return shot.with_lens(focus_lens(Focus(state.points, lens.kind), shot, state.frame))

    def _seen(self, camera: Camera, lens: ThinLens, frame: float) -> View:
        """A view of the camera and lens that shares what the latest one of its kind has made."""
        views = [view for view in reversed(self._views.values()) if self._stands(view.scene, frame)]
        for view in views:
            if view.camera == camera:
                return view.with_lens(lens)
        for view in views:
            if view.camera.with_size(camera.size) == camera:
                return view.with_size(camera.size).with_lens(lens)
        return View(self.scene.at_frame(frame), camera, lens)

    def _stands(self, scene: Scene, frame: float) -> bool:
        """Whether a scene of a view is where ours is at a frame: a still one always."""
        return self.scene.frames is None or scene.frame == frame

    def steps(self, state: State, newer: Callable[[], bool]) -> Iterator[Picture | None]:
        """Pictures of a state, each better than the one before; None where there is no new one.

        `newer` tells that something else waits.
        """
        yield self._picture(state, self.view(state, _smaller(state.camera)), "coarse", COARSE_SAMPLES)[0]
        if state.moving:
            return
        view = self.view(state)
        fine, image = self._picture(state, view, "fine", FINE_SAMPLES)
        yield fine
        if image is not None and state.overlay == "error":
            yield from _errors(view, image, newer)

    def linear(self, state: State) -> Float:
        """The fine picture without overlay: (H, W, 3) float32 linear RGB."""
        return self._rendered(self.view(state), state, FINE_SAMPLES)

    def _picture(self, state: State, view: View, step: str, samples: int) -> tuple[Picture, Float | None]:
        """What is shown, and the method's picture if that took one."""
        if state.overlay in ("coc", "depth", "layers"):  # of what is there, whatever the method makes of it
            return Picture(*draw_overlay(state.overlay, view, None), step, view), None
        image = self._rendered(view, state, samples)
        if state.overlay == "focus":
            return Picture(*draw_overlay("focus", view, image), step, view), image
        return Picture(to_8_bit(image), None, step, view), image

    def _rendered(self, view: View, state: State, samples: int) -> Float:
        return render_view(state.method, view, **settings_of_method(state.method, samples)).image


def _errors(view: View, image: Float, newer: Callable[[], bool]) -> Iterator[Picture | None]:
    """The difference to the mean of all blocks of the reference so far."""
    total = np.zeros(image.shape)
    block = 0

    def progress(done: int, count: int) -> None:
        if newer() and done < count:
            raise _InterruptedError

    while block < _MOST_BLOCKS:
        try:
            total += reference_of_view(view, _BLOCK, seed=block, progress=progress).image
        except _InterruptedError:  # once more, when what was waiting is done
            yield None
            continue
        block += 1
        yield Picture(*error_map(image, total / block, block * _BLOCK), "reference", view)


def settings_of_method(method: str, samples: int) -> dict[str, Any]:
    """Parameters of a method for so many lens samples; none where it has no such number."""
    names = {field.name for field in fields(METHODS[method].METHOD.params)}
    return {"samples": samples} if "samples" in names else {}


def _smaller(camera: Camera) -> tuple[int, int]:
    """The size of the coarse picture."""
    width, height = camera.size
    shrink = max((width * height / _COARSE_PIXELS) ** 0.5, 1.0)
    return max(round(width / shrink), 1), max(round(height / shrink), 1)
