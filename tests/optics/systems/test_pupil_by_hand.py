"""The box of a sensor point, between boxes that are known: interpolated, or the one that is not empty."""

import numpy as np
import pytest

from refdof.optics.systems.pupil import PupilBounds, bounds_at

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
