"""The box of a sensor point, between boxes that are known: interpolated, or the one that is not empty."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from refdof.optics.systems.glass import Glass
from refdof.optics.systems.height_lens import HeightLens
from refdof.optics.systems.pupil import PupilBounds, bounds_at, pupil_bounds

pytestmark = pytest.mark.fast

# At radii 0, 2, 4, 6 and 8 of a reach of 8; two of them are empty.
BOXES = np.array([[-1.0, 1.0, 1.0], [-3.0, 2.0, 5.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [7.0, 9.0, 2.0]])


@pytest.mark.parametrize(
    ("radius", "box"),
    [
        (0.0, (-1.0, 1.0, 1.0)),
        (0.5, (-1.5, 1.25, 2.0)),
        (2.0, (-3.0, 2.0, 5.0)),
        (3.0, (-3.0, 2.0, 5.0)),  # the other end is empty
        (5.0, (0.0, 0.0, 0.0)),
        (7.0, (7.0, 9.0, 2.0)),
        (8.0, (7.0, 9.0, 2.0)),
        (8.5, (0.0, 0.0, 0.0)),
    ],
)
def test_boxes_between_boxes(radius, box):
    assert bounds_at(PupilBounds(0.0, 1.0, 8.0, BOXES), radius) == box


def test_boxes_of_a_plate_are_around_its_rim_rays():
    """A ray of a sensor point at R through b on the back, in the plane of the axis, comes to b + 6 tan(i) on the front.

    sin(i) is that of its slope (b - R) / 44 over 1.5, and the stop on the front has the radius 3.
    """
    flat, reach, intervals = np.zeros((9, 9)), 24.0, 512
    plate = HeightLens(flat, flat, 6.0, 25.0, Glass("plain", 1.5), stop_diameter=6.0)
    boxes = pupil_bounds(plate, reach, sensor=50.0, intervals=intervals).boxes
    for k in range(0, intervals + 1, 64):
        radius = reach * k / intervals

        def front(b, radius=radius):
            return b + 6.0 * math.tan(math.asin(math.sin(math.atan((b - radius) / 44.0)) / 1.5))

        low, high = (brentq(lambda b, rim=rim: front(b) - rim, -20.0, 20.0) for rim in (-3.0, 3.0))
        assert boxes[k, 0] <= low < high <= boxes[k, 1]
        assert boxes[k, 1] - boxes[k, 0] < 1.25 * (high - low)  # slopes of all of the box are taken at once
