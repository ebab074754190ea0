"""Small packs and shaders of our own for the check of shaders, and what a machine needs to draw them."""

import os
from pathlib import Path

import pytest

from refdof import InputError
from refdof.oracle import check_shader
from refdof.oracle.cases import Case
from refdof.oracle.shaders import of_shader
from refdof.oracle.shaders.process import Process

ROOT = Path(__file__).parents[3]
PORTS, CORE = ROOT / "ports", ROOT / "data" / "packs" / "core"
GLSL = (PORTS / "glsl" / "singlepass.frag").read_text()
WGSL = (PORTS / "wgsl" / "singlepass.wgsl").read_text()

UP = {"row_order": "up"}
CASES = [
    Case("cards", "singlepass", "cards", (24, 18)),
    Case("noise", "singlepass", "noise", (17, 13)),
    Case("noise_up", "singlepass", "noise", (17, 13), UP, "up"),
    Case("noise_mirrored", "singlepass", "noise", (17, 13), UP),
    Case("noise_params", "singlepass", "noise", (17, 13), {"rad_scale": 1.0, "max_blur_size": 6.0}),
]
CONSTANTS = ["pass"] * 4 + ["not supported"]  # of a shader that has the listing's constants

# The loop as an older dialect has it, with all constants in the text, and drawn by nobody.
LOOP = """
float sizeAt(float d, float focus, float scale)
{
    return MAX_BLUR_SIZE * abs(clamp(scale * (1.0 / focus - 1.0 / d), -1.0, 1.0));
}

vec3 gather(vec2 uv, float focus, float focusScale)
{
    float here = DEPTH(uv);
    float limit = 2.0 * sizeAt(here, focus, focusScale);
    vec3 sum = texture2D(tDiffuse, uv).rgb;
    float count = 1.0;
    float r = 0.5;
    for (float a = 0.0; r < MAX_BLUR_SIZE; a += 2.39996323) {
        vec2 at = uv + r * texelSize * vec2(cos(a), sin(a));
        float there = DEPTH(at);
        float size = sizeAt(there, focus, focusScale);
        if (there > here) size = min(size, limit);
        sum += mix(sum / count, texture2D(tDiffuse, at).rgb, smoothstep(r - 0.5, r + 0.5, size));
        count += 1.0;
        r += 0.5 / r;
    }
    return sum / count;
}
"""
HEAD = """
precision highp float;
uniform sampler2D tDiffuse;
uniform sampler2D tDepth;
uniform vec2 texelSize;
#define MAX_BLUR_SIZE 20.0
"""
PLANAR = "uniform float cameraFar;\n#define DEPTH(p) (cameraFar * texture2D(tDepth, p).r)\n"
DEVICE = (
    "uniform float cameraNear, cameraFar;\n#define DEPTH(p) "
    "(cameraNear * cameraFar / (cameraFar - texture2D(tDepth, p).r * (cameraFar - cameraNear)))\n"
)
REVERSED = (
    "uniform float cameraNear, cameraFar;\n#define DEPTH(p) "
    "(cameraNear * cameraFar / (cameraNear + texture2D(tDepth, p).r * (cameraFar - cameraNear)))\n"
)
VARYING = (
    "varying vec2 vUv;\nuniform float focusDistance, focusScale;\n",
    "void main() { gl_FragColor = vec4(gather(vUv, focusDistance, focusScale), 1.0); }\n",
)


def varying(depth=PLANAR):
    """A shader as three.js has them: varying, texture2D, gl_FragColor, no version."""
    return HEAD + depth + VARYING[0] + LOOP + VARYING[1]


def function_only():
    """A function without a main, as articles print them, with the numbers of focus as arguments."""
    return (HEAD + PLANAR + LOOP).replace("texture2D", "texture").replace("precision highp float;", "")


class Kept:
    """One process for many shaders, in place of `Process`: to start one takes longer than to draw."""

    def __init__(self):
        self.process = None

    def __call__(self):
        if self.process is None or self.process._process.poll() is not None:
            self.process = Process()
            self.end, self.process.stop = self.process.stop, lambda: None
        return self.process

    def close(self):
        if self.process is not None:
            self.end()


def statuses(outcomes):
    return [outcome.status for outcome in outcomes]


CORE_STATUSES = {"singlepass": {"pass"}, "poisson": {"not supported"}}


def core_statuses(file, folder):
    """What a shader of `singlepass` is told about the cases of each method in the core pack."""
    if not CORE.is_dir():
        pytest.skip("there is no core pack beside the code")
    need(file.suffix[1:], folder)
    found = {}
    for outcome in check_shader(file, CORE).outcomes:
        found.setdefault(outcome.case.partition("_")[0], set()).add(outcome.status)
    return found


def refusal(outcomes, text):
    """What is said of a shader's text that is refused before any case."""
    with pytest.raises(InputError) as raised:
        outcomes(text)
    return str(raised.value)


def need(suffix, folder):
    """Skip where shaders of this kind cannot be drawn, or fail where REFDOF_REQUIRE_GL or _VULKAN is 1."""
    plain = {
        "frag": "#version 330\nout vec4 c; void main() { c = vec4(1.0); }",
        "wgsl": "@fragment fn main() -> @location(0) vec4f { return vec4f(1.0); }",
    }
    file = folder / f"plain.{suffix}"
    file.write_text(plain[suffix])
    try:
        of_shader(file).close()
    except InputError as missing:
        variable = {"frag": "REFDOF_REQUIRE_GL", "wgsl": "REFDOF_REQUIRE_VULKAN"}[suffix]
        if os.environ.get(variable) == "1":
            pytest.fail(f"{variable} is set, but: {missing}", pytrace=False)
        pytest.skip(str(missing))
