"""
Every method on one scene
=========================

The built-in scene ``fence`` has thin bars close to the lens. They blur so widely that the garden behind them shows
through. A method that only has the pinhole picture cannot know what is behind a bar.
"""

import matplotlib.pyplot as plt
import numpy as np

import refdof


def display(image):
    """Linear RGB as a screen wants it: clipped and sRGB-encoded."""
    light = np.clip(image, 0.0, 1.0)
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)


scene = refdof.load_scene("fence")
camera = scene.camera.with_size((240, 180))
truth = refdof.reference(scene, camera, samples=256)
pictures = {name: refdof.render(name, scene, camera).image for name in refdof.METHODS}

# %%
# PSNR is the usual score. It is computed on the display image, reference first. No picture can score higher than the
# reference's noise floor, because the reference itself is not perfect.

scores = {name: refdof.metrics.psnr(truth.image, image) for name, image in pictures.items()}
columns = 4
rows = -(-(len(pictures) + 1) // columns)
figure, axes = plt.subplots(rows, columns, figsize=(10, 2.1 * rows), layout="constrained")
titled = {f"reference, floor {truth.noise_floor_psnr:.1f} dB": truth.image}
for name in sorted(scores, key=scores.get, reverse=True):
    titled[f"{name}, {scores[name]:.1f} dB"] = pictures[name]
for panel in axes.flat:
    panel.axis("off")
for panel, (title, image) in zip(axes.flat, titled.items(), strict=False):
    panel.imshow(display(image))
    panel.set_title(title, fontsize=9)

# %%
# ``accumulation`` draws the scene many times; ``multiview``, ``lensblur`` and ``cascaded`` draw it once, as several
# layers. The others filter one picture.
