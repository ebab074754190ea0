"""MTL files: the materials of OBJ files.

Read are Kd, d, Tr, Ke and Ns, and the pictures map_Kd, map_d and map_Ke with the options -s, -o, -clamp, -mm and
-imfchan; other options are passed over. Pictures are looked for in the library's folder, then in the mesh's. Kd, Ke are
linear, pictures sRGB. Of a picture for d, opacity is its alpha channel, or its red one where it has none.

References
----------
.. [1] Wavefront Technologies (1995), MTL material format.
"""

import shlex
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float, InputError, as_float
from refdof.scene.formats.pictures import Picture, encode_srgb
from refdof.scene.formats.reading import GREY, SPECULAR, WHITE, Reading
from refdof.scene.formats.text import lines_of
from refdof.scene.material import Material

__all__ = ["MAX_SHININESS", "Library", "Paint"]

MAX_SHININESS = 2000.0  # a highlight narrower than a pixel would only flicker
_PICTURES = ("map_kd", "map_d", "map_ke")
_NOT_READ = ("map_ks", "map_ka", "map_ns", "map_bump", "bump", "norm", "disp", "decal", "refl", "map_pr", "map_pm")
_NUMBERS = {"-s": 3, "-o": 3, "-t": 3, "-mm": 2}  # options and the most numbers they take
_WORDS = ("-clamp", "-blendu", "-blendv", "-cc", "-imfchan", "-type", "-texres", "-bm", "-boost")  # with one word each


class Paint(NamedTuple):
    """A material, and what its texture coordinates become first: uv * scale + offset."""

    material: Material
    scale: Float  # (2,)
    offset: Float  # (2,)


class Library:
    """The materials that the `mtllib` lines of an OBJ file name."""

    def __init__(self, lines: list[str], reading: Reading) -> None:
        self._reading = reading
        self._known: dict[str, tuple[dict[str, str], str]] = {}  # lines of each material, and its folder
        self._in_any_case: dict[str, tuple[dict[str, str], str]] = {}
        self._made: dict[Any, Paint] = {}
        self._complete = True
        for line in lines:
            for name in _names(line, reading):
                self._open(name)

    def _open(self, name: str) -> None:
        try:
            path = self._reading.beside.find(name)
            data = self._reading.beside.get(name)
        except FileNotFoundError:
            self._complete = False
            return
        current: dict[str, str] = {}
        for line in lines_of(data):
            key, _, rest = line.partition(" ")
            if key.lower() == "newmtl":
                current = {}
                name, item = rest.strip().strip('"'), (current, self._reading.beside.folder_of(path))
                self._known.setdefault(name, item)
                self._in_any_case.setdefault(name.lower(), item)
            else:
                current[key.lower()] = rest

    def paint(self, name: str | None, has_uv: bool, is_colored: bool) -> Paint:
        """The paint of faces of a material: None is none, or one that is nowhere."""
        key = (name, has_uv, is_colored)
        if key not in self._made:
            self._made[key] = self._paint(name, has_uv, is_colored)
        return self._made[key]

    def _paint(self, name: str | None, has_uv: bool, is_colored: bool) -> Paint:
        found = None if name is None else self._known.get(name)
        if found is None and name is not None:
            found = self._in_any_case.get(name.lower())
            if found is None and self._complete:
                self._reading.leave_out(f"the material {name[:80]!r}", "no material library has it")
        if found is None:
            return Paint(self._reading.plain(WHITE if is_colored else GREY), np.ones(2), np.zeros(2))
        says, folder = found
        for key in says:
            if key in _NOT_READ:
                self._reading.leave_out(f"pictures for {key}", "they are not read")
        pictures = {key: _map(key, says[key], folder, self._reading) for key in _PICTURES if key in says and has_uv}
        return _of(says, pictures, is_colored, self._reading)


def _names(line: str, reading: Reading) -> list[str]:
    """The files of a line: several, or one whose name has blanks."""
    whole = line.strip().strip('"')
    if " " not in whole:
        return [whole]
    try:
        reading.beside.find(whole)
    except FileNotFoundError:
        reading.beside.missing.pop(whole, None)
        try:
            return shlex.split(line.replace("\\", "/"))
        except ValueError:
            return line.split()
    return [whole]


class _Map(NamedTuple):
    picture: Picture | None
    scale: Float
    offset: Float
    clamp: bool
    base_gain: tuple[float, float]
    channel: str


def _map(key: str, text: str, folder: str, reading: Reading) -> _Map:
    """A picture with its options, [1]."""
    words = text.split()
    options: dict[str, Any] = {}
    while words and words[0].startswith("-"):
        option = words.pop(0).lower()
        if option in _NUMBERS:
            numbers: list[float] = []
            while words and len(numbers) < _NUMBERS[option] and _is_number(words[0]) and len(words) > 1:
                numbers.append(float(words.pop(0)))
            options[option] = numbers
        elif option in _WORDS:
            options[option] = words.pop(0).lower() if words else ""
        else:  # a name that starts with a line
            words.insert(0, option)
            break
    if "-t" in options:
        reading.leave_out(f"the option -t of {key}", "it is not read")
    name = text.split(None, len(text.split()) - len(words))[-1].strip().strip('"') if words else ""
    picture = None
    try:
        if not name:
            raise FileNotFoundError
        path = reading.beside.find(name, folder)
        picture = reading.pictures.get(path, name, reading.beside.get(name, folder))
    except FileNotFoundError:  # it is told as missing
        if not name:
            reading.leave_out(f"the picture of {key}", "it has no name")
    scale, offset = np.ones(2), np.zeros(2)
    for target, option in ((scale, "-s"), (offset, "-o")):
        given = options.get(option, [])[:2]
        target[: len(given)] = given
    graded: list[float] = options.get("-mm", [])
    base, gain = [*graded, *(0.0, 1.0)[len(graded) :]]
    channel = str(options.get("-imfchan", ""))
    return _Map(picture, scale, offset, options.get("-clamp") == "on", (base, gain), channel)


def _is_number(word: str) -> bool:
    try:
        return bool(np.isfinite(float(word)))
    except ValueError:
        return False


def _of(says: dict[str, str], maps: dict[str, _Map], is_colored: bool, reading: Reading) -> Paint:
    paint, clear, glow = (maps.get(key) for key in _PICTURES)
    first = paint or clear or glow
    for key, other in maps.items():
        same = first is None or (
            np.array_equal(first.scale, other.scale) and np.array_equal(first.offset, other.offset)
        )
        if not same or (first is not None and first.clamp != other.clamp):
            reading.leave_out(f"the options of {key}", "they are not those of the material's first picture")
    color = None if paint is None or paint.picture is None else paint.picture.color
    plain = WHITE if color is not None or is_colored else GREY
    wanted = Material(
        reading.shading(),
        _rgb("Kd", says.get("kd"), plain),
        None if color is None or paint is None else _graded(color, paint.base_gain),
        _rgb("Ke", says.get("ke"), WHITE if "map_ke" in says else (0.0, 0.0, 0.0)),
        SPECULAR,
        float(np.clip(_number("Ns", says.get("ns"), 50.0), 1.0, MAX_SHININESS)),
        opacity=_opacity(says),
        wrap="clamp" if first is not None and first.clamp else "repeat",
    )
    if "map_ke" in says:
        lit = glow is not None and glow.picture is not None
        # Without its picture, a colour alone would glow all over.
        emission = wanted.emission if lit else (0.0, 0.0, 0.0)
        texture = _graded(glow.picture.color, glow.base_gain) if lit else None  # type: ignore[union-attr]
        wanted = replace(wanted, emission=emission, emission_texture=texture)
    if clear is not None and clear.picture is not None:
        wanted = replace(wanted, opacity_texture=np.clip(_graded(_channel(clear), clear.base_gain), 0.0, 1.0))
    ones = first or _Map(None, np.ones(2), np.zeros(2), False, (0.0, 1.0), "")
    return Paint(wanted, ones.scale, ones.offset)


def _channel(clear: _Map) -> Float:
    picture = clear.picture
    assert picture is not None
    opaque = picture.opacity is None
    if opaque or clear.channel in ("r", "l"):
        return encode_srgb(picture.color[:, :, 0]).astype(np.float32)  # as it is stored
    return picture.opacity  # type: ignore[return-value]


def _graded(values: Float, base_gain: tuple[float, float]) -> Float:
    base, gain = base_gain
    return values if base_gain == (0.0, 1.0) else np.maximum(base + gain * values, 0.0).astype(np.float32)


def _rgb(name: str, text: str | None, default: tuple[float, float, float]) -> tuple[float, float, float]:
    """Three numbers, or one for all; spectral files and CIE XYZ are left out."""
    words = [] if text is None else text.split()
    if not words or not _is_number(words[0]):
        return default
    values = [_number(name, word, 0.0) for word in words[:3]]
    red, green, blue = (max(0.0, value) for value in (values if len(values) == 3 else [values[0]] * 3))
    return (red, green, blue)


def _opacity(says: dict[str, str]) -> float:
    """d is opacity, Tr its opposite; where both are there, d counts."""
    if "d" in says:
        return float(np.clip(_number("d", says["d"].replace("-halo", ""), 1.0), 0.0, 1.0))
    return float(np.clip(1.0 - _number("Tr", says.get("tr"), 0.0), 0.0, 1.0))


def _number(name: str, text: str | None, default: float) -> float:
    if text is None or not text.split():
        return default
    try:
        return float(as_float(name, [float(text.split()[0])], (1,))[0])
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{name}: got {text[:40]!r}; allowed is a number") from None
