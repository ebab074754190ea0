"""Extensions of glTF that a file uses: what is read, what a file may not require, and what is left out.

References
----------
.. [1] Khronos Group (2021), glTF 2.0 Specification: 3.12 (extensions).
"""

import importlib.util
from typing import Any

from refdof._check import InputError

__all__ = ["left_out_extensions"]

_READ = (
    "EXT_texture_webp",
    "KHR_materials_emissive_strength",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_unlit",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
)
_WITH_A_DECODER = {"KHR_draco_mesh_compression": "DracoPy"}  # by trimesh, if this package is there


def left_out_extensions(header: dict[str, Any]) -> list[str]:
    """Names of the extensions that a file uses and can do without, but which are not read.

    Raises
    ------
    InputError
        If the file requires one that is not read, or its lists are no lists of names.
    """
    used, required = (_names(header, kind) for kind in ("extensionsUsed", "extensionsRequired"))
    for name in required:
        if not _is_read(name):
            package = _WITH_A_DECODER.get(name)
            hint = "" if package is None else f", or this one with the package {package}"
            raise InputError(f"it requires the extension {name[:80]!r}; allowed are {', '.join(_READ)}{hint}")
    return [name for name in used if not _is_read(name)]


def _is_read(name: str) -> bool:
    package = _WITH_A_DECODER.get(name)
    return name in _READ or (package is not None and importlib.util.find_spec(package) is not None)


def _names(header: dict[str, Any], kind: str) -> list[str]:
    names = header.get(kind, [])
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise InputError(f"{kind}: got no list of names; allowed is one")
    return names
