"""The blur of a lamp has the shape of the opening, upright behind the focal plane and turned before it."""

import numpy as np
import pytest
import stage

import refdof
from refdof import Aperture, ThinLens


@pytest.mark.parametrize("depth", [2.0, 0.6])
def test_blur_has_the_shape_of_the_opening(depth):
    p, size, focus = 16.0, 41, 1.0
    coc = 10.0 if depth > focus else -10.0
    quarter = Aperture.image(np.array([[0.0, 1.0], [0.0, 0.0]]))  # right and up, centred on (1/2, 1/2)
    radius = abs(coc / (p * (1 / focus - 1 / depth)))
    half = 0.5 * depth / p
    lamp = stage.rectangle(-half, half, -half, half, depth, (100.0,) * 3)
    shot = stage.camera(size, size, p)
    x, y = np.meshgrid(np.arange(size) - size // 2, size // 2 - np.arange(size))
    for opening, shift, third in ((quarter, 0.5, None), (Aperture.polygon(3), 0.0, 0.025)):
        result = refdof.reference(
            stage.scene_of([lamp], shot), shot, ThinLens(radius, focus, opening), samples=8192, pixel_filter="box"
        )
        red, error = result.image[..., 0].astype(float), result.standard_error[..., 0].astype(float)
        # A point behind the focal plane moves with the lens point, one before it against it. Four standard errors
        # of sums over independent pixels.
        for offset, expected in ((x, shift), (y, shift)):
            room = 4 * np.sqrt((error**2 * offset**2).sum()) / 100
            assert (red * offset).sum() / 100 == pytest.approx(coc * expected, abs=room)
        if third is not None:
            # A triangle with a corner at (1, 0): the mean of x^3 is 1/40, by barycentric moments 1/10, 1/30, 1/60.
            room = 4 * np.sqrt((error**2 * x**6.0).sum()) / 100
            assert room < 6  # of 25
            assert (red * x**3).sum() / 100 == pytest.approx(coc**3 * third, abs=room)
