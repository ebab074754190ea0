"""Shaders in WGSL: the port and other forms of it pass, wrong ones fail, and bad ones are told in one line."""

import re

import pytest

from refdof.oracle import check_shader
from tests.oracle.shaders.cases import CASES, CONSTANTS, CORE_STATUSES, PORTS, WGSL, core_statuses, refusal, statuses
from tests.ports.cases import mutated

pytestmark = pytest.mark.gl

SUFFIX = "wgsl"

COMPUTE = WGSL[: WGSL.index("@fragment")] + (
    "@group(1) @binding(0) var result: texture_storage_2d<rgba32float, write>;\n"
    "@compute @workgroup_size(8, 4) fn main(@builtin(global_invocation_id) at: vec3u) {\n"
    "    if (any(at.xy >= textureDimensions(result))) { return; }\n"
    "    let place = (vec2f(at.xy) + 0.5) * settings.uPixelSize;\n"
    "    textureStore(result, at.xy, vec4f(depthOfField(place), 1.0));\n}\n"
)
COORDINATE = WGSL.replace("@builtin(position) position: vec4f", "input: Input").replace(
    "position.xy * settings.uPixelSize", "input.uv"
)
COORDINATE += "struct Input { @builtin(position) position: vec4<f32>, @location(0) uv: vec2<f32> }\n"
OVERRIDES = WGSL.replace("settings.uMaxBlurSize", "MAX_BLUR_SIZE").replace("settings.uRadScale", "RAD_SCALE")
OVERRIDES = OVERRIDES.replace("    uMaxBlurSize: f32, ", "    _pad0: f32, ").replace(
    "    uRadScale: f32, ", "    _pad1: f32, "
)
OVERRIDES += "override MAX_BLUR_SIZE: f32 = 20.0;\noverride RAD_SCALE = 0.5;\n"
CONSTANT = OVERRIDES.replace("override", "const")

ALL = ["pass"] * len(CASES)
FORMS = {
    "compute": (COMPUTE, ALL),
    "a coordinate": (COORDINATE, ALL),
    "overrides": (OVERRIDES, ALL),
    "constants": (CONSTANT, CONSTANTS),
}


def test_the_port_passes_the_core_pack(tmp_path):
    assert core_statuses(PORTS / "wgsl" / "singlepass.wgsl", tmp_path) == CORE_STATUSES


def test_the_port_passes_every_case(pack):
    assert statuses(check_shader(PORTS / "wgsl" / "singlepass.wgsl", pack).outcomes) == ALL


@pytest.mark.parametrize("form", FORMS)
def test_other_forms(outcomes, form):
    text, expected = FORMS[form]
    found = outcomes(text)
    assert statuses(found) == expected, found


FAULTS = {
    "the spiral is mirrored": ("sin(angle)", "-sin(angle)"),
    "the position counts from 1": ("position.xy * settings", "(position.xy + 0.5) * settings"),
    "depth is filtered": ("textureSampleLevel(uDepth, depthSampler", "textureSampleLevel(uDepth, colorSampler"),
    "NaN": ("return color / total;", "return color / (total - total);"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_wrong_shaders_fail(outcomes, fault):
    bindings = 'colorSampler = "linear"' if fault == "depth is filtered" else None
    found = statuses(outcomes(mutated(WGSL, *FAULTS[fault]), bindings))
    assert "fail" in found
    assert "error" not in found


REFUSED = {
    "a name is not declared": (
        mutated(WGSL, "return color / total;", "return colour / total;"),
        rf"line {WGSL[: WGSL.index('return color / total;')].count(chr(10)) + 1}: .*colour",
    ),
    "no entry point": (WGSL.replace("@fragment\nfn main", "fn other"), "."),
    "a storage buffer": (
        WGSL + "@group(0) @binding(9) var<storage, read> more: array<f32>;\n",
        r"more: is of type array<f32>; allowed are",
    ),
    "a uniform of unknown meaning": (
        WGSL.replace("uBehindFactor", "uMystery"),
        r"uMystery: is a uniform \(float\) that nothing binds",
    ),
    "one sampler for two filters": (
        WGSL.replace("uDepth, depthSampler", "uDepth, colorSampler"),
        "colorSampler: reads textures of several filters",
    ),
    "an input is no coordinate": (
        WGSL.replace(
            "@builtin(position) position: vec4f", "@builtin(position) position: vec4f, @location(0) fade: f32"
        ),
        "fade: is an input, f32",
    ),
}


ODD = (
    "texture_1d<f32>", "texture_3d<f32>", "texture_cube<f32>", "texture_2d_array<f32>", "texture_2d<i32>",
    "texture_2d<u32>", "texture_depth_2d", "texture_multisampled_2d<f32>", "sampler_comparison",
)  # fmt: skip


@pytest.mark.parametrize("kind", ODD)
def test_odd_types_are_named(outcomes, kind):
    told = refusal(outcomes, WGSL + f"@group(0) @binding(9) var uThing: {kind};\n")
    assert told.startswith(f"shader: shader.wgsl: uThing: is of type {kind}; allowed are texture_2d<f32>, sampler, ")
    assert "\n" not in told


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_drawn_is_told_once(outcomes, name):
    text, said = REFUSED[name]
    told = refusal(outcomes, text)
    assert re.search(said, told)
    assert "\n" not in told
