"""Make the pictures of the report's page anew: docs/report_1280.png and docs/report_390.png.

Needs Chromium and the extra `test`. Run it from the root of the repository: ``python docs/screenshots.py``.
"""

import io
import shutil
import tempfile
from pathlib import Path

from PIL import Image
from playwright.sync_api import Page, sync_playwright

import refdof
from refdof.compare import compare
from refdof.report import write_comparison

HERE = Path(__file__).parent
COMMAND = "refdof compare fence --size 320x240"
COLORS = 256  # of a palette: a third of the bytes

# Width and height of the window, its scheme, keys to press, and the pixel to point at, as shares of the stage.
SHOTS = ((1280, 900, "light", "8 d", (0.38, 0.35)), (390, 844, "dark", "2", (0.6, 0.45)))


def _shot(page: Page, path: Path, keys: str, place: tuple[float, float]) -> None:
    """Point at the stage, press keys, and write what is seen."""
    page.wait_for_selector("#view[data-shown]")
    for key in keys.split():
        page.keyboard.press(key)
    box = page.locator("#view").bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + place[0] * box["width"], box["y"] + place[1] * box["height"])
    page.wait_for_function("!document.getElementById('readout').textContent.includes('\u2026')")
    page.wait_for_timeout(500)
    with Image.open(io.BytesIO(page.screenshot())) as picture:
        reduced = picture.convert("RGB").quantize(COLORS, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    reduced.save(path, optimize=True)


def main() -> None:
    """Compare, write the report, and take pictures of it."""
    scene = refdof.load_scene("fence")
    found = compare(scene, list(refdof.METHODS), camera=scene.camera.with_size((320, 240)))
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        write_comparison(found, folder, COMMAND)
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        for width, height, scheme, keys, place in SHOTS:
            page = browser.new_page(viewport={"width": width, "height": height}, color_scheme=scheme)
            page.goto((Path(folder) / "report.html").as_uri())
            _shot(page, HERE / f"report_{width}.png", keys, place)
        browser.close()


if __name__ == "__main__":
    main()
