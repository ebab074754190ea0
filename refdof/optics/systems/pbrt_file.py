"""pbrt's lens files (.dat): radius, thickness, index and diameter of every surface, from the scene to the film [mm].

`#` begins a comment. Radius 0 is the aperture stop; index 0 is the air at the stop. Thickness is the distance to the
next surface; of the last one it is 0, as the film is placed by focusing. An index has no dispersion.

References
----------
.. [1] Pharr, Jakob & Humphreys (2023), Physically Based Rendering, 4th edition, the realistic camera.
"""

from refdof._check import InputError, as_number
from refdof.optics.systems.rows import Row, check_count, system_from
from refdof.optics.systems.system import LensSystem

__all__ = ["parse_pbrt"]

_COLUMNS = "radius, thickness, index, diameter"
_LONGEST_SOURCE = 400  # characters of the comments
_LARGEST_INDEX = 4.0  # of a transparent material; what is above is another column


def parse_pbrt(file: str, text: str, name: str) -> LensSystem:
    """The lens system of a file's text; its comments are the source.

    Raises
    ------
    InputError
        If a line is not four numbers, or they make no lens; the line is named.
    """
    comments, lines = [], []
    for number, line in enumerate(text.splitlines(), 1):
        values, mark, comment = line.partition("#")
        if mark:
            comments.append(comment.strip(' \t"'))
        if values.strip():
            lines.append((number, values.split()))
    check_count(file, len(lines))
    rows: list[Row] = []
    for number, words in lines:
        try:
            rows.append(_row(number, words, rows))
        except InputError as error:
            raise InputError(f"{file}: line {number}: {error}") from None
    source = "; ".join(" ".join(comment.split()) for comment in comments if comment)
    return system_from(file, name, source[:_LONGEST_SOURCE], rows)


def _row(number: int, words: list[str], before: list[Row]) -> Row:
    if len(words) != 4:
        raise InputError(f"got {len(words)} columns; allowed are 4: {_COLUMNS}")
    radius, thickness, index, diameter = (
        _number(name, word) for name, word in zip(_COLUMNS.split(", "), words, strict=True)
    )
    is_stop = radius == 0.0
    if is_stop and index not in (0.0, 1.0):
        raise InputError(f"index: got {index:g} at radius 0, which is the stop; allowed is 0 or 1, air")
    if is_stop and before and before[-1].material != 1.0:
        raise InputError("the stop lies in glass; allowed is a stop in air")
    if not is_stop and not 1.0 <= index <= _LARGEST_INDEX:
        raise InputError(f"index: got {index:g}; allowed is 1 to {_LARGEST_INDEX:g}, and 0 at the stop")
    if not before and thickness == 0.0 and index > 1.0:
        raise InputError(
            "thickness: got 0 in front of the first glass, as if the column were the gap before a surface; "
            "allowed is the distance to the next surface"
        )
    return Row(f"line {number}", radius, thickness, 1.0 if is_stop else index, diameter, is_stop)


def _number(name: str, word: str) -> float:
    return as_number(name, word.replace("_", "?"))  # Python reads 1_0 as 10
