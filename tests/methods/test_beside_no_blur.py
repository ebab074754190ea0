"""Every method beside the pinhole picture, on every built-in scene: blurring helps, or the record says where not."""

import pytest

import refdof
from refdof import METHODS, SCENES, View
from refdof.metrics import psnr
from refdof.rendering import render_view

WORSE = "Worse than no blur on the scene `{}`: "
SIZE = (160, 120)


@pytest.mark.slow
@pytest.mark.parametrize("scene_name", SCENES)
def test_no_method_is_worse_than_no_blur_unless_it_says_so(scene_name):
    scene = refdof.load_scene(scene_name)
    view = View(scene, scene.camera.with_size(SIZE), scene.lens)
    # 64 samples: the pinhole picture has 12 to 24 dB, the reference's noise lies at 20 dB (`lights`) and 39 or more.
    truth = refdof.reference(scene, view.camera, samples=64).image
    sharp = psnr(truth, view.pinhole().color)
    for name, module in METHODS.items():
        for preset in ("best", "paper"):
            score = psnr(truth, render_view(name, view, preset=preset).image)
            says = any(line.startswith(WORSE.format(scene_name)) for line in module.METHOD.known_defects)
            assert says == (score < sharp), f"{name} ({preset}): {score:.2f} dB, without blur {sharp:.2f} dB"
