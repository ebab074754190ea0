"""
The report
==========

A comparison in Python, and the files that `refdof compare` writes of it: tables, pictures, plots for papers, and
``report.html``, an offline page to flip images in place.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt

import refdof
from refdof.compare import compare
from refdof.report import write_comparison

scene = refdof.load_scene("fence")
camera = scene.camera.with_size((160, 120))
found = compare(scene, ["scatter", "mipmap", "lensblur"], camera=camera, samples=64)
with tempfile.TemporaryDirectory() as folder:
    write_comparison(found, folder, "refdof compare fence --size 160x120 --samples 64")
    print(*sorted(path.name for path in Path(folder).iterdir()), sep="\n")
    print((Path(folder) / "table.tex").read_text())
    plot = plt.imread(Path(folder) / "scores.png")

# %%
# Error over time of every method, ``scores.png`` and ``scores.svg``:

figure, axes = plt.subplots(figsize=(6, 4.3), layout="constrained")
axes.imshow(plot)
axes.axis("off")

# %%
# The page at 1280 px and at 390 px, a telephone's width; :doc:`/report` lists its keys.

for width, size in ((1280, (10, 7.1)), (390, (4, 8.7))):
    figure, axes = plt.subplots(figsize=size, layout="constrained")
    axes.imshow(plt.imread(f"../report_{width}.png"))
    axes.axis("off")
