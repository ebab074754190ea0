"""Every image filter's `blur` records the stages that `render` does, and changes no bit by it."""

import numpy as np
import pytest

from refdof import METHODS, render
from refdof.methods.cascaded.layers import filter_layers
from tests import full_scene as full

pytestmark = pytest.mark.fast

FILTERS = [name for name, module in METHODS.items() if module.METHOD.kind == "single image"]


@pytest.mark.parametrize("name", FILTERS)
def test_stages_of_plain_arrays(name):
    camera, scene = full.CAMERA.with_size((12, 9)), full.scene()
    rendered = render(name, scene, camera, stages=True)
    pinhole = render("accumulation", scene, camera, full.ThinLens(0.0, full.FOCUS), samples=1).image
    depth = np.full((9, 12), 2.0)
    depth[:, 5:] = 5.0
    coc = full.ThinLens(full.RADIUS, full.FOCUS).coc_px(depth, camera)
    blur = METHODS[name].blur
    image, stages = blur(pinhole, depth, coc, stages=True)
    np.testing.assert_array_equal(image, blur(pinhole, depth, coc))
    fixed = {stage for stage in rendered.stages if not stage.startswith(("color ", "sub-image "))}
    assert fixed <= set(stages)
    np.testing.assert_array_equal(stages["coc"], coc.astype(np.float32))


def test_a_rounding_makes_no_further_layer():
    # Layers of `cascaded` end at circles of 1 px and, one step on, of 1 + sqrt(5) px.
    for nearest, count in ((-0.5, 1), (-1.0, 1), (-1.0 - 1e-12, 1), (-1.0 - 1e-3, 2), (-1.0 - 5**0.5 - 1e-12, 2)):
        assert len(filter_layers(nearest, 0.0, 4.0, 2.0, 1.0, 100.0).deviation) == count
