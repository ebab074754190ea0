"""A studio's server and pages of it in headless Chromium."""

import base64
import contextlib
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[2]
SIZE = (320, 240)  # of the pictures
WAIT_MS = 240_000  # what a picture needs may have to be compiled
HOSTILE = "<img src=x onerror=document.title='bad'>.ply"  # a file's name
LEFT, MIDDLE, RIGHT = range(3)
CARD_DEPTHS = (2.0, 0.0, -2.0)  # z of three cards, from left to right
_CHECKS = 8  # along a card
_SLANT = 0.3  # cards lean back: an upright one would be taken for the floor of a model whose z is up


_SERVE = f"""
import dataclasses, pathlib, sys, refdof
from refdof.studio.server import serve

scene = refdof.load_scene(sys.argv[1])
small = dataclasses.replace(scene, camera=scene.camera.with_size({SIZE}))
serve(small, sys.argv[1], pathlib.Path.cwd(), 0, None, lambda url: print(url, flush=True))
"""


def write_cards(path):
    """Three checkered cards side by side, the left one in front, as a PLY file; their middles (3, 3)."""
    corners, colors, faces = [], [], []
    for card, z in enumerate(CARD_DEPTHS):
        for row in range(_CHECKS):
            for column in range(_CHECKS):
                x, y = 1.1 * (card - 1) - 0.5 + column / _CHECKS, row / _CHECKS
                start, side = len(corners), 1 / _CHECKS
                around = [(x, y), (x + side, y), (x + side, y + side), (x, y + side)]
                corners += [(*place, z - _SLANT * place[1]) for place in around]
                colors += [(230, 230, 230) if (row + column) % 2 else (20, 20, 20)] * 4
                faces += [(start, start + 1, start + 2), (start, start + 2, start + 3)]
    lines = ["ply", "format ascii 1.0", f"element vertex {len(corners)}"]
    lines += [f"property float {axis}" for axis in "xyz"] + [f"property uchar {c}" for c in ("red", "green", "blue")]
    lines += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    lines += [" ".join(map(str, (*place, *color))) for place, color in zip(corners, colors, strict=True)]
    lines += [" ".join(map(str, (3, *face))) for face in faces]
    path.write_text("\n".join(lines) + "\n")
    return np.array([[1.1 * (card - 1), 0.5, z - 0.5 * _SLANT] for card, z in enumerate(CARD_DEPTHS)])


@contextlib.contextmanager
def served(folder, scene):
    """What `refdof studio` serves in a folder, with small pictures; its URL and the process."""
    words = [sys.executable, "-c", _SERVE, scene]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    with subprocess.Popen(words, cwd=folder, env=environment, stdout=subprocess.PIPE, text=True) as process:
        try:
            found = re.search(r"http://127\.0\.0\.1:\d+/\?token=\S+", process.stdout.readline())
            assert found, f"the server told no URL and ended with {process.poll()}"
            yield found[0], process
        finally:
            process.send_signal(signal.SIGINT)
            process.wait(timeout=30)


class Studio:
    """A page of the studio, and what a test does with it."""

    def __init__(self, page, url):
        self.page, self.faults, self.requests = page, [], []
        page.on("console", lambda message: message.type == "error" and self.faults.append(message.text))
        page.on("pageerror", lambda error: self.faults.append(str(error)))
        page.on("request", lambda request: self.requests.append(request.url))
        page.on("websocket", lambda socket: self.requests.append(socket.url.replace("ws://", "http://")))
        page.set_default_timeout(20_000)
        page.goto(url)
        self.settled()

    def about(self, name):
        return self.page.locator(".view").get_attribute(f"data-{name}")

    def until(self, code):
        """Wait for an expression to be true; Playwright's own way is eval, which the page forbids."""
        end = time.monotonic() + WAIT_MS / 1000
        while not self.page.evaluate(code):
            assert time.monotonic() < end, f"never: {code}; {self.page.locator('.status').inner_text()}"
            self.page.wait_for_timeout(20)

    def settled(self):
        """Wait for the fine picture of the newest state."""
        self.until(
            "(({id, wanted, step}) => id !== undefined && id === wanted && step !== 'coarse')"
            "(document.querySelector('.view')?.dataset ?? {})"
        )

    @contextlib.contextmanager
    def changed(self):
        """Wait, after what is done inside, for the fine picture of a newer state than before."""
        before = int(self.about("wanted"))
        yield
        self.until(f"Number(document.querySelector('.view').dataset.wanted) > {before}")
        self.settled()

    def pixels(self):
        """The canvas (H, W, 4)."""
        code = """() => {
            const {width, height} = document.querySelector('canvas.picture');
            const {data} = document.querySelector('canvas.picture').getContext('2d').getImageData(0, 0, width, height);
            let text = '';
            for (let k = 0; k < data.length; k += 4096) text += String.fromCharCode(...data.subarray(k, k + 4096));
            return [width, height, btoa(text)];
        }"""
        width, height, text = self.page.evaluate(code)
        return np.frombuffer(base64.b64decode(text), dtype=np.uint8).reshape(height, width, 4)

    def sharpness(self, places, half=12):
        """Gradient energy of green in a window about each place [px]."""
        green = self.pixels()[..., 1].astype(float)
        windows = [green[int(y) - half : int(y) + half, int(x) - half : int(x) + half] for x, y in places]
        return np.array([np.mean(np.diff(w, axis=0) ** 2) + np.mean(np.diff(w, axis=1) ** 2) for w in windows])

    def on_screen(self, place):
        """Where a pixel of the picture is on the screen."""
        box = self.page.locator("canvas.picture").bounding_box()
        return box["x"] + box["width"] * place[0] / SIZE[0], box["y"] + box["height"] * place[1] / SIZE[1]

    def click(self, place, *, shift=False):
        with self.changed():
            if shift:
                self.page.keyboard.down("Shift")
            self.page.mouse.click(*self.on_screen(place))
            if shift:
                self.page.keyboard.up("Shift")

    def fill(self, label, value):
        """Type a number."""
        with self.changed():
            self.page.get_by_label(label, exact=True).fill(str(value))
            self.page.keyboard.press("Enter")

    def value(self, label):
        return self.page.get_by_label(label, exact=True).input_value()

    def button(self, name, *, exact=True):
        return self.page.get_by_role("button", name=name, exact=exact)

    def marker(self, number):
        """Middle of a point's marker on the screen."""
        box = self.page.locator(".marker").nth(number - 1).bounding_box()
        return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
