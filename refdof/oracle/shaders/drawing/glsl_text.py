"""GLSL as porters ship it, made a whole fragment shader of version 3.30 without a change of its line numbers.

1. Older and embedded dialects become version 3.30            `_head`
2. A text without main gets one: of ShaderToy, of a function  `_tail`
3. A vertex shader fills its inputs with texture coordinates  `vertex_shader`
"""

import re
from typing import NamedTuple

from .slots import COUNTS, ShaderFault

__all__ = ["Fragment", "compiler_message", "has_initial_value", "vertex_shader", "whole_fragment"]

_OLDEST = 330
_SUCCESSORS = {  # by three.js and others the same way
    "varying": "in",
    "texture2D": "texture",
    "texture2DLod": "textureLod",
    "texture2DLodEXT": "textureLod",
    "texture2DProj": "textureProj",
    "gl_FragColor": "refdof_color",
    "gl_FragData": "refdof_data",
}
_SHADERTOY = {
    **{f"iChannel{k}": "sampler2D" for k in range(4)},
    "iResolution": "vec3",
    "iTime": "float",
    "iTimeDelta": "float",
    "iFrame": "int",
    "iMouse": "vec4",
}
_FUNCTION = re.compile(r"\b(vec[34])\s+(\w+)\s*\(([^()]*)\)\s*\{")
_INPUT = re.compile(
    r"(?m)(?:^|;|\})\s*(?:layout\s*\([^)]*\)\s*)?((?:(?:smooth|noperspective|centroid|flat)\s+)*)(?:in|varying)\s+"
    r"(?:(?:highp|mediump|lowp)\s+)?(\w+)\s*([\w\s,]*)([;{\[])"
)
_OUTPUT = re.compile(r"\bout\s+(?:(?:highp|mediump|lowp)\s+)?vec[34]\s+\w+\s*;")


class Fragment(NamedTuple):
    """A whole fragment shader, and its inputs: names and types."""

    text: str
    inputs: tuple[tuple[str, str], ...]


def whole_fragment(text: str) -> Fragment:
    """Make a text a fragment shader of version 3.30 or newer.

    Raises
    ------
    ShaderFault
        If there is nothing to call, nothing is written, or an input is no texture coordinate.
    """
    bare = _without_comments(text)
    version, line = _version(bare)
    lines = text.splitlines()
    for number in range(line):
        lines[number] = ""
    old = version < _OLDEST
    if old:
        lines = ["" if re.match(r"\s*#\s*extension\b", one) else one for one in lines]
    head, tail, written = _head(bare, old), "", bool(re.search(r"\bgl_Frag(Color|Data)\b", bare))
    if not re.search(r"\bvoid\s+main\s*\(", bare):
        toys, tail = _tail(bare)
        head, written = head + toys, True
    if not (written or _OUTPUT.search(bare)):
        raise ShaderFault("writes no colour; allowed is an `out vec4`, or gl_FragColor")
    whole = [f"#version {max(version, _OLDEST)}", *head, "#line 1", *lines, *tail.splitlines()]
    return Fragment("\n".join(whole) + "\n", _inputs(bare) + ((("refdof_texCoord", "vec2"),) if tail else ()))


def vertex_shader(inputs: tuple[tuple[str, str], ...]) -> str:
    """A triangle over the whole picture; every input is the texture coordinate, 0 .. 1, row 0 at 0."""
    wide = {"vec2": "place", "vec3": "vec3(place, 0.0)", "vec4": "vec4(place, 0.0, 1.0)"}
    outputs = "".join(f"out {kind} {name};\n" for name, kind in inputs)
    fills = "".join(f"    {name} = {wide[kind]};\n" for name, kind in inputs)
    return (
        f"#version {_OLDEST}\n{outputs}void main()\n{{\n"
        "    vec2 place = vec2(gl_VertexID == 1 ? 2.0 : 0.0, gl_VertexID == 2 ? 2.0 : 0.0);\n"
        f"    gl_Position = vec4(2.0 * place - 1.0, 0.0, 1.0);\n{fills}}}\n"
    )


def has_initial_value(text: str, name: str) -> bool:
    """Whether a uniform is declared with a value."""
    pattern = rf"\buniform\b[^;{{}}]*\b{re.escape(name)}\s*(?:\[[^\]]*\])?\s*="
    return re.search(pattern, _without_comments(text)) is not None


def compiler_message(said: str) -> str:
    """The first error of a GLSL compiler or linker, with the line of the text where it has one."""
    lines = [line.strip() for line in said.splitlines() if line.strip()]
    first = next((line for line in lines if "error" in line.lower()), lines[-1] if lines else "no reason given")
    found = re.match(r"0:(\d+)\(\d+\): (?:error: )?(.*)", first)  # as Mesa writes it
    return f"line {found[1]}: {found[2]}" if found else first


def _without_comments(text: str) -> str:
    """The text with comments blanked, line for line."""
    return re.sub(r"//[^\n]*|/\*.*?\*/", lambda found: re.sub(r"[^\n]", " ", found[0]), text, flags=re.DOTALL)


def _version(bare: str) -> tuple[int, int]:
    """The version that the text names, 0 if none or of an embedded dialect, and the line after it."""
    found = re.match(r"\s*#\s*version\s+(\d+)[ \t]*(\w*)", bare)
    if found is None:
        return 0, 0
    embedded = found[2] == "es" or int(found[1]) == 100
    return 0 if embedded else int(found[1]), bare[: found.end()].count("\n") + 1


def _head(bare: str, old: bool) -> list[str]:
    """Lines that make words of older dialects those of version 3.30."""
    if not old:
        return []
    used = [word for word in _SUCCESSORS if re.search(rf"\b{word}\b", bare)]
    head = [f"#define {word} {_SUCCESSORS[word]}" for word in used]
    if "gl_FragColor" in used:
        head.append("layout(location = 0) out vec4 refdof_color;")
    if "gl_FragData" in used:
        head.append("layout(location = 0) out vec4 refdof_data[1];")
    return head


def _tail(bare: str) -> tuple[list[str], str]:
    """Declarations before the text and a main after it, for a text that has none."""
    out = "\n#line 1 1\nin vec2 refdof_texCoord;\nlayout(location = 0) out vec4 refdof_result;\n"
    if re.search(r"\bvoid\s+mainImage\s*\(", bare):
        used = [name for name in _SHADERTOY if re.search(rf"\b{name}\b", bare) and not _is_uniform(bare, name)]
        return [
            f"uniform {_SHADERTOY[name]} {name};" for name in used
        ], out + "void main() { refdof_result = vec4(1.0); mainImage(refdof_result, gl_FragCoord.xy); }\n"
    for kind, name, arguments in reversed(_FUNCTION.findall(bare)):
        parts = [part.split() for part in arguments.split(",") if part.strip()]
        parts = [[word for word in part if word not in ("in", "const", "highp", "mediump", "lowp")] for part in parts]
        places = [part for part in parts if part[0] == "vec2"]
        if len(places) != 1 or not all(len(part) == 2 and part[0] in COUNTS for part in parts):
            continue
        others = [part for part in parts if part[0] != "vec2" and not _is_uniform(bare, part[1])]
        declared = "".join(f"uniform {' '.join(part)};\n" for part in others)
        given = ", ".join("refdof_texCoord" if part[0] == "vec2" else part[1] for part in parts)
        value = f"{name}({given})" if kind == "vec4" else f"vec4({name}({given}), 1.0)"
        return [], f"{out}{declared}void main() {{ refdof_result = {value}; }}\n"
    raise ShaderFault("has no main; allowed are main, mainImage, or a function of one vec2 that returns vec3 or vec4")


def _is_uniform(bare: str, name: str) -> bool:
    return re.search(rf"\buniform\b[^;]*\b{name}\b", bare) is not None


def _inputs(bare: str) -> tuple[tuple[str, str], ...]:
    """Inputs of the text, all of which are texture coordinates."""
    found = []
    for match in _INPUT.finditer(bare):
        before, kind, names = bare[: match.start(2)], match[2], match[3].strip()
        if before.count("(") > before.count(")") or before.count("{") > before.count("}"):
            continue  # an argument
        if match[4] != ";" or kind not in ("vec2", "vec3", "vec4"):
            raise ShaderFault(
                f"{kind} {names}: is an input of a kind that is not drawn; allowed are texture coordinates, `in vec2`"
            )
        found += [(name.strip(), kind) for name in names.split(",")]
    return tuple(found)
