"""Benchmark: how soon a click in the studio shows, in a browser, from the event to the picture on the canvas.

1. start `refdof studio town`, open its page in headless Chromium, wait for the first fine picture
2. click, for the first time, and wait for the coarse and the fine picture                        "first click"
3. click again and again, each time somewhere else                                                "click"
4. click while the fine picture of a click before is being made                                   "click soon after"
5. the same with a focal surface through three points, and after an orbit, which needs new layers

Targets on 2 cores, 640x480, 64 lens rays per pixel: coarse below 0.5 s and fine below 3 s after the first click.

    python benchmarks/studio.py [--clicks 7] [--json out.json]
"""

import argparse
import json
import shutil
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from playwright.sync_api import sync_playwright

from refdof._jit import thread_count

COARSE_S, FINE_S = 0.5, 3.0
WIDTH, HEIGHT = 640, 480  # of the scene's own shot
PLACES = ((0.5, 0.6), (0.3, 0.7), (0.7, 0.55), (0.45, 0.8), (0.6, 0.7), (0.25, 0.55), (0.8, 0.75))  # of the picture
SOON_MS = 250  # between two clicks, of which the second comes while the first one's fine picture is made
WAIT_MS = 300_000  # the first picture may compile for a minute

# Note when pictures of states newer than the event's are drawn; the canvas has them when the attributes change.
WATCH = """() => {
  const view = document.querySelector(".view");
  window.seen = [];
  window.pressed = [];
  addEventListener("pointerdown", () => pressed.push(performance.now()), true);
  new MutationObserver(() => seen.push([performance.now(), Number(view.dataset.id), view.dataset.step]))
    .observe(view, {attributes: true});
}"""

FINE = """(after) => {
  const shown = document.querySelector(".view")?.dataset;
  return shown?.step === "fine" && Number(shown.id) > after;
}"""


class Studio:
    """The page of a running server, driven like a person does."""

    def __init__(self, page):
        self.page = page
        self.settled()
        page.evaluate(WATCH)

    def newest(self):
        """Number of the picture that is shown."""
        return int(self.page.get_attribute(".view", "data-id") or -1)

    def settled(self, after=-1):
        """Wait for a fine picture of a state after this one."""
        fine = "(after) => { const d = document.querySelector('.view')?.dataset; "
        self.page.wait_for_function(
            fine + "return d?.step === 'fine' && Number(d.id) > after; }", arg=after, timeout=WAIT_MS
        )

    def click(self, place, **words):
        """Click at a place in the picture."""
        box = self.page.locator("canvas.picture").bounding_box()
        self.page.mouse.move(box["x"] + place[0] * box["width"], box["y"] + place[1] * box["height"])
        self.page.keyboard.down("Shift") if words.get("shift") else None
        self.page.mouse.down()
        self.page.mouse.up()
        self.page.keyboard.up("Shift") if words.get("shift") else None

    def timed(self, place, soon_after=None, **words):
        """Seconds from a click to the next coarse and the next fine picture; a click before it may still be at work."""
        if soon_after is not None:
            self.click(soon_after)
            self.page.wait_for_timeout(SOON_MS)
        before = self.newest()  # the coarse picture of the click before is shown by now
        self.click(place, **words)
        self.settled(before)
        pressed = self.page.evaluate("pressed.at(-1)")
        seen = [(step, at) for at, number, step in self.page.evaluate("seen") if number > before and at > pressed]
        return tuple((next(at for kind, at in seen if kind == step) - pressed) / 1e3 for step in ("coarse", "fine"))


def measured(page, clicks):
    """Rows of name, coarse and fine seconds."""
    studio = Studio(page)
    rows = [("first click", [studio.timed(PLACES[0])])]
    places = [PLACES[k % len(PLACES)] for k in range(clicks + 2)]
    rows.append(("click", [studio.timed(place) for place in places[1:-1]]))
    rows.append(("click soon after", [studio.timed(places[k + 1], places[k]) for k in range(clicks)]))
    for place in PLACES[:2]:
        studio.timed(place, shift=True)
    moved = [(0.35 + 0.04 * k, 0.5) for k in range(clicks)]  # no marker is there: a click on one chooses it
    third = [studio.timed(place) for place in moved]
    rows.append(("focal surface, a point moved", third))
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--clicks", type=int, default=7)
    parser.add_argument("--json", type=Path)
    given = parser.parse_args()
    browser = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    command = [sys.executable, "-m", "refdof.cli", "studio", "town", "--no-open"]
    with (
        tempfile.TemporaryDirectory() as folder,
        subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, text=True) as server,
        sync_playwright() as play,
    ):
        try:
            assert server.stdout is not None
            url = server.stdout.readline().strip()
            chrome = play.chromium.launch(executable_path=browser, args=["--no-sandbox"])
            page = chrome.new_page(viewport={"width": 1280, "height": 900})
            page.goto(url)
            rows = measured(page, given.clicks)
            chrome.close()
        finally:
            server.terminate()
    print(f"town, {WIDTH}x{HEIGHT}, lensblur, 64 lens rays, {thread_count()} threads; median (most) seconds")
    figures = []
    for name, times in rows:
        coarse, fine = zip(*times, strict=True)
        figures.append({"what": name, "coarse_s": statistics.median(coarse), "fine_s": statistics.median(fine)})
        shown = [
            f"{step} {statistics.median(values):.3f} ({max(values):.3f})"
            for step, values in (("coarse", coarse), ("fine", fine))
        ]
        print(f"{name:32} {'  '.join(shown)}")
    met = figures[0]["coarse_s"] < COARSE_S and figures[0]["fine_s"] < FINE_S
    print(f"first click below {COARSE_S} s and {FINE_S} s: {'yes' if met else 'NO'}")
    if given.json is not None:
        given.json.write_text(
            json.dumps({"coarse_target_s": COARSE_S, "fine_target_s": FINE_S, "rows": figures}, indent=2)
        )


if __name__ == "__main__":
    main()
