"""Promises: what a filter may state of itself, in words, in the order in which they are checked.

Words that methods also use mean the same as there (`refdof.methods`), on one picture instead of a scene. "Near" is
within `reach` radii of the largest circle of confusion, and one pixel more.
"""

from collections.abc import Sequence

from refdof._check import InputError, as_choice, as_instances

__all__ = ["PROMISES", "chosen"]

PROMISES: dict[str, str] = {
    "call": "every picture gives a finite one of the same size, twice the same bits, and the input is left alone",
    "constant": "where all pixels have one colour, they keep it, whatever their depths",
    "pinhole": "with a lens of radius 0, every pixel keeps its colour",
    "focus": "a pixel in focus keeps its colour, unless something out of focus is near",
    "behind": "a pixel in focus keeps its colour, whatever is near behind it",
    "convexity": "no channel is below its least or above its greatest value in the input",
    "energy": "a light on a wall, away from the border, adds the same total to the picture, however blurred",
    "radius": "a light on a wall spreads to the RMS radius of a disc of the wall's circle, within 0.71 px",
    "aperture": "a wider aperture spreads a light on a wall no less: its second moment does not fall",
    "symmetry": "the picture mirrored from left to right gives the result mirrored from left to right",
    "flip": "the picture turned upside down gives the result turned upside down",
    "transpose": "the picture with rows and columns swapped gives the result with rows and columns swapped",
    "translation": "what moves by whole pixels is blurred as before, away from the border",
    "crop": "a crop of the picture gives a crop of the result, away from the cut",
    "tile": "two tiles give what the whole picture gives, away from the seam",
    "pad": "a border that repeats the outermost pixels changes nothing away from it",
    "locality": "a pixel that changes its colour and depth changes nothing that is not near",
    "nan": "a pixel that is not finite spoils nothing that is not near",
    "linearity": "with the depth kept, a sum of pictures gives the sum of results, and a multiple the multiple",
    "channels": "channels in another order give the same result in that order",
    "units": "depth and lens in a unit that is a power of two smaller or larger give the same bits",
    "sides": "a wall in front of the focal plane gives the same picture as one behind it of the same circle",
    "far": "a surface so far that its circle is that of the background looks as the background does",
}


def chosen(promises: Sequence[str] | None) -> tuple[str, ...]:
    """The promises that are named, in the order of `PROMISES`; None: all.

    Raises
    ------
    InputError
        If there is none, or a name is not in `PROMISES`.
    """
    if promises is None:
        return tuple(PROMISES)
    named = {as_choice("promises", name, PROMISES) for name in as_instances("promises", promises, str)}
    if not named:
        raise InputError("promises: got none; allowed is one or more")
    return tuple(name for name in PROMISES if name in named)
