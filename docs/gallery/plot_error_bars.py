"""
Error bars and samples
======================

Every reference comes with a standard error at each pixel. Here it is compared with the true error, which is known
because a picture with many more samples stands in for the truth.
"""

import matplotlib.pyplot as plt
import numpy as np

import refdof

scene = refdof.load_scene("fence")
camera = scene.camera.with_size((96, 72))
best = refdof.reference(scene, camera, samples=4096, seed=1)

# %%
# The same picture with fewer samples, by another seed.

counts = [16, 64, 256, 1024]
pictures = [refdof.reference(scene, camera, samples=count) for count in counts]
stated = [np.sqrt(np.mean(p.standard_error.astype(float) ** 2)) for p in pictures]
true = [refdof.metrics.rmse(best.image, p.image) for p in pictures]

figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
left.loglog(counts, true, "o-", label="true error (RMSE)")
left.loglog(counts, stated, "x--", label="stated standard error")
left.loglog(counts, true[0] * (np.array(counts) / counts[0]) ** -0.5, "k:", label="samples to the power of -1/2")
left.set(xlabel="samples per pixel", ylabel="linear value", title="Stated and true error")
left.legend()
right.imshow(np.minimum(pictures[1].standard_error.max(axis=2) * 10.0, 1.0), cmap="magma")
right.set_title("10 times the standard error, 64 samples")
right.axis("off")

# %%
# Independent random samples would follow the dotted line. Nets of points do better. The error sits where blurred edges
# are: a pixel that sees one plain surface through the whole lens has none.
#
# The noise floor says the same in one number: the PSNR of a perfect picture against this reference.

for count, picture in zip(counts, pictures, strict=True):
    scored = refdof.metrics.psnr(best.image, picture.image)
    print(f"{count:5d} samples: noise floor {picture.noise_floor_psnr:.2f} dB, PSNR against the best {scored:.2f} dB")
