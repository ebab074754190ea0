"""The GLSL of docs/stability.md, as it stands there, on Mesa's software renderer: within its bounds of 50 digits."""

import json
import re
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.gl.shader import draw, new_pass, read, texture_of

ROOT = next(folder for folder in Path(__file__).parents if (folder / "pyproject.toml").exists())
sys.path.append(str(ROOT / "benchmarks"))

import cancellation  # noqa: E402

BLOCKS = re.findall(r"```glsl\n(.*?)```", (ROOT / "docs" / "stability.md").read_text(encoding="utf-8"), flags=re.DOTALL)
FIGURES = json.loads((ROOT / "docs" / "cancellation.json").read_text(encoding="utf-8"))

_SHADER = """
#version 400
uniform sampler2D a;
out vec4 value;
{helpers}
{function}
void main()
{{
    vec4 t = texelFetch(a, ivec2(gl_FragCoord.xy), 0);
    value = vec4({name}({arguments}));
}}
"""


def shader_of(formula, function):
    """A shader that calls a formula's function with up to four channels of a texture."""
    arguments = ", ".join(f"t.{channel}" for channel in "xyzw"[: len(formula.arguments)])
    return _SHADER.format(helpers=BLOCKS[0], function=function, name=formula.name, arguments=arguments)


def run(context, formula, arguments, function):
    """The function's results (N,) for arguments, float32 arrays (N,)."""
    texels = np.zeros((1, len(arguments[0]), 4), dtype=np.float32)
    for channel, array in enumerate(arguments):
        texels[0, :, channel] = array
    work = new_pass(context, shader_of(formula, function), texels.shape[:2])
    draw(work, {"a": texture_of(context, texels, linear=False)})
    return read(work)[0, :, 0]


def test_product_plus_keeps_what_a_product_loses(context):
    (circle,) = (formula for formula in cancellation.FORMULAS if formula.name == "circle")
    given = np.float32([1.0 + 2.0**-23]), np.float32([1.0 - 2.0**-23]), np.float32([-1.0])
    for function, wanted in (("product_plus(a, b, c)", -(2.0**-46)), ("a * b + c", 0.0)):
        called = f"float circle(float a, float b, float c) {{ return {function}; }}"
        assert run(context, circle, given, called)[0] == wanted


@pytest.mark.parametrize("formula", cancellation.FORMULAS, ids=lambda formula: formula.name)
def test_the_pages_shader_keeps_its_bound(context, formula):
    (function,) = (block for block in BLOCKS[1:] if f"float {formula.name}(" in block)
    inputs = cancellation.inputs_of(formula)
    found = cancellation.errors(inputs, run(context, formula, inputs.arguments, function)).max()
    assert found <= formula.shader_bound * 2.0**-23
    # What the naive form loses in NumPy, the page's form does not lose here.
    assert found < 0.01 * FIGURES[formula.name]["naive"]["worst"] or formula.name in ("reversed_depth", "mip_level")
