"""Properties of methods that filter one picture, on plain arrays: what they promise, and what follows from their reads.

`refdof.testing` makes the pictures.
"""

import pytest

from refdof import METHODS
from refdof.testing import check_properties
from tests.unlike import IN_ONE_UNIT, NONLINEAR

SINGLE = [name for name, module in METHODS.items() if module.METHOD.kind == "single image"]
ALWAYS = ("call", "linearity", "channels", "units")
NOT = {"linearity": NONLINEAR, "units": IN_ONE_UNIT}
WITHOUT_LEVELS = (
    "circular",
    "hexagon",
    "scatter",
    "separable",
    "singlepass",
)  # each tap is where its pixel is, not where a texel is
MOVABLE = ("translation", "crop", "tile", "pad", "locality")
# Poisson's blur goes from the nearest to the farthest surface, whatever their circles.
BY_CIRCLE = [name for name in SINGLE if name != "poisson"]


@pytest.mark.parametrize("name", SINGLE)
def test_what_is_promised_holds_on_plain_arrays(name):
    module = METHODS[name]
    always = [one for one in ALWAYS if name not in NOT.get(one, {})]
    check_properties(module.blur, [*always, *module.METHOD.promises], examples=8)


@pytest.mark.parametrize(("one", "name"), [(one, name) for one, names in NOT.items() for name in names])
def test_what_a_method_does_otherwise_is_found(one, name):
    with pytest.raises(AssertionError, match=f"{one}: "):
        check_properties(METHODS[name].blur, [one], examples=8)


@pytest.mark.parametrize("name", BY_CIRCLE)
def test_the_background_is_a_far_surface(name):
    check_properties(METHODS[name].blur, ["far"], examples=8)


@pytest.mark.parametrize("name", WITHOUT_LEVELS)
def test_what_moves_or_is_cut_is_blurred_as_before(name):
    check_properties(METHODS[name].blur, MOVABLE, examples=8)


@pytest.mark.parametrize("name", ["scatter", "singlepass"])
def test_a_spot_is_a_disc(name):
    check_properties(METHODS[name].blur, ["energy", "radius", "aperture"], reach=2.0, examples=8)
