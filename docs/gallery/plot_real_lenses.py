"""
Real lenses
===========

Lamps behind the plane in focus, seen through a thin lens and through real ones. What a real lens adds comes by itself
from its surfaces and glasses: discs are cut to the shape of cat's eyes toward the corners, where rims block light
(vignetting); their edges are coloured, and brighter or darker than their middle (axial colour, spherical aberration);
toward the corners of a simple lens they are drawn out (coma, astigmatism), and the plane in focus is bent.
"""

import matplotlib.pyplot as plt
import numpy as np

import refdof

# %%
# A grid of small white lamps.

lamps = []
square = np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]]) * 0.008
for x in np.linspace(-1.6, 1.6, 7):
    for y in np.linspace(-1.0, 1.0, 5):
        material = refdof.Material("unlit", base_color=(0.0, 0.0, 0.0), emission=(12.0, 12.0, 12.0))
        lamps.append(refdof.Part(square + np.array([x, y, -5.0]), np.array([[0, 1, 2], [0, 2, 3]]), material))
camera = refdof.Camera.look_at((0, 0, 0), (0, 0, -1), size=(300, 200))
thin = refdof.ThinLens(radius=0.045, focus_distance=3.0)
scene = refdof.Scene.from_parts("lamps", lamps, camera, thin, background=(0.01, 0.01, 0.02))

# %%
# Each lens is scaled so that its entrance pupil has the thin lens's radius, and the camera gets its field of view.

figure, axes = plt.subplots(2, 2, figsize=(9, 6.2), layout="constrained")
for panel, name in zip(axes.flat, ("thin lens", "double_gauss", "petzval", "biconvex"), strict=True):
    if name == "thin lens":
        lens = thin
        view = refdof.SystemLens(refdof.load_lens("double_gauss"), 3.0).seen_by(camera)
    else:
        system = refdof.load_lens(name)
        scale = 1000.0 * refdof.SystemLens(system, 3.0).radius / thin.radius
        lens = refdof.SystemLens(system, 3.0, mm_per_unit=scale)
        view = lens.seen_by(camera)
    truth = refdof.reference(scene, view, lens, samples=512)
    panel.imshow(np.clip(truth.image, 0.0, 1.0) ** (1 / 2.2))
    panel.set_title(name, fontsize=10)
    panel.axis("off")
