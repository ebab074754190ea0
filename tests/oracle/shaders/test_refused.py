"""Shaders in GLSL that cannot be drawn are refused in one line."""

import re

import pytest

from refdof import InputError
from refdof.oracle import check_shader
from tests.oracle.shaders.cases import GLSL, PORTS, refusal
from tests.ports.cases import mutated

pytestmark = pytest.mark.gl

SUFFIX = "frag"


REFUSED = {
    "a name is not declared": (
        mutated(GLSL, "return color / total;", "return colour / total;"),
        rf"line {GLSL[: GLSL.index('return color / total;')].count(chr(10)) + 1}: .*colour",
    ),
    "a comma is lost, version of its own": ("// one\nuniform vec2 a\nvoid main() { gl_FragColor = a; }", "line 3: "),
    "an input is no coordinate": (GLSL.replace("out vec4", "flat in int id;\nout vec4"), "int id: is an input"),
    "no output": ("#version 330\nvoid main() { }", "writes no colour"),
    "no main": ("#version 330\nuniform float far;", "has no main"),
    "a uniform of unknown meaning": (
        mutated(GLSL, "return color / total;", "return color / total * uMystery;").replace(
            "out vec4", "uniform float uMystery;\nout vec4"
        ),
        r"uMystery: is a uniform \(float\) that nothing binds; .*focusscale",
    ),
    "a texture of unknown meaning": (GLSL.replace("uDepth", "uThing"), "uThing: is a texture of unknown meaning.*coc"),
    "a scalar pixel size": (
        GLSL.replace("uniform vec2 uPixelSize", "uniform float uPixelSize"),
        "uPixelSize: is float, 1 numbers; allowed are the 2",
    ),
}


ODD = {  # the type of a uniform: what reads it
    "sampler1D": "texture(uThing, 0.5)",
    "sampler3D": "texture(uThing, vec3(0.5))",
    "samplerCube": "texture(uThing, vec3(0.5))",
    "sampler2DArray": "texture(uThing, vec3(0.5))",
    "sampler2DShadow": "vec4(texture(uThing, vec3(0.5)))",
    "sampler2DRect": "texture(uThing, vec2(0.5))",
    "samplerBuffer": "texelFetch(uThing, 0)",
    "sampler2DMS": "texelFetch(uThing, ivec2(0), 0)",
    "isampler2D": "vec4(texture(uThing, vec2(0.5)))",
    "usampler2D": "vec4(texture(uThing, vec2(0.5)))",
    "isampler2DArray": "vec4(texture(uThing, vec3(0.5)))",
    "usamplerBuffer": "vec4(texelFetch(uThing, 0))",
    "sampler2D[2]": "texture(uThing[0], vec2(0.5)) + texture(uThing[1], vec2(0.5))",
    "float[3]": "vec4(uThing[0] + uThing[2])",
    "mat2": "vec4(uThing[0], uThing[1])",
    "mat4x3": "vec4(uThing * vec4(0.5), 1.0)",
}


@pytest.mark.parametrize("kind", ODD)
def test_odd_types_are_named(outcomes, kind):
    text = f"#version 330\nuniform {kind} uThing;\nout vec4 color;\nvoid main() {{ color = {ODD[kind]}; }}"
    told = refusal(outcomes, text)
    assert told.startswith(f"shader: shader.frag: uThing: is of type {kind}; allowed are sampler2D, ")
    assert "\n" not in told


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_drawn_is_told_once(outcomes, name):
    text, said = REFUSED[name]
    told = refusal(outcomes, text)
    assert re.search(said, told)
    assert "\n" not in told


def test_what_is_not_installed_is_named(pack, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"^shader: needs moderngl, which is not installed: pip install"):
        check_shader(PORTS / "glsl" / "singlepass.frag", pack)


@pytest.mark.parametrize(
    ("name", "content"),
    [("shader.hlsl", b"x"), ("shader.frag", b""), ("shader.frag", b"\xff\xfe"), ("shader.frag", b"a\0b")],
)
def test_files_that_are_no_shaders(pack, tmp_path, name, content):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError, match=r"^shader: got"):
        check_shader(tmp_path / name, pack)
