"""A glTF file as a reader of triangles gets it: without cameras, and with marks that say what is what.

Materials are named by their numbers, so that what the reader rounds or does not know is looked up in the header.
"""

from collections.abc import Iterable
from typing import Any

from refdof.scene.gltf.file import GltfFile, Numbers
from refdof.scene.gltf.plain_numbers import with_plain_numbers

__all__ = ["marked", "marks_of", "material_of", "without_cameras"]

_MARK = "_refdof_"  # of names of materials, and of an attribute of each primitive: readers keep both


def without_cameras(file: GltfFile, numbers: Numbers) -> bytes | None:
    """The same file with plain numbers and with its camera nodes turned into plain nodes; None if nothing changes.

    For trimesh, to which a node with a camera loses its meshes and its children.
    """
    header = with_plain_numbers(file.header, numbers)
    changes = header is not file.header or header.get("cameras") or header.get("materials")
    return file.with_header(_plain(header)) if changes else None


def material_of(name: str | None) -> int | None:
    """The number of a material of `marked` or `without_cameras`, by its name; None for trimesh's own."""
    number = (name or "").removeprefix(_MARK)
    return int(number) if name and name != number and number.isdecimal() else None


def marked(file: GltfFile, numbers: Numbers) -> bytes:
    """`without_cameras`, but that nodes and primitives tell which they are: `marks_of`. Nodes stand at 0."""
    header = _plain(with_plain_numbers(file.header, numbers))
    header["nodes"] = [
        {"name": str(index), **{key: node[key] for key in ("mesh", "children") if key in node}}
        for index, node in enumerate(header["nodes"])
    ]
    header["meshes"] = [
        {**mesh, "primitives": [_marked(p, m, k) for k, p in enumerate(mesh["primitives"])]}
        for m, mesh in enumerate(header.get("meshes", []))
    ]
    return file.with_header(header)


def marks_of(node: str, attributes: Iterable[str]) -> tuple[int, int, int]:
    """Node, mesh and primitive of a node's name and a primitive's attributes in a `marked` file.

    Of several primitives in a mesh, trimesh gives each a node with a suffix.
    """
    mark = next(key for key in attributes if key.startswith(_MARK))
    mesh, primitive = mark.removeprefix(_MARK).split("_")
    return int(node.partition("_")[0]), int(mesh), int(primitive)


def _plain(header: dict[str, Any]) -> dict[str, Any]:
    nodes = [{key: value for key, value in node.items() if key != "camera"} for node in header.get("nodes", [])]
    plain = {**{key: value for key, value in header.items() if key != "cameras"}, "nodes": nodes}
    if header.get("materials"):
        plain["materials"] = [{**item, "name": f"{_MARK}{k}"} for k, item in enumerate(header["materials"])]
    return plain


def _marked(primitive: dict[str, Any], mesh: int, index: int) -> dict[str, Any]:
    attributes = primitive["attributes"]
    return {**primitive, "attributes": {**attributes, f"{_MARK}{mesh}_{index}": attributes["POSITION"]}}
