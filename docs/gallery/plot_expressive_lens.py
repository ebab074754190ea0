"""
Aberrations as controls
=======================

A thin lens whose aberrations are set one by one (Lee, Eisemann and Seidel 2010, section 5.3), on lamps behind the plane
in focus and tiles in it.
"""

import matplotlib.pyplot as plt
import numpy as np

import refdof

# %%
# Ten white lamps behind the plane in focus, and under them tiles in it.

square = np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]])
faces = np.array([[0, 1, 2], [0, 2, 3]])
parts = []
for x in np.linspace(-1.5, 1.5, 5):
    for y in (0.25, 0.9):
        lamp = refdof.Material("unlit", base_color=(0.0, 0.0, 0.0), emission=(11.0, 11.0, 11.0))
        parts.append(refdof.Part(square * 0.024 + np.array([x, y, -6.0]), faces, lamp))
for column in range(-8, 8):
    for row in range(-6, 0):
        white = (column + row) % 2 == 0
        paint = refdof.Material("unlit", base_color=(0.75, 0.75, 0.7) if white else (0.12, 0.14, 0.2))
        corners = square * 0.06 + np.array([column * 0.12 + 0.06, row * 0.12 + 0.06, -3.0])
        parts.append(refdof.Part(corners, faces, paint))
camera = refdof.Camera.look_at((0, 0, 0), (0, 0, -1), fov_y=26.0, size=(240, 160))
shot = {"radius": 0.12, "focus_distance": 3.0, "focal_length": 0.1}
scene = refdof.Scene.from_parts("lamps", parts, camera, refdof.ThinLens(0.12, 3.0), background=(0.01, 0.01, 0.02))

# %%
# Off, and each control alone. Power and ray weights run from the middle of the lens to its rim, the offset of the image
# plane from the middle of the picture to its corner.

controls = {
    "none": {},
    "spherical aberration": {"power": (1.0, 1.0, 1.008)},
    "bokeh weights": {"ray_weights": (0.2, 0.5, 4.0)},
    "curvature of field": {"image_offset": (0.0, 0.0003, 0.0016)},
    "chromatic aberration": {"indices": (1.495, 1.500, 1.503)},
    "all": {
        "power": (1.0, 1.0, 1.004),
        "ray_weights": (0.2, 0.5, 4.0),
        "image_offset": (0.0, 0.0003, 0.0016),
        "indices": (1.495, 1.500, 1.503),
    },
}
figure, axes = plt.subplots(3, 2, figsize=(9, 9.2), layout="constrained")
for panel, (name, given) in zip(axes.flat, controls.items(), strict=True):
    truth = refdof.reference(scene, camera, refdof.ExpressiveLens(**shot, **given), samples=512)
    panel.imshow(np.clip(truth.image, 0.0, 1.0) ** (1 / 2.2))
    panel.set_title(name, fontsize=10)
    panel.axis("off")
