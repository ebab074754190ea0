"""Look: what a glTF material says of its colour, exactly: factors stay floats, and two extensions of them are read.

References
----------
.. [1] Khronos Group (2021), glTF 2.0 Specification: 3.9 (materials).
.. [2] Khronos Group, KHR_materials_emissive_strength and KHR_materials_unlit.
"""

from typing import Any, NamedTuple

import numpy as np

from refdof._check import InputError, as_float, as_number
from refdof.scene.gltf.file import member

__all__ = ["Look", "look_of"]

_DIFFUSE = "KHR_materials_pbrSpecularGlossiness"  # trimesh makes its colours ones of the core


class Look(NamedTuple):
    """Linear RGB; `base` is None where trimesh knows it better."""

    base: tuple[float, ...] | None
    emission: tuple[float, ...]
    unlit: bool


def look_of(header: dict[str, Any], index: int) -> Look:
    """The look of a material.

    Raises
    ------
    InputError
        If a colour is not three or four numbers, or a strength is no number.
    """
    material = member(header, "materials", index)
    extensions = _table(material, "extensions")
    factor = _table(material, "pbrMetallicRoughness").get("baseColorFactor", [1.0, 1.0, 1.0, 1.0])
    base = as_float("baseColorFactor", factor, (None,), dtype=np.float64, minimum=0.0)[:3]
    strength = _table(extensions, "KHR_materials_emissive_strength").get("emissiveStrength", 1.0)
    glow = as_float(
        "emissiveFactor", material.get("emissiveFactor", [0.0, 0.0, 0.0]), (3,), dtype=np.float64, minimum=0.0
    )
    emission = glow * as_number("emissiveStrength", strength, minimum=0.0)
    if "emissiveTexture" in material:  # not read: with it, a factor alone would glow all over
        emission = np.zeros(3)
    if len(base) < 3:
        raise InputError(f"baseColorFactor: got {len(base)} numbers; allowed are 4")
    known = None if _DIFFUSE in extensions else tuple(base.tolist())
    return Look(known, tuple(emission.tolist()), "KHR_materials_unlit" in extensions)


def _table(holder: dict[str, Any], key: str) -> dict[str, Any]:
    table = holder.get(key, {})
    if not isinstance(table, dict):
        raise InputError(f"{key}: got {type(table).__name__}; allowed is an object")
    return table
