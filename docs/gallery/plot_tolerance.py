"""
A tolerance instead of a sample count
=====================================

With ``tolerance`` the reference spends samples where they are needed: at blurred edges and around small lamps. A
forecast from a few tiles tells the cost beforehand.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm

import refdof

scene = refdof.load_scene("cans")
camera = scene.camera.with_size((240, 180))
print(refdof.forecast(scene, camera, tolerance=0.004))

# %%
# The forecast is not the whole truth, but it has the right size.

truth = refdof.reference(scene, camera, tolerance=0.004)
print(f"{truth.samples.mean():.0f} samples per pixel, {truth.seconds:.1f} s; {truth.unmet:.1%} of the pixels unmet")

figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.9), layout="constrained")
left.imshow(np.clip(truth.image, 0.0, 1.0) ** (1 / 2.2))
left.set_title("reference")
spent = right.imshow(truth.samples, norm=LogNorm(), cmap="viridis")
right.set_title("samples per pixel")
figure.colorbar(spent, ax=right)
for panel in (left, right):
    panel.axis("off")
