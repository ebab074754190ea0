"""WGSL as text: what a module reads, at which bindings, and how its uniforms lie in memory.

1. Variables with @group and @binding, and overrides   `module_of`
2. Members of uniform structs, with their offsets      `_members`
3. Inputs of the entry point, and a vertex shader      `vertex_shader`
"""

import re
from typing import NamedTuple

from .slots import ShaderFault

__all__ = ["Member", "Module", "Variable", "compiler_message", "module_of", "vertex_shader"]

_TYPES = {  # name: type of a slot, bytes, alignment
    **{plain: (kind, 4, 4) for plain, kind in (("f32", "float"), ("i32", "int"), ("u32", "uint"))},
    **{
        spelt: (f"{prefix}vec{count}", 4 * count, 8 if count == 2 else 16)
        for prefix, short, scalar in (("", "f", "f32"), ("i", "i", "i32"), ("u", "u", "u32"))
        for count in (2, 3, 4)
        for spelt in (f"vec{count}{short}", f"vec{count}<{scalar}>")
    },
}
_SCALARS = {"f32": "float", "i32": "int", "u32": "uint", "bool": "bool"}
_ATTRIBUTES = r"((?:@\w+\s*(?:\([^)]*\))?\s*)*)"
_VARIABLE = re.compile(_ATTRIBUTES + r"var\s*(?:<([^>]*)>)?\s*(\w+)\s*:\s*([^;=]+);")
_OVERRIDE = re.compile(_ATTRIBUTES + r"override\s+(\w+)\s*(?::\s*(\w+))?\s*(=)?")
_ENTRY = re.compile(r"((?:@\w+\s*(?:\([^)]*\))?\s*)+)fn\s+(\w+)\s*\(")
_PADDING = re.compile(r"_*(?:pad|padding|unused|reserved|dummy)_?\w?", re.IGNORECASE)


class Member(NamedTuple):
    """A number or vector in a uniform buffer: its name, a slot's type, and its offset [bytes]."""

    name: str
    type: str
    offset: int


class Variable(NamedTuple):
    """A bound variable: kind "texture", "sampler", "uniform" or "storage"; of uniforms the members and the size."""

    name: str
    kind: str
    group: int
    binding: int
    members: tuple[Member, ...] = ()
    size: int = 0


class Module(NamedTuple):
    """What a module is: stage "fragment" or "compute" and its entry point.

    inputs: ((location, type), ...) of a fragment; workgroup: (x, y) of a compute shader; overrides: {name: (key, type,
    has_default)}; samples: {sampler: textures that it is used with}.
    """

    stage: str
    entry: str
    variables: tuple[Variable, ...]
    overrides: dict[str, tuple[str, str, bool]]
    samples: dict[str, tuple[str, ...]]
    inputs: tuple[tuple[int, str], ...] = ()
    workgroup: tuple[int, int] = (1, 1)


def module_of(text: str) -> Module:
    """Read a module that compiles.

    Raises
    ------
    ShaderFault
        If it has no entry point to draw with, or reads a kind of variable that is not given.
    """
    bare = re.sub(r"//[^\n]*|/\*.*?\*/", " ", text, flags=re.DOTALL)
    structs = {name: _parts(body) for name, body in re.findall(r"\bstruct\s+(\w+)\s*\{([^}]*)\}", bare)}
    variables = tuple(
        _variable(attributes, space.strip(), name, _tight(kind), structs)
        for attributes, space, name, kind in _VARIABLE.findall(bare)
        if "@binding" in attributes
    )
    overrides = {
        name: (_number(attributes, "id") or name, _SCALARS.get(kind, "float"), bool(own))
        for attributes, name, kind, own in _OVERRIDE.findall(bare)
    }
    samples: dict[str, tuple[str, ...]] = {}
    for texture, sampler in re.findall(
        r"\btexture(?:Sample|Gather)\w*\s*\(\s*(?:\d\w?\s*,\s*)?(\w+)\s*,\s*(\w+)", bare
    ):
        samples[sampler] = tuple(dict.fromkeys((*samples.get(sampler, ()), texture)))
    for entry in _ENTRY.finditer(bare):
        attributes, name = entry[1], entry[2]
        if "@fragment" in attributes:
            inputs = _inputs(_inside(bare, entry.end() - 1), structs)
            return Module("fragment", name, variables, overrides, samples, inputs)
        if "@compute" in attributes and any(variable.kind == "storage" for variable in variables):
            found = re.search(r"@workgroup_size\s*\(\s*(\d+)\w?\s*(?:,\s*(\d+))?", attributes)
            if found is None:
                raise ShaderFault(f"{name}: has no workgroup size in plain numbers; allowed is @workgroup_size(8, 8)")
            group = int(found[1]), int(found[2] or 1)
            return Module("compute", name, variables, overrides, samples, workgroup=group)
    raise ShaderFault(
        "has no entry point; allowed is @fragment, or @compute with a texture_storage_2d<rgba32float, write>"
    )


def vertex_shader(inputs: tuple[tuple[int, str], ...]) -> str:
    """A triangle over the whole picture; every input is the texture coordinate, 0 .. 1, row 0 at 0."""
    wide = {
        "vec2": ("vec2f", "place"),
        "vec3": ("vec3f", "vec3f(place, 0.0)"),
        "vec4": ("vec4f", "vec4f(place, 0.0, 1.0)"),
    }
    members = "".join(f"    @location({place}) at{place}: {wide[kind][0]},\n" for place, kind in inputs)
    fills = "".join(f"    out.at{place} = {wide[kind][1]};\n" for place, kind in inputs)
    return (
        f"struct Out {{\n    @builtin(position) position: vec4f,\n{members}}}\n"
        "@vertex fn corner(@builtin(vertex_index) index: u32) -> Out {\n"
        "    let place = vec2f(select(0.0, 2.0, index == 1u), select(0.0, 2.0, index == 2u));\n"
        "    var out: Out;\n"
        f"    out.position = vec4f(2.0 * place.x - 1.0, 1.0 - 2.0 * place.y, 0.0, 1.0);\n{fills}"
        "    return out;\n}\n"
    )


def compiler_message(said: str) -> str:
    """The first error of a WGSL compiler, with the line of the text where it has one."""
    lines = [line.strip() for line in said.splitlines() if line.strip()]
    first = next((line for line in lines if "error:" in line), lines[-1] if lines else "no reason given")
    first = first.partition("error:")[2].strip() or first
    place = re.search(r"wgsl:(\d+):\d+", said)
    return f"line {place[1]}: {first}" if place else first


def _variable(
    attributes: str, space: str, name: str, kind: str, structs: dict[str, list[tuple[str, str, str]]]
) -> Variable:
    group, binding = (int(_number(attributes, word) or 0) for word in ("group", "binding"))
    if kind == "texture_2d<f32>":
        return Variable(name, "texture", group, binding)
    if kind == "sampler":
        return Variable(name, "sampler", group, binding)
    if kind == "texture_storage_2d<rgba32float,write>":
        return Variable(name, "storage", group, binding)
    if space == "uniform":
        members, size = _members(structs.get(kind, [("", name, kind)]))
        return Variable(name, "uniform", group, binding, members, size)
    allowed = "texture_2d<f32>, sampler, var<uniform>, and one texture_storage_2d<rgba32float, write>"
    raise ShaderFault(f"{name}: is of type {kind}; allowed are {allowed}")


def _members(parts: list[tuple[str, str, str]]) -> tuple[tuple[Member, ...], int]:
    """Members of a uniform struct that hold numbers, and its size [bytes], by WGSL's rules of layout."""
    members, end = [], 0
    for attributes, name, kind in parts:
        if kind not in _TYPES or attributes:
            raise ShaderFault(f"{name}: is of type {attributes}{kind} in a uniform; allowed are numbers and vectors")
        slot, size, alignment = _TYPES[kind]
        offset = -(-end // alignment) * alignment
        end = offset + size
        if not _PADDING.fullmatch(name):
            members.append(Member(name, slot, offset))
    return tuple(members), -(-end // 16) * 16


def _inputs(arguments: str, structs: dict[str, list[tuple[str, str, str]]]) -> tuple[tuple[int, str], ...]:
    """Locations and types of what a fragment reads, all of which are texture coordinates."""
    parts = [part for one in _parts(arguments) for part in structs.get(one[2], [one])]
    found = []
    for attributes, name, kind in parts:
        if "@location" not in attributes:
            continue
        slot = _TYPES.get(kind, ("", 0, 0))[0]
        if slot not in ("vec2", "vec3", "vec4"):
            raise ShaderFault(f"{name}: is an input, {kind}; allowed are texture coordinates, vec2f")
        found.append((int(_number(attributes, "location") or 0), slot))
    return tuple(found)


def _parts(body: str) -> list[tuple[str, str, str]]:
    """Attributes, names and types of members or arguments."""
    return [(attributes.strip(), name, _tight(kind)) for attributes, name, kind in re.findall(
        _ATTRIBUTES + r"(\w+)\s*:\s*(\w+\s*(?:<[^>]*>)?)", body
    )]  # fmt: skip


def _inside(text: str, start: int) -> str:
    """What stands between the bracket at `start` and the one that closes it."""
    depth = 0
    for place in range(start, len(text)):
        depth += (text[place] == "(") - (text[place] == ")")
        if depth == 0:
            return text[start + 1 : place]
    return text[start + 1 :]


def _number(attributes: str, word: str) -> str | None:
    found = re.search(rf"@{word}\s*\(\s*(\d+)", attributes)
    return found[1] if found else None


def _tight(kind: str) -> str:
    return re.sub(r"\s+", "", kind).rstrip(",").replace(",>", ">")
