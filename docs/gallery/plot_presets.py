"""
As measured, or as printed
==========================

Where a paper's text and what works best differ, the preset ``paper`` follows the text and ``best``, the default,
follows the measurement. Here are both for ``cascaded``, whose paper prints one formula upside down.
"""

import matplotlib.pyplot as plt
import numpy as np

import refdof

scene = refdof.load_scene("fence")
camera = scene.camera.with_size((240, 180))
truth = refdof.reference(scene, camera, samples=256)
best = refdof.render("cascaded", scene, camera)
paper = refdof.render("cascaded", scene, camera, preset="paper")
print(paper.params)

# %%

figure, axes = plt.subplots(2, 3, figsize=(10, 5.4), layout="constrained")
for column, (title, image) in enumerate(
    {"reference": truth.image, "best": best.image, "paper": paper.image}.items(),
):
    score = "" if column == 0 else f", {refdof.metrics.psnr(truth.image, image):.1f} dB"
    shown = np.clip(image, 0.0, 1.0) ** (1 / 2.2)
    axes[0, column].imshow(shown)
    axes[0, column].set_title(title + score)
    axes[1, column].imshow(shown[40:110, 20:113])
for panel in axes.flat:
    panel.axis("off")
