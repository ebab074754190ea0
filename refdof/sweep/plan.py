"""Plan: what a sweep measures. A point is a job at a shot: a method with its settings, before a scene.

An axis is a name and the values that it takes. It names a parameter of a method, or one of `SHOT_AXES`. A method of
which no axis names a parameter takes the values of its own tradeoff, the `tradeoff` of its `Method`.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

from refdof._check import Float, InputError, as_choice
from refdof._store import fingerprint
from refdof.methods import METHODS
from refdof.optics.lens import ThinLens
from refdof.rendering import make_params
from refdof.settings import setting_of
from refdof.shot import size_of
from refdof.typed import as_typed
from refdof.view import View

__all__ = ["SHOT_AXES", "Axis", "Job", "Shot", "axis_of", "jobs_of", "shots_of"]

SHOT_AXES = ("size", "lens_radius", "focus")
_MOST_VALUES = 256  # of an axis
_MOST_JOBS = 10_000


@dataclass(frozen=True)
class Axis:
    """A name, and the values that it takes."""

    name: str
    values: tuple[Any, ...]


@dataclass(frozen=True)
class Job:
    """A method and its settings.

    Attributes
    ----------
    settings : {parameter: value}
        Those that differ from the defaults, or that were asked for.
    varied : those of them that an axis names
    params : the method's `Params`
    """

    method: str
    settings: Mapping[str, Any]
    varied: tuple[str, ...]
    params: Any


@dataclass(eq=False)
class Shot:
    """A scene, a camera and a lens, and what every job before them shares.

    Pickle takes it without the view's raster products, which are made again where they are needed.

    Attributes
    ----------
    varied : {axis: value}
    source : str
        What loads the scene: its name or file.
    image, standard_error : (H, W, 3) float32
        The reference, once it was rendered.
    noise_floor_psnr : float, of the reference
    """

    view: View
    varied: Mapping[str, Any]
    source: str = ""
    image: Float | None = None
    standard_error: Float | None = None
    noise_floor_psnr: float = math.nan

    @property
    def name(self) -> str:
        """The scene, and what was varied."""
        return " ".join([self.view.scene.name, *(f"{key}={value}" for key, value in self.varied.items())])

    def __getstate__(self) -> dict[str, Any]:
        bare = View(self.view.scene, self.view.camera, self.view.lens)
        return {**self.__dict__, "view": bare}


def axis_of(text: str) -> Axis:
    """'key=value,value,...' as an axis.

    Raises
    ------
    InputError
        If there is no name, no value, or an empty one.
    """
    key, equals, values = text.partition("=")
    words = [word.strip() for word in values.split(",")]
    if not equals or not key or not all(words):
        raise InputError(f"vary: got {text!r}; allowed is KEY=VALUE,VALUE,...")
    if len(words) > _MOST_VALUES:
        raise InputError(f"vary: got {len(words)} values of {key}; allowed are at most {_MOST_VALUES}")
    key = key.replace("-", "_")
    return Axis(key, tuple(word if key == "size" else setting_of(f"{key}={word}")[1] for word in words))


def jobs_of(methods: Sequence[str], axes: Sequence[Axis], fixed: Mapping[str, Mapping[str, Any]] = {}) -> list[Job]:
    """Every method with every combination of its axes' values; settings that come to the same are one job.

    Parameters
    ----------
    methods : names in `refdof.METHODS`
    axes : those of shots are left out
    fixed : {method: {parameter: value}}, optional

    Raises
    ------
    InputError
        If no method has a parameter of an axis's name, one is set as well, or a value is not allowed.
    """
    names = [axis.name for axis in axes]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"vary: got {name} twice; allowed is once")
        known = dict.fromkeys(key for method in methods for key in METHODS[method].METHOD.defaults())
        as_choice(f"vary: parameter of {', '.join(methods)}", name, [*SHOT_AXES, *known])
    jobs: list[Job] = []
    for method in methods:
        record = METHODS[method].METHOD
        own = [axis for axis in axes if axis.name in record.defaults()]
        if not own and record.tradeoff is not None and record.tradeoff[0] not in fixed.get(method, {}):
            own = [Axis(*record.tradeoff)]
        for axis in own:
            if axis.name in fixed.get(method, {}):
                raise InputError(f"set: got {method}.{axis.name}, which --vary names; allowed is one of both")
        count = math.prod(len(axis.values) for axis in own)
        if len(jobs) + count > _MOST_JOBS:
            raise InputError(f"vary: got {len(jobs) + count} combinations; allowed are at most {_MOST_JOBS}")
        jobs += _combinations(method, own, fixed.get(method, {}))
    return jobs


def _combinations(method: str, axes: Sequence[Axis], fixed: Mapping[str, Any]) -> list[Job]:
    found: dict[str, Job] = {}
    for values in product(*(axis.values for axis in axes)):
        settings = {**fixed, **{axis.name: value for axis, value in zip(axes, values, strict=True)}}
        params = make_params(method, settings)
        found.setdefault(fingerprint(params), Job(method, settings, tuple(axis.name for axis in axes), params))
    return list(found.values())


def shots_of(view: View, axes: Sequence[Axis]) -> list[Shot]:
    """The view with every combination of the values of `SHOT_AXES`.

    Raises
    ------
    InputError
        If a value is not allowed, or the lens is none that can be varied so.
    """
    own = [axis for axis in axes if axis.name in SHOT_AXES]
    shots = []
    for values in product(*(axis.values for axis in own)):
        varied = {axis.name: value for axis, value in zip(own, values, strict=True)}
        seen = view
        if "size" in varied:
            seen = seen.with_size(size_of(varied["size"], "vary: size"))
        of_lens = [name for name in _LENS_FIELDS if name in varied]
        parts = {_LENS_FIELDS[name]: varied[name] for name in of_lens}
        if parts:
            if type(view.lens) is not ThinLens:
                raise InputError(f"vary: got {', '.join(of_lens)} with a lens that sets it; allowed with a thin lens")
            with as_typed(**{key: f"vary: {name}" for name, key in _LENS_FIELDS.items()}):
                seen = seen.with_lens(replace(view.lens, **parts))
        shots.append(Shot(seen, varied))
    return shots


_LENS_FIELDS = {"lens_radius": "radius", "focus": "focus_distance"}
