"""Which channels of an EXR are colour, and which are depth: by the names that renderers give them.

Colour is a layer with R, G and B: the one without a name, or else one called as below, or else the only one there is.
Depth is a layer whose name ends in "depth", or a channel Z; or else the only channel there is. Where several are
plausible, who asks must say which: FILE.exr:LAYER, or FILE.exr:LAYER.LETTER.

Blender writes "ViewLayer.Combined.R" and "ViewLayer.Depth.Z" (or ".V"), Unreal's movie render queue R, G, B and
"FinalImageMovieRenderQueue_WorldDepth.R".
"""

import re
from collections.abc import Mapping

import numpy as np

from refdof._check import Float, InputError
from refdof.image.exr import is_deep

__all__ = ["color_of", "depth_of", "sample_layer", "split_layer"]

_PICTURES = ("combined", "beauty", "rgba", "rgb", "color", "colour", "image", "finalimage")
_LETTERS = ("Z", "V", "R", "Y")  # of a depth, in this order
_MOST_NAMES = 12  # that an error lists
Layers = Mapping[str, Mapping[str, np.ndarray]]


def split_layer(path: str) -> tuple[str, str | None]:
    """FILE.exr:LAYER as a path and a layer, None where none is said."""
    found = re.fullmatch(r"(.+\.exr):([^/]+)", path, re.IGNORECASE | re.DOTALL)
    return (path, None) if found is None else (found[1], found[2])


def color_of(argument: str, path: str, layers: Layers, wanted: str | None = None) -> Float:
    """The picture of a flat file: (H, W, 3) float32.

    Raises
    ------
    InputError
        If no layer is plausible or more than one, or there is no such layer.
    """
    named = sorted(name for name, channels in layers.items() if {"R", "G", "B"} <= set(channels))
    if wanted is not None:
        chosen = [name for name in named if name == wanted]
    else:
        chosen = [name for name in named if not name]
        chosen = chosen or [name for name in named if re.split(r"[._]", name)[-1].lower() in _PICTURES] or named
    if len(chosen) != 1:
        said = "R, G and B" if wanted is None else f"R, G and B of {wanted!r}"
        _refuse(argument, path, said, chosen, layers)
    channels = [layers[chosen[0]][letter] for letter in "RGB"]
    if any(is_deep(channel) for channel in channels):
        raise InputError(f"{argument}: {path!r} is a deep file; allowed is a flat one")
    return np.stack(channels, axis=-1).astype(np.float32)


def depth_of(argument: str, path: str, layers: Layers, wanted: str | None = None, by_name: bool = True) -> np.ndarray:
    """The depth of a file, as stored: (H, W); or without `by_name` the only channel that it can be.

    Raises
    ------
    InputError
        If no channel is plausible or more than one, or there is no such channel.
    """
    names = [f"{layer}.{letter}".lstrip(".") for layer, channels in layers.items() for letter in channels]
    if wanted is not None:
        chosen = [name for name in names if name == wanted] or _letters_of(layers, wanted)
    elif by_name:
        depths = [layer for layer in layers if layer.lower().endswith("depth")]
        depths = [layer for layer in depths if layer.lower().split(".")[-1] == "depth"] or depths
        chosen = [found for layer in depths for found in _letters_of(layers, layer)]
        chosen = chosen or [
            name
            for name in names
            if re.split(r"[._]", name)[-1].lower() in ("z", "depth")
            and "mist" not in name.lower()  # 0 .. 1, no distance
        ]
    else:
        chosen = []
    if wanted is None:
        chosen = chosen or (names if len(names) == 1 else _gray(layers))
    if len(chosen) != 1:
        said = repr(wanted) if wanted is not None else "depth" if by_name else "channel of its own"
        _refuse(argument, path, said, chosen, layers)
    layer, _, letter = chosen[0].rpartition(".")
    return layers[layer][letter]


def sample_layer(argument: str, path: str, layers: Layers) -> tuple[list[np.ndarray], np.ndarray, np.ndarray | None]:
    """R, G and B, Z and A (None: all opaque) of a deep file, each (H, W) of samples.

    Raises
    ------
    InputError
        If there is not exactly one layer that has them.
    """
    chosen = [name for name, channels in layers.items() if {"R", "G", "B", "Z"} <= set(channels)]
    if len(chosen) != 1:
        _refuse(argument, path, "R, G, B and Z", chosen, layers)
    channels = layers[chosen[0]]
    return [channels[letter] for letter in "RGB"], channels["Z"], channels.get("A")


def _letters_of(layers: Layers, layer: str) -> list[str]:
    """The channel of a layer that is its depth: a list of one, or of none."""
    letters = list(layers.get(layer, {}))
    chosen = next((letter for letter in _LETTERS if letter in letters), letters[0] if len(letters) == 1 else None)
    return [] if chosen is None else [f"{layer}.{chosen}".lstrip(".")]


def _gray(layers: Layers) -> list[str]:
    """The red channel of a file that holds one gray picture."""
    if len(layers) != 1:
        return []
    ((layer, channels),) = layers.items()
    if not {"R", "G", "B"} <= set(channels) or any(is_deep(channel) for channel in channels.values()):
        return []
    gray = all(np.array_equal(channels["R"], channels[letter], equal_nan=True) for letter in "GB")
    return [f"{layer}.R".lstrip(".")] if gray else []


def _refuse(argument: str, path: str, said: str, chosen: list[str], layers: Layers) -> None:
    every = [f"{layer}.{letter}".lstrip(".") for layer, channels in layers.items() for letter in channels]
    names = chosen if len(chosen) > 1 else every
    told = ", ".join(name or "R" for name in names[:_MOST_NAMES]) + (", ..." if len(names) > _MOST_NAMES else "")
    count = "several" if len(chosen) > 1 else "no"
    raise InputError(
        f"{argument}: {path!r} has {count} {said} (it has {told}); allowed is one, or its name: FILE.exr:LAYER"
    )
