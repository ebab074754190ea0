"""Cascaded layers as fragment shaders: every layer, both buffers, their composition, and planted faults."""

import functools

import numpy as np
import pytest

from refdof import ThinLens
from refdof.methods.cascaded import Params, blur_buffers, layering_of
from refdof.stages import StageRecorder
from tests import flat_scene
from tests.gl.port import drawn, is_caught, source_of, with_fault

pytestmark = pytest.mark.gl

SOURCES = {name: source_of(name) for name in ("cascaded_layer", "cascaded_blur", "cascaded_compose")}

# Of values in [0, 1]. Ramps divide differences of depths: 2^-24 of a depth, 20 times as much of a ramp, 1e-6. Blurs
# weigh and add 40 taps, and an exp may be off by 16 units in the last place, 2e-6, which are in the sum of weights,
# too; up to four of them take over each other's errors. The last division is by an alpha above 1/2.
LAYER, BUFFER, PICTURE = 2e-6, 1e-5, 2e-5

FAULTS = {
    "the ramp as printed": ("cascaded_layer", "(uAnchors.w - z) /", "(z - uAnchors.z) /"),
    "no falling ramp": ("cascaded_layer", "first && z < uAnchors.w", "false && z < uAnchors.w"),
    "hidden surfaces have ramps": ("cascaded_layer", "first && z < uAnchors.w", "z < uAnchors.w"),
    "no rising ramp": ("cascaded_layer", "return (z - uAnchors.x) / (uAnchors.y - uAnchors.x);", "return 0.0;"),
    "ramps in inverse depth": (
        "cascaded_layer",
        "(z - uAnchors.x) / (uAnchors.y - uAnchors.x)",
        "(1.0 / uAnchors.x - 1.0 / z) / (1.0 / uAnchors.x - 1.0 / uAnchors.y)",
    ),
    "the first surface only": ("cascaded_layer", "m < textureSize(uSurfaces, 0).z", "m < 1"),
    "surfaces are added up": ("cascaded_layer", "layer = over(layer, weightOf", "layer = layer + (weightOf"),
    "farther surfaces hide nearer ones": (
        "cascaded_layer",
        "over(layer, weightOf(surface.a, m == 0) * vec4(surface.rgb, 1.0))",
        "over(weightOf(surface.a, m == 0) * vec4(surface.rgb, 1.0), layer)",
    ),
    "colours are not premultiplied": (
        "cascaded_layer",
        "weightOf(surface.a, m == 0) * vec4(surface.rgb, 1.0)",
        "vec4(surface.rgb, weightOf(surface.a, m == 0))",
    ),
    "always over": ("cascaded_layer", "uOver ? over(layer, buffer) : over(buffer, layer)", "over(layer, buffer)"),
    "always under": ("cascaded_layer", "uOver ? over(layer, buffer) : over(buffer, layer)", "over(buffer, layer)"),
    "two standard deviations": ("cascaded_blur", "ceil(3.0 * uDeviation)", "ceil(2.0 * uDeviation)"),
    "a radius rounded down": ("cascaded_blur", "ceil(3.0 * uDeviation)", "floor(3.0 * uDeviation)"),
    "deviations for variances": (
        "cascaded_blur",
        "float x = float(k) / uDeviation",
        "float x = float(k) / (uDeviation * uDeviation)",
    ),
    "a wider Gaussian": ("cascaded_blur", "exp(-0.5 * x * x)", "exp(-0.25 * x * x)"),
    "one side only": ("cascaded_blur", "int k = -reach;", "int k = 0;"),
    "outside is nothing": ("cascaded_blur", "clamp(here + k * uAxis, ivec2(0), last)", "here + k * uAxis"),
    "weights do not sum up to 1": ("cascaded_blur", "result = sum / total;", "result = sum / (2.5 * uDeviation);"),
    "along x only": ("cascaded_blur", "k * uAxis, ivec2(0)", "ivec2(k, 0), ivec2(0)"),
    "the front is under the back": (
        "cascaded_compose",
        "vec4 front = texelFetch(uFront, here, 0);",
        "vec4 front = texelFetch(uBack, here, 0);",
    ),
    "buffers are added up": ("cascaded_compose", "(1.0 - front.a) *", ""),
    "colours are not divided": ("cascaded_compose", "composite.rgb / composite.a :", "composite.rgb :"),
    "divided by the front's alpha": (
        "cascaded_compose",
        "composite.rgb / composite.a :",
        "composite.rgb / max(front.a, 0.5) :",
    ),
}


def scene(height, width, focus):
    """Colour (3, H, W, 3), depth (3, H, W), camera and lens: surfaces from 0.2 on, some missing, and background."""
    random = np.random.default_rng(11)
    y, x = np.indices((height, width))
    depth = np.sort(random.uniform(0.2, 2.5, (3, height, width)), axis=0)
    depth[0, :, width // 2 :] = (0.3 + 0.05 * x + 0.01 * y)[:, width // 2 :]
    depth[1:, :, width // 2 :] += 1.5
    depth[1:, : height // 2, width // 4 : width // 2] = np.nan
    depth[2][random.random((height, width)) < 0.4] = np.inf
    depth[0, -height // 4 :, : width // 4] = np.inf
    depth[1:, -height // 4 :, : width // 4] = np.nan
    color = random.random((3, height, width, 3), dtype=np.float32)
    return color, depth.astype(np.float32), flat_scene.camera(width, height, 60.0), ThinLens(0.036, focus)


CASES = [(*scene(14, 21, 0.8), Params()), (*scene(12, 17, 0.45), Params(sigma_step=0.75))]


@functools.cache
def expected(number):
    """Stages and picture (H, W, 3) by the method, and its layers."""
    color, depth, camera, lens, params = CASES[number]
    recorder = StageRecorder(True)
    picture = blur_buffers(color, depth, camera, lens, params, recorder)
    return recorder.stages, picture, layering_of(depth.astype(np.float64), camera, lens, params)


def anchors(layering, k):
    """z_(k-2) .. z_(k+1), with steps at the first and the last layer."""
    last = len(layering.deviation) - 1
    z = [0.0, *layering.bounds[1:-1], np.inf]  # z_(-1) .. z_(last)
    four = [z[k - 1] if k > 0 else 0.0, z[k], z[k + 1], z[k + 2] if k < last else np.inf]
    if k == 1:
        four[0] = four[1]
    if k == last - 1:
        four[3] = four[2]
    return tuple(four)


def passes(context, number, sources=SOURCES):
    """Layers (K, H, W, 4), back, front and composite (H, W, 4) and picture (H, W, 3) as the shaders make them."""
    color, depth = CASES[number][:2]
    layering, shape = expected(number)[2], depth.shape[1:]
    surfaces = np.concatenate([color, np.where(np.isnan(depth), np.float32(-1), depth)[..., None]], axis=-1)
    empty = np.zeros((*shape, 4), np.float32)

    def blend(k, over, buffer):
        return drawn(
            context, sources["cascaded_layer"], shape, {"uSurfaces": surfaces, "uBuffer": buffer},
            uAnchors=anchors(layering, k), uOver=over,
        )[0]  # fmt: skip

    def blur(buffer, variance):
        for axis in ((1, 0), (0, 1)) if variance > 0.0 else ():
            (buffer,) = drawn(
                context, sources["cascaded_blur"], shape, {"uBuffer": buffer}, uAxis=axis, uDeviation=variance**0.5
            )
        return buffer

    def cascade(order, over):
        buffer, variance = empty, 0.0
        for k in order:
            if layers[k][..., 3].any():  # blurs between layers that hold nothing are joined
                buffer, variance = blend(k, over, blur(buffer, variance)), 0.0
            if buffer is not empty:
                variance += layering.step[k] ** 2
        return blur(buffer, variance)

    layers = [blend(k, True, empty) for k in range(len(layering.deviation))]
    back = cascade(range(len(layers) - 1, layering.focus, -1), True)
    front = cascade(range(layering.focus), False)
    picture, composite = drawn(
        context, sources["cascaded_compose"], shape,
        {"uFront": front, "uBack": blend(layering.focus, True, back)}, 2,
    )  # fmt: skip
    return np.stack(layers), back, front, composite, picture[..., :3]


def outside(context, number, sources=SOURCES):
    """How many tolerances layers, back, front, composite and picture are off at worst."""
    stages, picture, _ = expected(number)
    answer = [stages[name] for name in ("layers", "back", "front", "composite")] + [picture]
    found = passes(context, number, sources)
    tolerances = LAYER, BUFFER, BUFFER, BUFFER, PICTURE
    return np.array([np.abs(a - b).max() / t for a, b, t in zip(found, answer, tolerances, strict=True)])


@pytest.mark.parametrize("number", range(len(CASES)))
def test_every_stage_and_pixel(number, context):
    worst = outside(context, number)
    print(f"{worst} tolerances; {len(expected(number)[0]['layers'])} layers, in focus {expected(number)[2].focus}")
    assert (worst <= 1.0).all()
    assert expected(number)[0]["composite"][..., 3].min() > 0.5


@pytest.mark.parametrize("fault", FAULTS)
def test_no_planted_fault_passes(fault, context):
    sources = with_fault(SOURCES, FAULTS[fault])
    assert is_caught(outside(context, number, sources) for number in range(len(CASES)))
