"""The single pass as a GLSL fragment shader, within the bounds of small cases, and planted faults in it.

The article's own listing is drawn in `tests/gl/test_singlepass_gl.py`.
"""

from pathlib import Path

import pytest

from tests.gl import shader
from tests.ports.cases import CASES, FAR, FOCUS, caught, mutated, outside

pytestmark = pytest.mark.gl

ROOT = Path(__file__).parents[2]
SOURCE = (ROOT / "ports" / "glsl" / "singlepass.frag").read_text()

FAULTS = {
    "the loop ends at half its bound": ("radius < uMaxBlurSize;", "radius < 0.5 * uMaxBlurSize;"),
    "the loop ends by an angle": ("radius < uMaxBlurSize;", "radius < uMaxBlurSize && angle < 600.0;"),
    "the first tap is skipped": ("float radius = uRadScale;", "float radius = 2.0 * uRadScale;"),
    "the radius grows by a constant": ("radius += uRadScale / radius;", "radius += uRadScale;"),
    "the radius grows before the rim is found": ("(radius - 0.5, radius + 0.5,", "(radius + 0.5, radius + 1.5,"),
    "the largest circle is the listing's": ("return abs(coc) * uMaxBlurSize;", "return abs(coc) * 20.0;"),
    "the spiral is mirrored": ("vec2(cos(angle), sin(angle))", "vec2(cos(angle), -sin(angle))"),
    "the spiral is transposed": ("vec2(cos(angle), sin(angle))", "vec2(sin(angle), cos(angle))"),
    "a wrong digit of the golden angle": ("2.39996323", "2.39966323"),
    "the angle is advanced first": ("float angle = 0.0;", "float angle = GOLDEN_ANGLE;"),
    "the ellipse of a scalar pixel size": ("* uPixelSize * radius", "* uPixelSize.x * radius"),
    "the pixel size of a fixed picture": ("* uPixelSize * radius", "/ vec2(1920.0, 1080.0) * radius"),
    "the pixel at its corner": ("gl_FragCoord.xy * uPixelSize)", "floor(gl_FragCoord.xy) * uPixelSize)"),
    "half a pixel added": ("gl_FragCoord.xy * uPixelSize)", "(gl_FragCoord.xy + 0.5) * uPixelSize)"),
    "colour at the nearest texel": (
        "texture(uTexture, place).rgb",
        "texelFetch(uTexture, clamp(ivec2(floor(place / uPixelSize)), ivec2(0), textureSize(uTexture, 0) - 1), 0).rgb",
    ),
    "taps wrap": ("vec3 tapColor = texture(uTexture, place)", "vec3 tapColor = texture(uTexture, fract(place))"),
    "circles are not cut": (
        "float coc = clamp((1.0 / focusPoint - 1.0 / depth) * focusScale, -1.0, 1.0);",
        "float coc = (1.0 / focusPoint - 1.0 / depth) * focusScale;",
    ),
    "near circles are lost": ("focusScale, -1.0, 1.0)", "focusScale, 0.0, 1.0)"),
    "circles are linear in depth": ("(1.0 / focusPoint - 1.0 / depth)", "((depth - focusPoint) / focusPoint)"),
    "diameters": ("return abs(coc) * uMaxBlurSize;", "return 2.0 * abs(coc) * uMaxBlurSize;"),
    "depth is not scaled at the tap": ("texture(uDepth, place).r * uFar", "texture(uDepth, place).r"),
    "depth is not scaled at the centre": ("texture(uDepth, texCoord).r * uFar", "texture(uDepth, texCoord).r"),
    "the limit is the listing's": ("centerSize * uBehindFactor", "centerSize * 2.0"),
    "the order is by size": ("tapDepth > centerDepth", "tapSize > centerSize"),
    "no limit from behind": ("centerSize * uBehindFactor", "uMaxBlurSize"),
    "the limit of the text": ("centerSize * uBehindFactor", "centerSize"),
    "the other side is limited": ("tapDepth > centerDepth", "tapDepth < centerDepth"),
    "a hard rim": ("smoothstep(radius - 0.5, radius + 0.5, tapSize)", "step(radius, tapSize)"),
    "the centre's size decides": ("radius + 0.5, tapSize)", "radius + 0.5, centerSize)"),
    "no mean where a tap misses": ("mix(color / total, tapColor, m)", "tapColor * m"),
    "the mean is the sum": ("mix(color / total, tapColor, m)", "mix(color, tapColor, m)"),
    "the total starts at nothing": ("float total = 1.0;", "float total = 1e-6;"),
    "a tone map": (
        "fragColor = vec4(depthOfField(gl_FragCoord.xy * uPixelSize), 1.0);",
        "fragColor = min(vec4(depthOfField(gl_FragCoord.xy * uPixelSize), 1.0), 1.0);",
    ),
}


def picture_of(context, source, case, given, fault=None):
    """What a shader draws of a case, (H, W, 3), with the uniforms `given` by the names of those that it has."""
    color, depth, _ = case.inputs
    depth = depth[::-1] if fault == "rows of depth are flipped" else depth
    work = shader.new_pass(context, source, depth.shape)
    textures = {
        "uTexture": shader.texture_of(context, color, linear=fault != "colour is not"),
        "uDepth": shader.texture_of(context, depth / depth.dtype.type(FAR), linear=fault == "depth is filtered"),
    }
    textures["uTexture"].repeat_x = fault == "colour wraps"
    # A fault may leave a name unused, which the compiler then drops.
    used = {name: value for name, value in given.items() if name in work.program}
    shader.draw(work, {name: texture for name, texture in textures.items() if name in work.program}, **used)
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


@pytest.mark.parametrize("fault", FAULTS)
def test_no_planted_fault_passes(fault, context):
    source = mutated(SOURCE, *FAULTS[fault])
    found = caught(lambda case: picture_of(context, source, case, uniforms_of(case)))
    print(f"{fault}: {found}")
    assert found is not None


@pytest.mark.parametrize("fault", ["depth is filtered", "colour is not", "colour wraps", "rows of depth are flipped"])
def test_a_host_that_feeds_it_wrongly_is_caught(fault, context):
    assert caught(lambda case: picture_of(context, SOURCE, case, uniforms_of(case), fault)) is not None


LISTED = [case for case in CASES if (case.max_blur_size, case.rad_scale, case.behind_factor) == (20.0, 0.5, 2.0)]


@pytest.mark.parametrize("case", LISTED, ids=lambda case: case.name)
def test_constants_that_a_host_does_not_set_are_the_listing_s(case, context):
    few = {name: value for name, value in uniforms_of(case).items() if name[:4] not in ("uMax", "uRad", "uBeh")}
    assert len(few) == 4
    assert outside(picture_of(context, SOURCE, case, few), case) <= 1.0
