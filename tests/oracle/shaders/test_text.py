"""What is read from a shader's text and from bindings: names, dialects, layouts, expressions."""

import io
import subprocess
import sys

import numpy as np
import pytest

from refdof import InputError
from refdof.oracle.shaders.drawing import glsl_text, wgsl_text
from refdof.oracle.shaders.drawing.messages import receive, send
from refdof.oracle.shaders.drawing.slots import ShaderFault
from refdof.oracle.shaders.expressions import evaluate, names_in, parsed
from refdof.oracle.shaders.names import sampler_meaning, usual_number, usual_texture

pytestmark = pytest.mark.fast

KEYS = {"max_blur_size", "rad_scale", "behind_factor", "loop_bound", "max_taps", "far", "near", "focus", "width"}


@pytest.mark.parametrize(
    ("names", "meaning"),
    [
        ("uTexture tDiffuse colorTexture iChannel0 u_texture MainTex _MainTex inputImageTexture sDiffMap", "color"),
        ("uDepth tDepth depthTexture u_depthMap sceneDepth DepthBuffer", "depth / far"),
        ("uCoc tCoC cocTexture", "coc"),
        ("uNormals tNoise iChannel1 lut", None),
    ],
)
def test_usual_textures(names, meaning):
    assert {usual_texture(name) for name in names.split()} == {meaning}


@pytest.mark.parametrize(
    ("names", "count", "meaning"),
    [
        ("uPixelSize texelSize u_texel_size", 2, "1 / width, 1 / height"),
        ("_MainTex_TexelSize", 4, "1 / width, 1 / height, width, height"),
        ("iResolution uResolution", 3, "width, height, 1"),
        ("resolution u_resolution screenSize", 2, "width, height"),
        ("uFar cameraFar zFar cFar farPlane", 1, "far"),
        ("CameraNearFar", 2, "near, far"),
        ("g_z_near cameraNear", 1, "near"),
        ("focusPoint uFocus focalDepth focusDistance", 1, "focus"),
        ("focusScale uFocusScale", 1, "coc_scale / max_blur_size"),
        ("uMaxBlurSize MAX_BLUR_SIZE maxBlur", 1, "max_blur_size"),
        ("uRadScale RAD_SCALE radiusScale", 1, "rad_scale"),
        ("uLoopBound loop_bound", 1, "loop_bound"),
        ("uMaxTaps", 1, "max_taps"),
        ("uMystery aperture", 1, None),
    ],
)
def test_usual_numbers(names, count, meaning):
    assert {usual_number(name, count, KEYS) for name in names.split()} == {meaning}


def test_usual_samplers():
    assert [sampler_meaning(name) for name in ("linearSampler", "pointSampler", "depthSampler", "mySampler")] == [
        "linear", "nearest", "depth / far", None,
    ]  # fmt: skip


def test_expressions():
    values = {"a": 6.0, "b": np.array([1.0, 2.0, 0.0])}
    assert evaluate(parsed("x", "-(a - 2) / 4 + 1e1"), values) == 9.0
    assert evaluate(parsed("x", "1 / a, a"), values) == (1.0 / 6.0, 6.0)
    assert np.array_equal(evaluate(parsed("x", "a / b"), values), [6.0, 3.0, np.inf])
    assert names_in(parsed("x", "a * (b + a)")) == {"a", "b"}


@pytest.mark.parametrize(
    "text",
    [
        "",
        "a b",
        "a ** 2",
        "f(a)",
        "a.b",
        "'a'",
        "a if b else c",
        "[a]",
        "(a, (b, c))",
        "True",
        "a[0]",
        "1j",
        "a" * 999,
        "(" * 900,
    ],
)
def test_what_is_no_expression(text):
    with pytest.raises(InputError, match=r"^x: got .*allowed are numbers"):
        parsed("x", text)


def test_lines_of_a_shader_stay_where_they_are():
    text = "// a\n#version 100\n#extension GL_x : enable\nvarying vec2 uv;\nvoid main() { gl_FragColor = c; }\n"
    fragment = glsl_text.whole_fragment(text)
    lines = fragment.text.splitlines()
    start = lines.index("#line 1") + 1
    assert lines[0] == "#version 330"
    assert lines[start : start + 5] == ["", "", "", *text.splitlines()[3:]]
    assert fragment.inputs == (("uv", "vec2"),)


def test_inputs():
    text = "in vec2 a;\nin highp vec3 b, c;\nvec3 f(\n in vec2 d,\n in float e) { return b; }\n"
    text += "out vec4 o;\nvoid main() { }"
    assert glsl_text.whole_fragment(text).inputs == (("a", "vec2"), ("b", "vec3"), ("c", "vec3"))


def test_a_main_of_our_own_declares_what_the_text_does_not():
    text = "uniform vec3 iResolution;\nvoid mainImage(out vec4 c, in vec2 p) { c = texture(iChannel0, p); }"
    declared = [line for line in glsl_text.whole_fragment(text).text.splitlines() if line.startswith("uniform")]
    assert declared == ["uniform sampler2D iChannel0;", "uniform vec3 iResolution;"]
    text = "uniform float focus;\nvec3 blur(vec2 uv, float focus, int count) { return vec3(uv, focus); }"
    fragment = glsl_text.whole_fragment(text).text
    assert [line for line in fragment.splitlines() if line.startswith("uniform")] == [
        "uniform float focus;", "uniform int count;",
    ]  # fmt: skip
    assert "blur(refdof_texCoord, focus, count)" in fragment


def test_newer_shaders_are_left_alone():
    text = "#version 450 core\nin vec2 at;\nout vec4 c;\nvoid main() { c = vec4(at, 0, 1); }"
    assert glsl_text.whole_fragment(text).text.splitlines()[:3] == ["#version 450", "#line 1", ""]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("in float fade; out vec4 c; void main() { c = vec4(fade); }", "float fade"),
        ("in Block { vec2 uv; } block; out vec4 c; void main() { c = vec4(block.uv, 0, 1); }", "Block"),
        ("vec3 blur(vec2 a, vec2 b) { return vec3(a, b.x); }", "has no main"),
        ("float blur(vec2 a) { return a.x; }", "has no main"),
        ("/* out vec4 c; */ void main() { }", "writes no colour"),
    ],
)
def test_shaders_that_cannot_be_drawn(text, said):
    with pytest.raises(ShaderFault, match=said):
        glsl_text.whole_fragment(text)


def test_initial_values():
    text = "uniform float a = 1.0;\n// uniform float b = 2.0;\nuniform float b; uniform lowp vec2 c=vec2(0.0);"
    assert [glsl_text.has_initial_value(text, name) for name in "abc"] == [True, False, True]


@pytest.mark.parametrize(
    ("said", "line"),
    [
        ("GLSL Compiler failed\n\n0:12(5): error: `x' undeclared\n0:13(5): error: more", "line 12: `x' undeclared"),
        ("GLSL Linker failed\n\nerror: fragment shader lacks `main'", "error: fragment shader lacks `main'"),
        ("", "no reason given"),
    ],
)
def test_the_first_message_of_a_compiler(said, line):
    assert glsl_text.compiler_message(said) == line


def test_uniforms_lie_where_wgsl_has_them():
    """Offsets by hand, from the table of alignments in the WGSL specification, section 14.4.1."""
    module = wgsl_text.module_of(
        "struct S { a: f32, b: vec3<f32>, c: f32, d: vec2f, e: u32, f: vec4f, _pad: f32 };\n"
        "@group(0) @binding(2) var<uniform> s: S;\n@binding(0) @group(1) var t : texture_2d<f32>;\n"
        "// @group(0) @binding(9) var<storage> no: array<f32>;\n"
        "@fragment fn main(@location(1) uv: vec2<f32>) -> @location(0) vec4f { return s.f; }"
    )
    uniform, texture = module.variables
    assert [(member.name, member.type, member.offset) for member in uniform.members] == [
        ("a", "float", 0), ("b", "vec3", 16), ("c", "float", 28), ("d", "vec2", 32), ("e", "uint", 40),
        ("f", "vec4", 48),
    ]  # fmt: skip
    assert (uniform.size, uniform.group, uniform.binding) == (80, 0, 2)
    assert (texture.kind, texture.group, texture.binding) == ("texture", 1, 0)
    assert module.inputs == ((1, "vec2"),)


def test_messages_hold_arrays():
    stream = io.BytesIO()
    image = np.arange(6.0).reshape(1, 2, 3)
    send(stream, {"do": "draw"}, {"image": image[:, ::-1]})
    stream.seek(0)
    message, arrays = receive(stream)
    assert message == {"do": "draw"}
    assert np.array_equal(arrays["image"], image[:, ::-1])
    stream.seek(0)
    with pytest.raises(EOFError):
        receive(io.BytesIO(stream.read()[:-1]))


def test_what_a_driver_prints_is_no_answer():
    code = """
import os
import refdof.oracle.shaders.drawing.worker as worker
class Drawer:
    def compile(self, text):
        os.write(1, b"a driver speaks")
        return []
worker._drawer = lambda language: Drawer()
worker.answer_all()
"""
    question = io.BytesIO()
    send(question, {"do": "compile", "language": "glsl", "text": ""}, {})
    done = subprocess.run([sys.executable, "-c", code], input=question.getvalue(), capture_output=True, check=True)
    assert receive(io.BytesIO(done.stdout))[0] == {"slots": []}
    assert done.stderr == b"a driver speaks"
