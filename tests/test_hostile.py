"""Hostile numbers through every door: nothing is read outside an array, warned of, or anything but a finite picture.

Compiled code with bounds checks (`make bounds`) and interpreted code raise where an index is too large. Negative ones
wrap around in both: `test_no_index_is_negative` runs the interpreter with arrays that refuse them.
"""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import refdof
from refdof import METHODS, InputError, Light, Material, Part, Scene, ThinLens
from tests.hostile import CAMERA, LENSES, PICTURES, SCENES

pytestmark = pytest.mark.fast

FEW = {"samples": 2}


def few(name):
    return FEW if hasattr(METHODS[name].Params(), "samples") else {}


def draw(name, scene, lens=None):
    """A picture, or None if the method says that it cannot."""
    try:
        return refdof.render(name, scene, lens=lens, **few(name)).image
    except InputError:
        return None


@pytest.mark.parametrize("name", METHODS)
def test_scenes(name):
    for what, scene in SCENES.items():
        image = draw(name, scene)
        assert image is None or np.isfinite(image).all(), what
        assert image is None or (image >= 0).all(), what


@pytest.mark.parametrize("name", METHODS)
def test_lenses(name):
    for lens in LENSES:
        image = draw(name, SCENES["uv 1e25"], lens)
        assert image is None or np.isfinite(image).all(), lens


@pytest.mark.parametrize("name", [name for name, module in METHODS.items() if module.METHOD.kind == "single image"])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_pictures(name, dtype):
    for what, (color, depth, coc) in PICTURES.items():
        image = METHODS[name].blur(color.astype(dtype), depth, coc)
        assert np.isfinite(image).all(), what
        assert image.dtype == dtype


@pytest.mark.parametrize("place", [1e25, -1e25, 3e38, 2.0**63])
def test_texture_coordinates_repeat_however_large(place):
    """Every float32 from 2^24 on is a whole number: the corner of the texture, where four texels meet."""
    texels = np.array([[[1.0, 0, 0], [0, 1.0, 0]], [[0, 0, 1.0], [1.0, 1.0, 1.0]]])
    corners = np.array([[-99.0, -99.0, 0.0], [99.0, -99.0, 0.0], [0.0, 99.0, 0.0]])
    part = Part(corners, [[0, 1, 2]], Material("unlit", texture=texels), uv=np.full((3, 2), place))
    scene = Scene.from_parts("corner", [part], CAMERA, ThinLens(0.0, 1.0))
    image = refdof.render("mipmap", scene).image
    # (1 + 1) / 4 of each channel. Barycentrics add up to 1 only but for roundings, so a place may move by whole
    # textures, and by 2^-52 of its size where that is below one: then any place between texels is right.
    assert (image >= 0).all()
    assert (image <= 1).all()
    if place == 2.0**63:
        np.testing.assert_allclose(image[..., 0], 0.5, atol=0.5)
    exact = part.uv.astype(np.float64) - np.floor(part.uv.astype(np.float64))
    assert not exact.any()


@pytest.mark.parametrize("shape", [(1, 2), (4, 2), (2, 64), (64, 1)])
def test_an_environment_that_is_not_square_is_refused(shape):
    with pytest.raises(
        InputError, match=rf"^environment: got shape \({shape[0]}, {shape[1]}, 3\); allowed is \(n, n, 3\)"
    ):
        Light(environment=np.ones((*shape, 3)))


@pytest.mark.parametrize("side", [1, 2, 7])
def test_mirrors_of_an_even_environment_see_it(side):
    """A mirror in a world of one colour c, without light: specular times c, whatever the size of the map."""
    light = Light(sun=(0, 0, 0), sky=(0, 0, 0), ground=(0, 0, 0), environment=np.full((side, side, 3), 0.5))
    mirror = Material("phong", (0, 0, 0), specular=(0.25, 0.5, 1.0))
    corners = np.array([[-99.0, -99.0, 0.0], [99.0, -99.0, 0.0], [0.0, 99.0, 3.0]])
    scene = Scene.from_parts("mirror", [Part(corners, [[0, 1, 2]], mirror)], CAMERA, ThinLens(0.0, 1.0), light=light)
    for lens in (ThinLens(0.0, 1.0), ThinLens(0.25, 1.0)):
        image = refdof.render("accumulation", scene, lens=lens, samples=2).image
        np.testing.assert_allclose(image, np.broadcast_to([0.125, 0.25, 0.5], image.shape), rtol=1e-6)  # float32


@pytest.mark.parametrize("field", ["faces", "face_material"])
def test_indices_written_after_the_gate_are_refused(field):
    corners = np.array([[-9.0, -9.0, 0.0], [9.0, -9.0, 0.0], [0.0, 9.0, 0.0]])
    for draw_it in (lambda s: refdof.reference(s, samples=16), lambda s: refdof.render("singlepass", s)):
        scene = Scene.from_parts("late", [Part(corners, [[0, 1, 2]])], CAMERA, ThinLens(0.1, 1.0))
        getattr(scene, field).flat[0] = 10**9
        with pytest.raises(InputError, match=rf"^{field}: index 1000000000 is outside"):
            draw_it(scene)
    part = Part(corners, np.array([[0, 1, 2]]))
    part.faces[0, 0] = 10**9
    with pytest.raises(InputError, match=r"^faces: index 1000000000"):
        Scene.from_parts("late", [part], CAMERA, ThinLens(0.1, 1.0))


def test_no_index_is_negative():
    path = os.pathsep.join([str(Path(refdof.__file__).parent.parent), str(Path(__file__).parent.parent)])
    result = subprocess.run(
        [sys.executable, "-W", "error", "-m", "tests.strict_arrays"],
        env=os.environ | {"NUMBA_DISABLE_JIT": "1", "PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 0, result.stdout + result.stderr
