"""
Aperture shapes
===============

A small bright lamp that is out of focus draws the shape of the aperture. Behind the focal plane it appears as it is;
in front of it, it would appear upside down. The longest half-axis of every shape is the lens radius, so blurs have the
same size, and the brightness of the picture does not change with the shape.
"""

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np

import refdof

# %%
# Three lamps behind the focal plane: small squares that emit light.

lamps = []
for x, color in ((-0.85, (90.0, 60.0, 30.0)), (0.0, (70.0, 70.0, 70.0)), (0.85, (30.0, 50.0, 90.0))):
    corners = np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]]) * 0.03
    material = refdof.Material("unlit", base_color=(0.0, 0.0, 0.0), emission=color)
    lamps.append(refdof.Part(corners + np.array([x, 0.0, -4.0]), np.array([[0, 1, 2], [0, 2, 3]]), material))
camera = refdof.Camera.look_at((0, 0, 0), (0, 0, -1), fov_y=22.0, size=(180, 90))
lens = refdof.ThinLens(radius=0.3, focus_distance=2.0)
scene = refdof.Scene.from_parts("lamps", lamps, camera, lens, background=(0.01, 0.01, 0.02))

# %%
# An image as aperture lets light through in proportion to its values. Here it is a ring, as a mirror lens has.

y, x = (np.indices((64, 64)) + 0.5) / 32.0 - 1.0
ring = (np.hypot(x, y) > 0.55).astype(float)
apertures = {
    "disc()": refdof.Aperture.disc(),
    "disc(ratio=0.5)": refdof.Aperture.disc(ratio=0.5),
    "polygon(6)": refdof.Aperture.polygon(6),
    "polygon(5, curvature=0.6)": refdof.Aperture.polygon(5, rotation=90.0, curvature=0.6),
    "gaussian(0.4)": refdof.Aperture.gaussian(0.4),
    "image(ring)": refdof.Aperture.image(ring),
}
figure, axes = plt.subplots(3, 2, figsize=(8, 6.3), layout="constrained")
for panel, (title, aperture) in zip(axes.flat, apertures.items(), strict=True):
    truth = refdof.reference(scene, lens=replace(lens, aperture=aperture), samples=2048)
    panel.imshow(np.clip(truth.image, 0.0, 1.0) ** (1 / 2.2))
    panel.set_title(title, fontsize=10)
    panel.axis("off")
