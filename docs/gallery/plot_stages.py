"""
Stages of a method
==================

Whoever ports a method wants to know where the port goes wrong. Ask for ``stages`` and every intermediate result comes
back as an array. These are the stages of ``singlepass``.
"""

import matplotlib.pyplot as plt
import numpy as np

import refdof

scene = refdof.load_scene("cans")
camera = scene.camera.with_size((320, 240))
result = refdof.render("singlepass", scene, camera, stages=True)
for name, stage in result.stages.items():
    print(f"{name}: {stage.shape} {stage.dtype}")

# %%
# ``coc`` is the signed circle of confusion in pixels: blue in front of the focal plane, red behind it. ``size`` is what
# the method makes of it. ``taps`` is the spiral that every pixel walks along.

coc, taps = result.stages["coc"], result.stages["taps"]
figure, axes = plt.subplots(2, 2, figsize=(10, 7.6), layout="constrained")
largest = np.abs(coc).max()
shown = axes[0, 0].imshow(coc, cmap="coolwarm", vmin=-largest, vmax=largest)
figure.colorbar(shown, ax=axes[0, 0], label="px")
axes[0, 0].set_title("coc")
shown = axes[0, 1].imshow(result.stages["size"], cmap="magma")
figure.colorbar(shown, ax=axes[0, 1], label="px")
axes[0, 1].set_title("size")
axes[1, 0].plot(taps[:, 0], taps[:, 1], "-", color="0.8", linewidth=0.5)
axes[1, 0].scatter(taps[:, 0], taps[:, 1], s=6)
axes[1, 0].set(title="taps", xlabel="x [px]", ylabel="y, down [px]", aspect="equal")
axes[1, 0].invert_yaxis()
axes[1, 1].imshow(np.clip(result.image, 0.0, 1.0) ** (1 / 2.2))
axes[1, 1].set_title("image")
for panel in (axes[0, 0], axes[0, 1], axes[1, 1]):
    panel.axis("off")
