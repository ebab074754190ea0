"""Shots: the TOML files of the built-in scenes, read and checked.

A file holds what is chosen rather than made: title, background, [light], [camera], [lens], the seed of
the random numbers, and [numbers] for the scene's generator; and, if it matters, `order`, its place in lists.
"""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any

from refdof._check import InputError, as_color, as_integer, as_number
from refdof._toml import parse
from refdof.optics.aperture import Aperture
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens
from refdof.scene.material import Light

__all__ = ["LAST", "Shot", "parse_shot", "read_shot", "shot_places"]

LAST = 1_000_000  # the place of scenes that name none: after all others, by name

_TOP = ("title", "shows", "inspired_by", "seed", "background", "light", "camera", "lens", "numbers")
_LIGHT = ("sun_direction", "sun", "sky", "ground")
_CAMERA = ("eye", "target", "up", "fov_y", "size")


@dataclass(frozen=True)
class Shot:
    """A scene's file.

    Attributes
    ----------
    title : what is seen; shows : the phenomenon, one sentence; inspired_by : paper and figure
    seed : int, of the scene's random numbers
    background : (3,) linear RGB
    light, camera, lens : the suggested shot
    numbers : what the generator is told, by name
    order : its place in lists; `LAST` where the file names none
    """

    title: str
    shows: str
    inspired_by: str
    seed: int
    background: tuple[float, float, float]
    light: Light
    camera: Camera
    lens: ThinLens
    numbers: dict[str, float]
    order: int


def read_shot(name: str, numbers: Iterable[str]) -> Shot:
    """The shot of a built-in scene; `numbers` are the names that its generator needs.

    Raises
    ------
    InputError
        If a key is missing, unknown, or has a bad value; the file and the key are named.
    """
    file = f"{name}.toml"
    return parse_shot(file, _folder().joinpath(file).read_text(encoding="utf-8"), numbers)


def shot_places() -> dict[str, int]:
    """The place in lists of every scene that has a file; a file that cannot be read is told of when it is asked for."""
    places = {}
    for file in _folder().iterdir():
        if file.name.endswith(".toml"):
            found = re.search(r"^order *= *([0-9]+) *$", file.read_text(encoding="utf-8"), re.MULTILINE)
            places[file.name.removesuffix(".toml")] = LAST if found is None else int(found[1])
    return places


def _folder() -> Traversable:
    """The folder of the files: that of a checkout, if this is one, or the installed one."""
    root = Path(__file__).parents[3]
    if (root / "pyproject.toml").is_file():
        return root / "data" / "scenes"
    return resources.files("refdof.data.scenes")


def parse_shot(file: str, text: str, numbers: Iterable[str]) -> Shot:
    """Like `read_shot`, from the text of `file`."""
    table = parse(file, text, "a shot")
    _keys(file, table, _TOP, ("order",))
    light, camera, lens = (_table(file, table, key) for key in ("light", "camera", "lens"))
    _keys(f"{file}: light", light, _LIGHT)
    _keys(f"{file}: camera", camera, _CAMERA)
    _keys(f"{file}: lens", lens, ("radius", "focus_distance"), ("blades", "rotation", "curvature"))
    for key in ("rotation", "curvature"):
        if key in lens and "blades" not in lens:
            raise InputError(f"{file}: lens: {key}: needs blades; allowed is a lens without it, or with blades")
    chosen = _table(file, table, "numbers")
    _keys(f"{file}: numbers", chosen, tuple(numbers))
    words = {key: table[key] for key in ("title", "shows", "inspired_by")}
    for key, value in words.items():
        if not isinstance(value, str) or not value.strip():
            raise InputError(f"{file}: {key}: got {value!r}; allowed is a sentence")
    try:
        return Shot(
            **words,
            seed=as_integer("seed", table["seed"], minimum=0),
            order=as_integer("order", table.get("order", LAST), minimum=1, maximum=LAST),
            background=as_color("background", table["background"]),
            light=Light(**light),
            camera=Camera(**camera),
            lens=_lens(lens),
            numbers={key: as_number(key, value) for key, value in chosen.items()},
        )
    except InputError as error:
        raise InputError(f"{file}: {error}") from None


def _lens(table: Mapping[str, Any]) -> ThinLens:
    if "blades" not in table:
        return ThinLens(table["radius"], table["focus_distance"])
    aperture = Aperture.polygon(table["blades"], table.get("rotation", 0.0), table.get("curvature", 0.0))
    return ThinLens(table["radius"], table["focus_distance"], aperture)


def _table(file: str, table: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    if not isinstance(table[key], dict):
        raise InputError(f"{file}: {key}: got {table[key]!r}; allowed is a table [{key}]")
    return table[key]


def _keys(where: str, table: Mapping[str, Any], needed: Iterable[str], optional: Iterable[str] = ()) -> None:
    """Raise if a key is missing or unknown."""
    needed = tuple(needed)
    for key in needed:
        if key not in table:
            raise InputError(f"{where}: {key}: missing; needed are {', '.join(needed)}")
    for key in table:
        if key not in (*needed, *optional):
            raise InputError(f"{where}: {key}: unknown; allowed are {', '.join((*needed, *optional))}")
