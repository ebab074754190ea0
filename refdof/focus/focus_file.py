"""focus.toml: focus points in a file, read strictly, and written.

kind = "surface"           # or "plane" (tilt-shift), or "distance"
focal_length = 0.05        # [scene units]: this and all below may be left out
power = [[0.0, 1.0], [1.0, 1.02]]        # by the share of the lens radius
ray_weights = [[0.0, 0.5], [1.0, 3.0]]   # the same

[[point]]
name = "statue"            # may be left out
triangle = 1203
barycentrics = [0.2, 0.5, 0.3]
offset = 0.0               # [scene units]: this and all below may be left out
aperture = 1.0
weight = [[0, 1.0], [24, 0.0]]   # or keyframes, as of offset, aperture and image_offset: [frame, value]
falloff = 3.0
image_offset = 0.0         # [scene units, on the image's side]
keep = false
"""

from dataclasses import fields
from pathlib import Path
from typing import Any

from refdof._check import InputError, as_instance
from refdof._files import as_plain_file
from refdof._toml import check_keys, parse, quoted, shown
from refdof.focus.focus_lens import Focus
from refdof.focus.point import FocusPoint
from refdof.image.atomic import atomic_path

__all__ = ["focus_text", "load_focus", "parse_focus", "point_text", "save_focus"]

_MOST_BYTES = 10_000_000
_NEEDED = ("triangle", "barycentrics")
_OF_LENS = ("kind", "focal_length", "power", "ray_weights")
_OPTIONAL = tuple(field.name for field in fields(FocusPoint) if field.name not in _NEEDED)


def load_focus(path: str | Path, argument: str = "focus-points") -> Focus:
    """Read a focus.toml; `argument` is what errors call its path.

    Raises
    ------
    InputError
        If there is no such file, or something in it is missing, unknown or out of range.
    """
    file = as_plain_file(argument, path)
    name = f"{argument}: {file.name}"
    if file.stat().st_size > _MOST_BYTES:
        raise InputError(f"{name}: has {file.stat().st_size} bytes; allowed are at most {_MOST_BYTES}")
    try:
        text = file.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(f"{name}: is no text in UTF-8; allowed is a TOML file of focus points") from None
    except OSError as error:
        raise InputError(f"{argument}: got {str(path)!r}: {error.strerror}; allowed is a file") from None
    return parse_focus(name, text)


def parse_focus(file: str, text: str) -> Focus:
    """The focus of a file's text; `file` is its name in errors. It raises as `load_focus` does."""
    table = parse(file, text, "focus points")
    check_keys(file, table, ("point",), _OF_LENS)
    given = table["point"]
    if not isinstance(given, list) or not all(isinstance(point, dict) for point in given):
        raise InputError(f"{file}: point: got no tables; allowed are tables [[point]]")
    points = []
    for number, point in enumerate(given, 1):
        try:
            check_keys("", point, _NEEDED, _OPTIONAL)
            points.append(FocusPoint(**point))
        except InputError as error:
            raise InputError(f"{file}: point {number}: {error}") from None
    try:
        return Focus(tuple(points), **{name: table[name] for name in _OF_LENS if name in table})
    except InputError as error:
        raise InputError(f"{file}: {error}") from None


def save_focus(path: str | Path, focus: Focus) -> None:
    """Write a focus.toml; read again it is the same focus."""
    as_instance("focus", focus, Focus)
    with atomic_path(Path(path)) as temporary:
        temporary.write_text(focus_text(focus), encoding="utf-8")


def focus_text(focus: Focus) -> str:
    """The text of a focus.toml."""
    said = [f"{name} = {_value_text(name, value)}" for name in _OF_LENS if (value := getattr(focus, name))]
    return "\n".join([*said, *("\n" + point_text(point) for point in focus.points)]) + "\n"


def point_text(point: FocusPoint) -> str:
    """A point's table; what has its default is left out."""
    lines = ["[[point]]"]
    for field in fields(point):
        value = getattr(point, field.name)
        if field.name in _NEEDED or value != field.default:
            lines.append(f"{field.name} = {_value_text(field.name, value)}")
    return "\n".join(lines)


def _value_text(name: str, value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return quoted(name, value)
    if isinstance(value, tuple):
        return f"[{', '.join(_value_text(name, part) for part in value)}]"
    return str(value) if isinstance(value, int) else shown(value)
