"""The lens chart: its places by hand, its blur beside rays through the lens, and where a comparison shows it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from refdof import Camera, SystemLens, ThinLens, View, load_lens, reference
from refdof._jit import JIT_DISABLED
from refdof.compare import compare
from refdof.comparison import Chart
from refdof.optics.systems.data_sheet import focused
from refdof.optics.systems.field import spot
from refdof.report.overview import write_overview
from refdof.report.page import report_page
from refdof.scene.lens_chart import lens_chart, patch
from tests.fake_comparison import comparison
from tests.flat_scene import rectangle, scene_of

CAMERA = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), size=(320, 240))
FILM = 24.0  # [mm] that are the picture's height behind a real lens
DISTANCE, WAVE = 2.0, 0.51  # [m], and the wavelength of green [um]


def test_the_chart_fills_the_field_from_the_middle_to_the_corner():
    """320 x 240 px have the corner at 200 px; twice as large it is 400, in cells of 400 / 32, rounded, on two rows."""
    chart = lens_chart(CAMERA, ThinLens(0.05, 2.0))
    assert chart.camera.pixels_per_tangent == pytest.approx(2.0 * CAMERA.pixels_per_tangent)
    assert (chart.camera.height, chart.window.stop - chart.window.start) == (24, 400)
    assert chart.window.start == chart.camera.width // 2
    assert chart.camera.width // 2 >= 412  # the last square that is seen is whole
    places = chart.camera.project(chart.scene.vertices)
    np.testing.assert_allclose(places[:, 2], 2.0)
    corners = places[chart.scene.faces[::2], :2]  # of every other triangle: two of a square that are opposite, and one
    middles = corners[:, [0, 2]].mean(axis=1) - [chart.camera.width / 2, 12.0]
    wanted = {(side * (12.0 * k + 6.0), row) for k in range(35) for side in (-1, 1) for row in (-6.0, 6.0)}
    assert {(round(x, 6), round(y, 6)) for x, y in middles} == wanted


def test_a_patch_is_a_slanted_rectangle_at_its_place():
    corners = CAMERA.project(patch(CAMERA, 30.0, -20.0, 3.0, 5.0, half_y=2.0, slant=90.0).vertices)[:, :2] - [160, 120]
    found = sorted((round(x, 6), round(y, 6)) for x, y in corners)
    assert found == [(28.0, 15.0), (28.0, 25.0), (32.0, 15.0), (32.0, 25.0)]  # turned: 2 to the sides, 5 up and down


def test_of_a_lens_focused_at_infinity_the_chart_is_far_away():
    chart = lens_chart(CAMERA, ThinLens(0.05, math.inf))
    circle = ThinLens(0.05, math.inf).coc_px(-chart.scene.vertices[:, 2], chart.camera)
    np.testing.assert_allclose(np.abs(circle), 0.02, rtol=1e-5)


@pytest.mark.skipif(JIT_DISABLED, reason="millions of rays; the compiled pass runs it")
def test_stars_blur_toward_the_corner_as_the_lens_bends_its_field():
    """Mean squares of stars across the field (along the row's normal) and along it, beside rays of one point.

    The spots are traced from the film's side of nothing that the reference uses but refraction: rays of a point in the
    plane in focus, over the entrance pupil, to the film. A star adds the mean square of its own side.
    """
    lens = SystemLens(load_lens("petzval"), DISTANCE, 2.4)
    chart = lens_chart(lens.seen_by(CAMERA), lens)
    truth = reference(chart.scene, chart.camera, lens, samples=256).image
    thin = reference(chart.scene, chart.camera, ThinLens(lens.radius, DISTANCE), samples=64).image
    pixels = 2.0 * CAMERA.height / FILM  # per mm of film
    system, cell = focused(lens.stopped, 1000.0 * DISTANCE), chart.camera.height // 2
    own = max(0.1 * cell, 2.0) ** 2 / 12.0
    across = []
    for k in (0, 12, 16, 20, 24, 28, 31):
        place, found = moments(truth[cell:, chart.window], k, cell)
        rays = spot(system, place / pixels, 1000.0 * DISTANCE, WAVE) * pixels
        wanted = rays.var(axis=0) + own
        across.append(found[1])
        # Where a spot is no larger than a pixel, values at pixel centres tell little. Elsewhere: lattice, noise, tails
        # outside of the cell.
        for one, other in zip(found, wanted[::-1], strict=True):
            if other > 0.5:
                assert one == pytest.approx(other, rel=0.13)
        assert max(moments(thin[cell:, chart.window], k, cell)[1]) <= 0.26  # 2 x 2 pixels at most
    assert across == sorted(across)
    assert across[-1] - own > 8.0 * (across[0] - own)


def moments(image, k, cell):
    """Of a star: its distance from the picture's middle [px], and mean squares along and across the row."""
    light = image[:, k * cell : (k + 1) * cell, 1].astype(float)
    y, x = np.mgrid[:cell, :cell] + 0.5
    mean_x, mean_y = ((light * axis).sum() / light.sum() for axis in (x, y))
    squares = [(light * (axis - mean) ** 2).sum() / light.sum() for axis, mean in ((x, mean_x), (y, mean_y))]
    return math.hypot(k * cell + mean_x, mean_y), squares


def test_a_comparison_has_a_chart_of_a_real_lens_only():
    camera = replace(CAMERA, size=(16, 12))
    scene = scene_of([rectangle(-1.0, 1.0, -1.0, 1.0, 3.0)], camera)
    lens = SystemLens(load_lens("biconvex"), 2.0)
    found = compare(scene, ["mipmap"], None, camera, lens, samples=4, preset=["best", "paper"])
    assert list(found.chart.pictures) == ["reference", "reference, thin lens", "mipmap", "mipmap (paper)"]
    assert {image.shape for image in found.chart.pictures.values()} == {(4, 20, 3)}  # twice the 10 px to the corner
    assert compare(scene, ["mipmap"], None, camera, ThinLens(0.05, 2.0), samples=4).chart is None
    view = View(scene, camera, lens)
    assert found.camera == view.camera


def test_report_and_overview_show_the_chart(tmp_path):
    shades = {"reference": 0.9, "reference, thin lens": 0.5, "mipmap": 0.2}
    pictures = {name: np.full((6, 100, 3), value, np.float32) for name, value in shades.items()}
    given = comparison(methods=("mipmap",))
    page = report_page(replace(given, chart=Chart(pictures)))
    assert page.count("<figure>") == page.count("data:image/png;base64,") == 3
    assert "Lens chart" in page
    assert "Lens chart" not in report_page(given)
    write_overview(given, tmp_path / "without.png")
    write_overview(replace(given, chart=Chart(pictures)), tmp_path / "with.png")
    with Image.open(tmp_path / "without.png") as file, Image.open(tmp_path / "with.png") as taller:
        size, pixels = file.size, np.asarray(taller.convert("RGB")).astype(int)
    # 972 px between the margins: strips of 100 px are shown 9 times as large, 54 px high, 22 px of words above each;
    # the caption takes two lines.
    assert pixels.shape == (size[1] + 2 * 22 + 3 * (22 + 54) + 16, size[0], 3)
    for k, value in enumerate(shades.values()):
        level = round(255.0 * (1.055 * value ** (1.0 / 2.4) - 0.055))
        middle = size[1] + 2 * 22 + k * (22 + 54) + 22 + 27
        assert np.abs(pixels[middle, 16 : 16 + 900] - level).max() <= 1
