"""Benchmark: how soon the pages of a report show, in headless Chromium, from the navigation to the first picture.

1. an index of 100 scenes of 320x240 with ten methods each, and one of its pages          goal: below 3 s
2. one page of 1920x1080, and a flip to a method that was not shown before

Pictures are the scene `fence` seen by a pinhole; "methods" are means of shifted copies, with a little noise, so that
they take as much room as real ones.

    python benchmarks/report_pages.py [--scenes 100] [--json out.json]
"""

import argparse
import json
import math
import shutil
import tempfile
import time
from pathlib import Path

import numpy as np
from playwright.sync_api import sync_playwright

import refdof
from refdof.comparison import Comparison, Row
from refdof.image.atomic import write_text
from refdof.report.page import index_page, report_page
from refdof.view import View

GOAL_S = 3.0
METHODS = 10
NOISE = 1e-3  # standard deviation of what differs from pixel to pixel

# Painted: two frames after the stage says which image it shows.
SHOWN = """(wanted) => new Promise((done) => {
  const view = document.getElementById("view");
  const look = () => {
    if (view.dataset.shown?.startsWith(wanted)) requestAnimationFrame(() => requestAnimationFrame(done));
    else setTimeout(look, 5);
  };
  look();
})"""
PAINTED = "() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"


def comparison(size, name="fence"):
    """A comparison whose pictures are made in a moment."""
    scene = refdof.load_scene("fence")
    view = View(scene, scene.camera.with_size(size), scene.lens)
    pinhole = view.pinhole().color
    random = np.random.default_rng(size[0])

    def picture(reach):
        shifts = [(reach * math.cos(angle), reach * math.sin(angle)) for angle in np.linspace(0, 6, 8)]
        mean = np.mean([np.roll(pinhole, (round(y), round(x)), (0, 1)) for x, y in shifts], axis=0, dtype=np.float32)
        return np.maximum(mean + random.normal(0.0, NOISE, mean.shape), 0.0).astype(np.float32)

    reference = picture(2.0)
    rows = []
    for k in range(METHODS):
        image = picture(2.0 + k)
        rmse = float(np.sqrt(np.mean((image - reference) ** 2)))
        scores = {"psnr": -20.0 * math.log10(rmse), "ssim": 0.9, "flip": 0.1, "rmse": rmse}
        flip_map = np.clip(np.abs(image - reference).mean(axis=2) * 2.0, 0.0, 1.0)
        rows.append(Row(f"method {k}", {"samples": 64}, image, scores, 0.1, 0.01 * (k + 1), flip_map=flip_map))
    return Comparison(
        name, view.camera, view.lens, pinhole, reference, np.full_like(reference, NOISE), 256.0, 3.0, 53.0, tuple(rows),
        depth=view.pinhole().depth, coc_px=view.coc_px(), surface_counts=view.surface_counts(),
    )  # fmt: skip


def opened(browser, path, ready, argument=None):
    """A page, and the seconds from its navigation until it shows."""
    page = browser.new_page(viewport={"width": 1280, "height": 900})
    start = time.perf_counter()
    page.goto(path.as_uri(), wait_until="commit")
    page.wait_for_load_state("domcontentloaded")
    page.evaluate(ready, argument)
    return page, time.perf_counter() - start


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", type=int, default=100)
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    found = {"scenes": options.scenes}
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        root = Path(folder)
        small = comparison((320, 240))
        names = [f"scene {k}" for k in range(options.scenes)]
        start = time.perf_counter()
        write_text(root / "report.html", index_page([small] * options.scenes, names))
        found["index_write_s"] = time.perf_counter() - start
        for name in names:
            (root / name).mkdir()
        start = time.perf_counter()
        write_text(root / names[0] / "report.html", report_page(small))
        found["page_write_s"] = time.perf_counter() - start
        for name in names[1:]:
            shutil.copy(root / names[0] / "report.html", root / name)
        start = time.perf_counter()
        large = root / "large.html"
        write_text(large, report_page(comparison((1920, 1080))))
        found["large_write_s"] = time.perf_counter() - start
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        for key, path, ready in (
            ("index", root / "report.html", PAINTED),
            ("page", root / names[0] / "report.html", SHOWN),
            ("large", large, SHOWN),
        ):
            found[f"{key}_mb"] = path.stat().st_size / 1e6
            page, found[f"{key}_s"] = opened(browser, path, ready, "0 ")
            if ready is SHOWN:
                start = time.perf_counter()
                page.keyboard.press("5")
                page.evaluate(SHOWN, "6 ")
                found[f"{key}_flip_s"] = time.perf_counter() - start
                start = time.perf_counter()
                page.keyboard.press("r")
                page.evaluate(SHOWN, "0 ")
                found[f"{key}_back_s"] = time.perf_counter() - start
            page.close()
        browser.close()
    for key, value in found.items():
        print(f"{key:>16} {value:8.3g}")
    met = "met" if found["index_s"] < GOAL_S else "missed"
    print(f"goal: an index of {options.scenes} scenes below {GOAL_S:g} s: {met}")
    if options.json:
        options.json.write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
