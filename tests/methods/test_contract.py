"""Every method keeps every promise that its record makes, and has the same door."""

import re
from dataclasses import FrozenInstanceError, fields, is_dataclass
from pathlib import Path

import numpy as np
import pytest

from refdof import METHODS, Camera, InputError, Material, Part, Scene, Stages, ThinLens, render
from refdof.methods._contract import Method
from tests.closed_forms import half_disc

pytestmark = pytest.mark.fast

ROOT = Path(__file__).parents[2]
BY_RAYS = ("accumulation", "lensblur", "multiview")  # seconds without compiling
CAMERA = Camera((0.0, 0.0, 4.0), (0.0, 0.0, 0.0), fov_y=40.0, size=(24, 16))


def quad(x0, y0, x1, y1, z, color, **words):
    """A card parallel to the picture, at world z; the camera stands at z = 4."""
    corners = np.array([[x0, y0, z], [x1, y0, z], [x1, y1, z], [x0, y1, z]])
    return Part(corners, np.array([[0, 1, 2], [0, 2, 3]]), Material("unlit", base_color=color, **words))


def flat_scene(*parts, radius=0.25, focus=4.0, background=(0.0, 0.0, 0.0), camera=CAMERA):
    return Scene.from_parts("stage", parts, camera, ThinLens(radius, focus), background)


def methods(promise=None):
    """Names of methods, of those that promise something, to be tried."""
    names = [name for name, module in METHODS.items() if promise is None or promise in module.METHOD.promises]
    return [pytest.param(name, marks=pytest.mark.long) if name in BY_RAYS else name for name in names]


@pytest.mark.parametrize("name", METHODS)
def test_same_door(name):
    module = METHODS[name]
    record = module.METHOD
    assert isinstance(record, Method)
    assert record.params is module.Params
    assert is_dataclass(module.Params)
    with pytest.raises(FrozenInstanceError):
        setattr(module.Params(), fields(module.Params)[0].name, 1)
    document = module.__doc__
    assert document.index("Departures from the paper\n---") < document.index("References\n---")
    assert re.search(r"^1\. ", document, re.MULTILINE)
    keys = re.findall(r"@\w+\{(\w+),", (ROOT / "papers.bib").read_text())
    assert record.citation in keys
    assert record.source
    assert record.inputs
    assert ("**reconstruction**" in document) == record.reconstruction
    assert not (record.reconstruction and record.paper)  # no text at hand, no preset that follows it
    assert (record.kind == "single image") == ("blur" in module.__all__)
    assert record.known_defects
    for sentence in record.known_defects:
        assert re.fullmatch(r"[A-Z][^\n]{10,120}\.", sentence)


@pytest.mark.parametrize("name", methods())
def test_picture_is_finite_float32(name):
    scene = flat_scene(quad(-1, -1, 0.2, 1, 1.0, (0.8, 0.2, 0.1)), background=(0.1, 0.2, 0.3))
    image = render(name, scene).image
    assert image.shape == (16, 24, 3)
    assert image.dtype == np.float32
    assert np.isfinite(image).all()


@pytest.mark.parametrize("name", [name for name, module in METHODS.items() if module.METHOD.stages])
def test_stages_are_those_that_are_declared(name):
    declared = METHODS[name].METHOD.stages
    found = render(name, flat_scene(quad(-1, -1, 0.2, 1, 1.0, (0.8, 0.2, 0.1))), stages=Stages((1,), ((3, 4),))).stages
    for stage, array in found.items():
        (one,) = [entry for entry in declared if entry.names(stage)]
        assert len(one.axes.split()) == array.ndim
        assert not one.columns or len(one.columns) == array.shape[-1]
    assert all(any(entry.names(stage) for stage in found) for entry in declared)


@pytest.mark.parametrize("name", methods())
@pytest.mark.parametrize("size", [(1, 1), (1, 7), (13, 1)])
def test_degenerate_sizes(name, size):
    scene = flat_scene(quad(-1, -1, 1, 1, 0.0, (0.5, 0.5, 0.5)))
    assert render(name, scene, CAMERA.with_size(size)).image.shape == (size[1], size[0], 3)


@pytest.mark.parametrize("name", methods())
def test_scene_behind_the_camera_is_background(name):
    image = render(name, flat_scene(quad(-1, -1, 1, 1, 9.0, (1, 0, 0)), background=(0.25, 0.5, 0.75))).image
    # 4 ulp: running means of one colour may round.
    np.testing.assert_allclose(image, np.broadcast_to([0.25, 0.5, 0.75], image.shape), rtol=5e-7)


@pytest.mark.parametrize("name", methods())
def test_unknown_parameter_names_the_nearest(name):
    field = fields(METHODS[name].Params)[0].name
    with pytest.raises(InputError, match=f"did you mean '{field}'"):
        render(name, flat_scene(), **{field + "s": 1})


@pytest.mark.parametrize("name", methods("constant"))
def test_constant(name):
    color = (0.3, 0.6, 0.9)
    scene = flat_scene(quad(-9, -9, 0, 9, 2.0, color), quad(-9, -9, 9, 9, -3.0, color), background=color)
    image = render(name, scene).image
    # Sums of up to 400 equal float32 terms: 400 roundings of half an ulp, which mostly cancel; 1e-5 bounds the worst.
    np.testing.assert_allclose(image, np.broadcast_to(color, image.shape), rtol=1e-5)


@pytest.mark.parametrize("name", methods("pinhole"))
def test_pinhole(name):
    scene = flat_scene(quad(-9, -9, 0.2, 9, 1.0, (0.8, 0.2, 0.1)), radius=0.0, background=(0.1, 0.2, 0.3))
    image = render(name, scene).image
    edge = 12 + round(0.2 / 3.0 * CAMERA.pixels_per_tangent)  # x = 0.2 at depth 3
    row = image[8]
    # 1e-5: as in test_constant.
    np.testing.assert_allclose(row[:edge], np.broadcast_to([0.8, 0.2, 0.1], (edge, 3)), rtol=1e-5)
    np.testing.assert_allclose(row[edge:], np.broadcast_to([0.1, 0.2, 0.3], (24 - edge, 3)), rtol=1e-5)


@pytest.mark.parametrize("name", methods("focus"))
def test_focus(name):
    cards = [quad(-9, -9, 0.3, 9, 0.0, (0.8, 0.2, 0.1)), quad(0.3, -9, 9, 9, 0.0, (0.1, 0.9, 0.5))]
    sharp = render(name, flat_scene(*cards, radius=0.0)).image
    np.testing.assert_allclose(render(name, flat_scene(*cards, radius=0.5)).image, sharp, rtol=1e-5)  # as above


@pytest.mark.parametrize("name", methods("convexity"))
def test_convexity(name):
    cards = [quad(-1, -9, 0.1, 9, 1.5, (0.9, 0.9, 0.9)), quad(-9, -9, 9, 9, -4.0, (0.2, 0.2, 0.2))]
    image = render(name, flat_scene(*cards, radius=0.4)).image
    assert image.min() >= 0.2 * (1 - 1e-5)  # roundings, as above
    assert image.max() <= 0.9 * (1 + 1e-5)


@pytest.mark.parametrize("name", methods("energy"))
def test_energy(name):
    half = 3.0 * 4.0 / CAMERA.pixels_per_tangent  # a lamp of 6 x 6 pixels in the middle of the picture
    lamp = quad(-half, -half, half, half, 0.0, (0, 0, 0), emission=(5.0, 5.0, 5.0))
    sharp, blurred = (render(name, flat_scene(lamp, focus=f, radius=0.1)).image[..., 0].sum() for f in (4.0, 3.0))
    assert sharp == pytest.approx(36 * 5.0, rel=1e-6)
    # 64 stratified samples leave a pixel of the rim an error below 5 * 64^-0.75 = 0.22; 60 such pixels: 1.7 in the sum.
    assert blurred == pytest.approx(36 * 5.0, abs=4 * 1.7)


@pytest.mark.parametrize("name", methods("symmetry"))
def test_symmetry(name):
    def cards(sign):
        low, high = sorted((-1.0 * sign, 0.2 * sign))
        return flat_scene(quad(low, -0.5, high, 1, 1.0, (0.8, 0.2, 0.1)), quad(-9, -9, 9, 9, -2.0, (0.1, 0.5, 0.3)))

    difference = render(name, cards(1)).image - render(name, cards(-1)).image[:, ::-1]
    # The error of 64 stratified samples at an edge of contrast 0.7 is below 0.7 * 64^-0.75 = 0.03 (one sigma), twice.
    assert np.abs(difference).max() < 5 * 0.03 * 2**0.5
    assert abs(difference.mean()) < 0.003  # 384 pixels, half of them blurred


@pytest.mark.parametrize("name", methods("occlusion"))
def test_occlusion(name):
    half = 2.0 / CAMERA.pixels_per_tangent  # one pixel at depth 2: the bar covers two columns whole
    bar = quad(-half, -9, half, 9, 2.0, (0, 0, 0))
    wall = quad(-9, -9, 9, 9, 0.0, (0.9, 0.9, 0.9))
    image = render(name, flat_scene(bar, wall, radius=0.25)).image
    # At depth 2, half-way to the focal plane, the ray of lens point v is at 2 x + 0.125 v, with x = -1/2 px. The bar
    # hides the v between its sides.
    x = -0.5 / CAMERA.pixels_per_tangent
    low, high = ((side - 2.0 * x) / 0.125 for side in (-half, half))
    shown = 1.0 - (half_disc(high) - half_disc(low))
    assert image[8, 11, 0] == pytest.approx(0.9 * shown, abs=0.1)
