"""The single pass as a GLSL fragment shader, within the bounds of small cases.

The article's own listing is drawn in `tests/gl/test_singlepass_gl.py`; faults are in `tests.oracle.mutations`.
"""

from pathlib import Path

import pytest

from tests.gl import shader
from tests.ports.cases import CASES, FAR, FOCUS, outside

pytestmark = pytest.mark.gl

ROOT = Path(__file__).parents[2]
SOURCE = (ROOT / "ports" / "glsl" / "singlepass.frag").read_text()


def picture_of(context, source, case, given):
    """What a shader draws of a case, (H, W, 3), with the uniforms `given` by the names of those that it has."""
    color, depth, _ = case.inputs
    work = shader.new_pass(context, source, depth.shape)
    textures = {
        "uTexture": shader.texture_of(context, color, linear=True),
        "uDepth": shader.texture_of(context, depth / depth.dtype.type(FAR), linear=False),
    }
    shader.draw(work, textures, **given)
    image = shader.read(work)[..., :3]
    for thing in (*textures.values(), *work.target.color_attachments, work.target, work.triangle, work.program):
        thing.release()
    return image


def uniforms_of(case):
    return {
        "uPixelSize": (1.0 / case.width, 1.0 / case.height),
        "uFar": FAR,
        "focusPoint": FOCUS,
        "focusScale": case.params["focus_scale"],
        "uMaxBlurSize": case.max_blur_size,
        "uRadScale": case.rad_scale,
        "uBehindFactor": case.behind_factor,
    }


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_every_case_is_within_its_bounds(case, context):
    image = picture_of(context, SOURCE, case, uniforms_of(case))
    print(f"{outside(image, case):.2f} tolerances")
    assert outside(image, case) <= 1.0


LISTED = [case for case in CASES if (case.max_blur_size, case.rad_scale, case.behind_factor) == (20.0, 0.5, 2.0)]


@pytest.mark.parametrize("case", LISTED, ids=lambda case: case.name)
def test_constants_that_a_host_does_not_set_are_the_listing_s(case, context):
    few = {name: value for name, value in uniforms_of(case).items() if name[:4] not in ("uMax", "uRad", "uBeh")}
    assert len(few) == 4
    assert outside(picture_of(context, SOURCE, case, few), case) <= 1.0
