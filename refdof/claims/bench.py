"""Bench: views, references and pictures that several claims share, made once.

A shot is a table: `scene`, `size` "WxH", and optionally `circle`, the mean diameter of the circles of confusion [px],
to which the lens is opened or closed, and `samples` of the reference. A render is a table: `method`, and fields of its
`Params`; `preset` is what the source ran, see `AS_RUN`.
"""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from refdof._check import Float
from refdof.compare import kept_reference, timed, warm_up
from refdof.metrics import METRICS
from refdof.rendering import Result, render_view
from refdof.scene.load import load_scene
from refdof.truth.reference import MAX_SAMPLES
from refdof.view import View

__all__ = ["AS_RUN", "Bench", "preset_of"]

_T = TypeVar("_T")

AS_RUN = {"multiview": "paper", "lensblur": "paper"}
"""The preset that stands for what a source ran, "best" for all others. The printed misprints of `cascaded` and the
geometric blend of `mipmap` were not run: figure 4 of the one and section 6 of the other say so."""
_SAMPLES = 256  # of a reference
_ROUNDS = 5  # of runs in turn, each of up to three


def preset_of(render: Mapping[str, Any]) -> str:
    """The preset of a render."""
    return str(render.get("preset", AS_RUN.get(render["method"], "best")))


def params_of(render: Mapping[str, Any]) -> dict[str, Any]:
    """The fields of a render's `Params`."""
    return {key: value for key, value in render.items() if key not in ("method", "preset")}


class Bench:
    """What claims are measured on; `tell`, which may be set, is called with words before something long."""

    def __init__(self, tell: Callable[[str], None] = lambda _: None) -> None:
        self._made: dict[str, Any] = {}
        self.tell = tell

    def keep(self, what: Any, make: Callable[[], _T]) -> _T:
        """What `make` made for `what`, plain values, the first time."""
        key = json.dumps(what, sort_keys=True)
        if key not in self._made:
            self._made[key] = make()
        made: _T = self._made[key]
        return made

    def view(self, shot: Mapping[str, Any]) -> View:
        """The view of a shot."""

        def build() -> View:
            width, height = (int(side) for side in shot["size"].split("x"))
            scene = self.keep(["scene", shot["scene"]], lambda: load_scene(shot["scene"]))
            view = View(scene, scene.camera.with_size((width, height)), scene.lens)
            view.times_warm_runs = True
            if "circle" in shot:
                mean = 2.0 * float(np.abs(view.coc_px()).mean())
                view = view.with_lens(replace(view.lens, radius=view.lens.radius * shot["circle"] / mean))
            return view

        return self.keep(["view", dict(shot)], build)

    def truth(self, shot: Mapping[str, Any]) -> Float:
        """The reference's picture of a shot."""

        def make() -> Float:
            self.tell(f"reference of {shot['scene']}")
            view = self.view(shot)
            samples = shot.get("samples", _SAMPLES)
            return kept_reference(view, samples, None, 0, MAX_SAMPLES, lambda _done, _all: None)[0].image

        return self.keep(["truth", dict(shot)], make)

    def result(self, shot: Mapping[str, Any], render: Mapping[str, Any], stages: bool = False) -> Result:
        """A render of a shot, with its stages if asked for."""

        def make() -> Result:
            self.tell(f"{render['method']} on {shot['scene']}")
            view = self.view(shot)
            return render_view(render["method"], view, stages, preset_of(render), **params_of(render))

        return self.keep(["result", dict(shot), dict(render), stages], make)

    def image(self, shot: Mapping[str, Any], render: Mapping[str, Any]) -> Float:
        """A render's picture; of method "pinhole" what the pinhole sees."""
        return self.view(shot).pinhole().color if render["method"] == "pinhole" else self.result(shot, render).image

    def score(self, shot: Mapping[str, Any], render: Mapping[str, Any], metric: str = "psnr") -> float:
        """A score of `refdof.metrics.METRICS` of a render against the reference."""

        def make() -> float:
            return METRICS[metric].function(self.truth(shot), self.image(shot, render))

        return self.keep(["score", dict(shot), dict(render), metric], make)

    def seconds(self, renders: Sequence[tuple[Mapping[str, Any], Mapping[str, Any]]], part: str = "blur") -> Float:
        """Seconds of warm renders of shots, in turn, so that what else the machine does slows all of them: (rounds, N).

        Of the method itself, or with `part` "total" also of its layers, made anew in each round.
        """
        rounds = np.empty((_ROUNDS, len(renders)))
        for _, render in renders:
            warm_up(render["method"], params_of(render), preset_of(render))
        for k in range(_ROUNDS):
            for n, (shot, render) in enumerate(renders):
                self.tell(f"time of {render['method']} on {shot['scene']}")
                view = self.view(shot)
                if part == "total":
                    view.forget_layers()
                with view.booking() as book:
                    _, spent = timed(render["method"], view, preset_of(render), params_of(render))
                rounds[k, n] = np.median(spent) + (book.layers if part == "total" else 0.0)
        return rounds
