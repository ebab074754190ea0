"""The plot of a front: every method can be told from the others."""

import re

import pytest

from refdof.methods import METHODS
from refdof.sweep.plots import front_plot
from tests.sweep.points import point

pytestmark = pytest.mark.fast


def test_every_method_has_a_color_of_its_own():
    points = [point(name, float(k + 1), 20.0 + k, method=name) for k, name in enumerate(METHODS)]
    plot = front_plot(points, "svg").decode()
    colors = set(re.findall(r"fill: (#[0-9a-f]{6}); stroke: #[0-9a-f]{6}", plot))
    assert len(colors) == len(METHODS)
