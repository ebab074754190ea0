"""Compressed numbers of glTF files, unpacked by the packages of the extra `codecs`.

References
----------
.. [1] Khronos Group: KHR_draco_mesh_compression, EXT_meshopt_compression.
"""

import importlib.util
from typing import Any

import numpy as np

from refdof._check import Index, InputError, as_choice, as_integer

__all__ = ["DECODERS", "draco_numbers", "has_decoder", "meshopt_bytes"]

DECODERS = {"KHR_draco_mesh_compression": "DracoPy", "EXT_meshopt_compression": "meshoptimizer"}
_MODES = ("ATTRIBUTES", "TRIANGLES", "INDICES")
_FILTERS = ("NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL")


def has_decoder(extension: str) -> bool:
    """Whether an extension's decoder is installed."""
    return extension in DECODERS and importlib.util.find_spec(DECODERS[extension]) is not None


def draco_numbers(numbers: Any, packed: dict[str, Any], name: str) -> tuple[dict[str, np.ndarray], Index | None]:
    """The attributes (V, columns) of a Draco buffer by their glTF names, and the corners of its triangles."""
    if not has_decoder("KHR_draco_mesh_compression"):
        return {}, None  # the file may do without, `extensions` says whether
    import DracoPy

    data = numbers.view(name, packed.get("bufferView"))
    try:
        mesh = DracoPy.decode(data)
        faces = np.asarray(mesh.faces, dtype=np.int64).ravel()
    except Exception as error:  # whatever the decoder meets
        raise InputError(f"{name}: Draco cannot unpack it ({' '.join(str(error).split())[:80]})") from None
    wanted = packed.get("attributes", {})
    by_id = {item["unique_id"]: np.asarray(item["data"]) for item in mesh.attributes}
    found = {}
    for key, number in wanted.items():
        if number not in by_id:
            raise InputError(f"{name}: its Draco buffer has no attribute {str(number)[:40]} for {str(key)[:40]}")
        found[key] = by_id[number].reshape(len(by_id[number]), -1)
    return found, faces


def meshopt_bytes(name: str, says: dict[str, Any], data: bytes, most: float) -> bytes:
    """The bytes of a buffer view that meshopt has packed; `data` are the packed ones.

    Raises
    ------
    InputError
        If they are broken, or unpack to more than `most` bytes.
    """
    from meshoptimizer import decoder

    count = as_integer(f"{name}: count", says.get("count"), minimum=1)
    stride = as_integer(f"{name}: byteStride", says.get("byteStride"), minimum=1, maximum=256)
    mode = as_choice(f"{name}: mode", says.get("mode"), _MODES)
    chosen = as_choice(f"{name}: filter", says.get("filter", "NONE"), _FILTERS)
    if count * stride > most:
        raise InputError(f"{name}: unpacks to {count * stride} bytes; allowed are at most {most:.0f}, the limit bytes")
    try:
        if mode == "ATTRIBUTES":
            rows = decoder.decode_vertex_buffer(count, stride, data, dtype=np.dtype((np.void, stride)))
        else:
            unpack = decoder.decode_index_buffer if mode == "TRIANGLES" else decoder.decode_index_sequence
            rows = unpack(count, 4, data).astype("<u2" if stride == 2 else "<u4")
    except (RuntimeError, ValueError) as error:
        raise InputError(f"{name}: meshopt cannot unpack it ({' '.join(str(error).split())[:80]})") from None
    strides = {"OCTAHEDRAL": (4, 8), "QUATERNION": (8,)}.get(chosen, (stride,))
    if stride not in strides:
        raise InputError(f"{name}: byteStride is {stride} for {chosen}; allowed are {', '.join(map(str, strides))}")
    undo = {
        "OCTAHEDRAL": decoder.decode_filter_oct,
        "QUATERNION": decoder.decode_filter_quat,
        "EXPONENTIAL": decoder.decode_filter_exp,
    }
    return (undo[chosen](rows, count, stride) if chosen in undo else rows).tobytes()
