"""Properties of methods that filter one picture, on plain arrays: what they promise, and what follows from their reads.

`refdof.testing` makes the pictures.
"""

import pytest

from refdof import METHODS
from refdof.testing import check_properties

SINGLE = [name for name, module in METHODS.items() if module.METHOD.kind == "single image"]
ALWAYS = ("call", "linearity", "channels", "units")
WITHOUT_LEVELS = ("scatter", "separable", "singlepass")  # each tap is where its pixel is, not where a texel is
MOVABLE = ("translation", "crop", "tile", "pad", "locality")
# Poisson's blur goes from the nearest to the farthest surface, whatever their circles.
BY_CIRCLE = [name for name in SINGLE if name != "poisson"]


@pytest.mark.parametrize("name", SINGLE)
def test_what_is_promised_holds_on_plain_arrays(name):
    module = METHODS[name]
    check_properties(module.blur, [*ALWAYS, *module.METHOD.promises], examples=8)


@pytest.mark.parametrize("name", BY_CIRCLE)
def test_the_background_is_a_far_surface(name):
    check_properties(METHODS[name].blur, ["far"], examples=8)


@pytest.mark.parametrize("name", WITHOUT_LEVELS)
def test_what_moves_or_is_cut_is_blurred_as_before(name):
    check_properties(METHODS[name].blur, MOVABLE, examples=8)


@pytest.mark.parametrize("name", ["scatter", "singlepass"])
def test_a_spot_is_a_disc(name):
    check_properties(METHODS[name].blur, ["energy", "radius", "aperture"], reach=2.0, examples=8)
