"""Types of uniforms in GLSL, by the numbers that OpenGL has for them: "The OpenGL Graphics System" 4.6, table 7.3."""

__all__ = ["type_name"]


def _numbered(first: int, *names: str) -> dict[int, str]:
    return {first + k: name for k, name in enumerate(names)}


_SHAPES = ("1D", "2D", "3D", "Cube")
_TYPES = {
    0x1404: "int",
    0x1405: "uint",
    0x1406: "float",
    0x140A: "double",
    0x8B56: "bool",
    **_numbered(0x8B50, "vec2", "vec3", "vec4", "ivec2", "ivec3", "ivec4"),
    **_numbered(0x8B57, "bvec2", "bvec3", "bvec4", "mat2", "mat3", "mat4"),
    **_numbered(0x8B5D, *(f"sampler{shape}" for shape in _SHAPES), "sampler1DShadow", "sampler2DShadow"),
    **_numbered(0x8B63, "sampler2DRect", "sampler2DRectShadow"),
    **_numbered(0x8B65, "mat2x3", "mat2x4", "mat3x2", "mat3x4", "mat4x2", "mat4x3"),
    **_numbered(0x8DC0, "sampler1DArray", "sampler2DArray", "samplerBuffer"),
    **_numbered(0x8DC3, "sampler1DArrayShadow", "sampler2DArrayShadow", "samplerCubeShadow"),
    **_numbered(0x8DC6, "uvec2", "uvec3", "uvec4"),
    **{
        number: f"{prefix}sampler{shape}"
        for prefix, first in (("i", 0x8DC9), ("u", 0x8DD1))
        for number, shape in _numbered(first, *_SHAPES, "2DRect", "1DArray", "2DArray", "Buffer").items()
    },
    **_numbered(0x8FFC, "dvec2", "dvec3", "dvec4"),
    **_numbered(0x900C, "samplerCubeArray", "samplerCubeArrayShadow", "isamplerCubeArray", "usamplerCubeArray"),
    **_numbered(0x904C, "image1D", "image2D", "image3D"),
    **_numbered(0x9108, "sampler2DMS", "isampler2DMS", "usampler2DMS"),
    **_numbered(0x910B, "sampler2DMSArray", "isampler2DMSArray", "usampler2DMSArray"),
}


def type_name(number: int, length: int) -> str:
    """The type as GLSL writes it; with its length where it is an array."""
    name = _TYPES.get(number, f"{number:#x}")
    return name if length == 1 else f"{name}[{length}]"
