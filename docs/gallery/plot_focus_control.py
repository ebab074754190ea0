"""
Focus control
=============

Points say what shall be sharp (Lee, Eisemann and Seidel 2010, section 5). Left: a tilted focal plane through three of
them, a band of sharpness that makes a town look like a model of itself. Right: a free focal surface. The market stall
in front and the tower far behind are sharp, and what stands between them is not, which no camera can do.
"""

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np

import refdof
from refdof.focus.focus_lens import Focus, focus_lens
from refdof.focus.point import pick

scene = refdof.load_scene("town")
camera = scene.camera.with_size((320, 240))
view = refdof.View(scene, camera, scene.lens)

# %%
# Points are picked by pixel, and stay on their surfaces. An offset puts the focus elsewhere: in front of the car, which
# is blurred.

tilt = Focus((pick(view, (142, 131), "car"), pick(view, (20, 60), "roof"), pick(view, (300, 60), "roof")), "plane")
between = replace(pick(view, (142, 127), "car"), offset=-22.0)
sides = tuple(replace(pick(view, pixel), offset=30.0) for pixel in ((280, 110), (30, 115)))
free = Focus((pick(view, (107, 175), "stall"), pick(view, (150, 50), "tower"), between, *sides), "surface")

# %%
# The reference, and `lensblur` with the same lens.

figure, axes = plt.subplots(2, 2, figsize=(9, 7), layout="constrained")
for column, (name, focus) in enumerate({"tilt-shift": tilt, "focal surface": free}.items()):
    lens = focus_lens(focus, view)
    truth = refdof.reference(scene, camera, lens, samples=64)
    image = refdof.render("lensblur", scene, camera, lens).image
    for panel, picture, title in (
        (axes[0, column], truth.image, f"{name}, reference"),
        (axes[1, column], image, f"{name}, lensblur: {refdof.metrics.psnr(truth.image, image):.1f} dB"),
    ):
        panel.imshow(np.clip(picture, 0.0, 1.0) ** (1 / 2.2))
        panel.set_title(title, fontsize=10)
        panel.axis("off")
