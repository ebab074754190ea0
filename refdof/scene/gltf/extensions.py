"""Extensions of glTF that a file uses: what is read, what a file may not require, and what is left out.

References
----------
.. [1] Khronos Group (2021), glTF 2.0 Specification: 3.12 (extensions).
"""

from typing import Any

from refdof._check import InputError
from refdof.scene.gltf.codecs import DECODERS, has_decoder

__all__ = ["left_out_extensions"]

_READ = (
    "EXT_mesh_gpu_instancing",
    "EXT_texture_avif",
    "EXT_texture_webp",
    "KHR_materials_emissive_strength",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_unlit",
    "KHR_mesh_quantization",
    "KHR_node_visibility",
    "KHR_texture_transform",
)


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
            hint = "; pip install 'refdof[codecs]' reads it" if name in DECODERS else ""
            raise InputError(f"it requires the extension {name[:80]!r}{hint}; allowed are {', '.join(_READ)}")
    return [name for name in used if not _is_read(name)]


def _is_read(name: str) -> bool:
    return name in _READ or has_decoder(name)


def _names(header: dict[str, Any], kind: str) -> list[str]:
    names = header.get(kind, [])
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise InputError(f"{kind}: got no list of names; allowed is one")
    return names
