"""Bug threads about lens models and sampling: docs/threads.md, part 9."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from refdof import Aperture, ThinLens, View, render
from refdof.optics.expressive_lens import ExpressiveLens
from refdof.optics.lens_samples import lens_samples
from refdof.optics.systems.trace import trace
from tests import flat_scene
from tests.optics.systems.lenses import double_gauss
from tests.threads.pictures import CAMERA, FILTERS, LENS, filtered, noise, wall

pytestmark = pytest.mark.fast
WIDE = flat_scene.camera(15, 15, 100.0)
RIGHT = np.array([[0.0, 1.0]])  # an aperture whose right half lets light through
APERTURES = {
    "disc": Aperture.disc(),
    "gaussian": Aperture.gaussian(0.4),
    "five blades": Aperture.polygon(5, 10.0, 0.3),
    "anamorphic": Aperture.disc(0.5),
    "right half": Aperture.image(np.tile([0.0, 1.0], (2, 1))),
}


def lamp(depth, aperture, radius=0.16, samples=64):
    """A lamp of 1 px in the middle of the picture, through a lens focused at 2: the picture and its centroid [px]."""
    half = 0.005 * depth
    part = flat_scene.rectangle(-half, half, -half, half, depth, (1.0, 1.0, 1.0))
    lens = ThinLens(radius, 2.0, aperture)
    scene = flat_scene.scene_of([part], WIDE, lens)
    image = render("multiview", scene, WIDE, lens, samples=samples, cones="none").image[..., 0].astype(float)
    y, x = np.indices(image.shape)
    return image, ((image * (x - 7)).sum() / image.sum(), (image * (y - 7)).sum() / image.sum())


@pytest.mark.parametrize("aperture", APERTURES)
def test_pbrt_v3_162_an_even_scene_is_even_through_any_aperture(aperture):
    lens = ThinLens(0.1, 2.0, APERTURES[aperture])
    scene = flat_scene.scene_of([wall(4.0, (0.5, 0.25, 2.0))], CAMERA, lens, background=(0.5, 0.25, 2.0))
    image = render("accumulation", scene, CAMERA, lens, samples=4).image
    assert_allclose(image, np.broadcast_to(np.float32([0.5, 0.25, 2.0]), image.shape), rtol=1e-6)


def test_pbrt_v3_162_rays_that_a_rim_stops_are_counted():
    # A beam along the axis over a square of 40 mm: the share that passes is the entrance pupil's area over its own.
    side = (np.arange(40) + 0.5) / 40 * 40.0 - 20.0
    x, y = (i.ravel() for i in np.meshgrid(side, side))
    origins = np.stack([x, y, np.full(x.shape, -10.0)], axis=1)
    found = trace(double_gauss(), origins, np.tile([0.0, 0.0, 1.0], (len(x), 1)), 0.5876)
    assert len(found.passed) == 1600
    pupil = math.pi * (50.358 / 2.03 / 2.0) ** 2  # figures of other programs for this lens
    assert found.passed.mean() == pytest.approx(pupil / 1600.0, rel=0.03)  # a rim of 78 mm, cells of 1 mm


def test_pbrt_v4_149_depth_and_circles_are_the_pinholes_own():
    parts = [wall(2.0, (1.0, 0.0, 0.0), -9.0, 0.003), wall(6.0, (0.0, 1.0, 0.0))]
    views = [View(flat_scene.scene_of(parts, CAMERA, lens), CAMERA, lens) for lens in (LENS, ThinLens(2.0, 2.0))]
    assert_array_equal(views[0].pinhole().depth, views[1].pinhole().depth)
    assert_array_equal(views[0].layers().depth, views[1].layers().depth)
    # Once through the middle of the lens, not a mean over it: two depths, and an edge between pixels.
    assert_allclose(views[1].pinhole().depth[0], [2.0] * 5 + [6.0] * 4, rtol=1e-12)
    assert_allclose(20.0 * views[0].coc_px(), views[1].coc_px(), rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("name", FILTERS)
def test_lentil_173_depth_is_read_and_left_as_it_was(name):
    color, depth = noise((7, 9)), np.random.default_rng(173).uniform(1.0, 9.0, (7, 9))
    coc = LENS.coc_px(depth, CAMERA) / 4.0
    kept = color.copy(), depth.copy(), coc.copy()
    filtered(name, color, depth, coc)
    for array, before in zip((color, depth, coc), kept, strict=True):
        assert_array_equal(array, before)


def test_lentil_83_an_anamorphic_lens_has_oval_discs():
    # Twice as high as wide: second moments (r / 2)^2 / 4 and r^2 / 4, over the points and over a lamp's disc.
    points = lens_samples(1024, "vogel", aperture=Aperture.disc(0.5))[0]
    assert_allclose((points**2).mean(axis=0), [1.0 / 16.0, 1.0 / 4.0], rtol=0.01)
    image, _ = lamp(4.0, Aperture.disc(0.5), samples=256)
    y, x = np.indices(image.shape) - 7.0
    moments = [(image * axis**2).sum() / image.sum() for axis in (x, y)]
    # A circle of 4 px: 1 and 4 px^2; the lamp and the pixel are 1 px wide and add 1 / 12.
    assert_allclose(moments, [1.0 + 1.0 / 12.0, 4.0 + 1.0 / 12.0], rtol=0.1)


def test_lentil_175_green_is_in_focus_where_focus_is():
    # Indices of red, green and blue: focal lengths go with 1 / (n - 1), and that of green is the one given.
    lens = ExpressiveLens(0.1, 2.0, 0.05, indices=(1.51, 1.52, 1.53))
    power = [(n - 1.0) / 0.52 / 0.05 for n in (1.51, 1.52, 1.53)]
    made = lens.map_of(CAMERA)
    added = made.power[:, 0, 0]
    assert_allclose(added, [p - 1.0 / 0.05 for p in power], atol=1e-12)
    assert added[1] == 0.0
    assert_allclose(made.inverse_focus, 0.5, rtol=1e-12)


@pytest.mark.parametrize(("depth", "side"), [(1.25, -1.0), (4.0, 1.0)])
def test_lentil_190_a_cut_off_aperture_turns_over_at_focus(depth, side):
    # The right half of the lens: of a disc of c px the half at +c or -c, whose centroid lies 4 / (3 pi) of it away.
    circle = 16.0 * (0.5 - 1.0 / depth)
    _, (x, y) = lamp(depth, Aperture.image(_half_disc()))
    assert x == pytest.approx(side * 4.0 / (3.0 * math.pi) * abs(circle), rel=0.1)
    assert abs(y) < 0.2


def _half_disc():
    """An image aperture, 32 x 32: the right half of the disc."""
    return np.tile((np.arange(32) >= 16).astype(float), (32, 1))


def test_lentil_174_an_image_aperture_is_even_inside_its_texels():
    # Texels are squares of one transmission. Points are as dense as it is and spread over all of each texel.
    weights = np.array([[0.0, 1.0], [0.0, 3.0]])
    points = lens_samples(4096, "sobol", aperture=Aperture.image(weights))[0]
    upper = points[:, 1] > 0.0
    assert (points[:, 0] > 0.0).all()
    assert upper.mean() == pytest.approx(0.25, abs=2e-3)
    assert_allclose(points[upper].mean(axis=0), [0.5, 0.5], atol=0.01)
    assert_allclose(points[upper].var(axis=0), 1.0 / 12.0, rtol=0.02)


@pytest.mark.parametrize("aperture", ["disc", "gaussian", "five blades", "anamorphic"])
def test_blendluxcore_785_discs_are_centred_on_the_pinholes_place(aperture):
    _, centroid = lamp(4.0, APERTURES[aperture])
    # 64 even points of a disc of 4 px: their mean is within a tenth of a pixel of the middle.
    assert_allclose(centroid, [0.0, 0.0], atol=0.15)


def test_alchemy_346_neutral_controls_change_no_bit():
    plain = lens_samples(64, "sobol", 2)[0]
    assert_array_equal(lens_samples(64, "sobol", 2, Aperture.disc(1.0))[0], plain)
    depth = np.random.default_rng(346).uniform(0.5, 9.0, (7, 9))
    neutral = ExpressiveLens(0.1, 2.0, 0.05, power=(1.0, 1.0), ray_weights=(1.0, 1.0), image_offset=(0.0, 0.0))
    assert_array_equal(neutral.coc_px(depth, CAMERA), LENS.coc_px(depth, CAMERA))
    # Neither does turning a round lens's blades away by full curvature, but for 64 chords a blade.
    round_ = lens_samples(4096, "sobol", 2, Aperture.polygon(6, 15.0, 1.0))[0]
    assert_allclose((round_**2).mean(axis=0), 0.25, rtol=2e-3)
