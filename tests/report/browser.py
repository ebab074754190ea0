"""A page of a report in headless Chromium, and what a test does with it."""

import base64
import re
import time

import numpy as np

WAIT_S = 30.0


class Viewer:
    """An open page. Where a pixel lies on the screen is worked out here, from the picture's size and the stage's."""

    def __init__(self, page, path, size):
        self.page, self.size, self.faults, self.requests = page, size, [], []
        page.on("console", lambda message: message.type == "error" and self.faults.append(message.text))
        page.on("pageerror", lambda error: self.faults.append(str(error)))
        page.on("request", lambda request: self.requests.append(request.url))
        page.set_default_timeout(1000 * WAIT_S)
        page.goto(path.as_uri())
        self.shows(0)

    def until(self, code, *arguments):
        end = time.monotonic() + WAIT_S
        while not self.page.evaluate(code, *arguments):
            assert time.monotonic() < end, (
                f"never: {code} {arguments}; {self.page.inner_text('#legend')}; {self.faults}"
            )
            self.page.wait_for_timeout(10)

    def shows(self, image, mode="", stops=0):
        """Wait until the stage shows this image in this mode at this exposure, and the histogram is of it."""
        wanted = f"{image} {mode} {stops:g}"
        self.until("(wanted) => document.getElementById('view').dataset.shown === wanted", wanted)
        self.page.wait_for_timeout(50)

    def press(self, keys, *shown):
        """Press keys one after the other; then `shows`, if told what."""
        for key in keys.split():
            self.page.keyboard.press(key)
        if shown:
            self.shows(*shown)

    def fit(self):
        """Zoom, left and top of the picture in the stage [px] when all of it is seen."""
        box = self.page.locator("#view").bounding_box()
        zoom = min(round(box["width"]) / self.size[0], round(box["height"]) / self.size[1])
        zoom = int(zoom) if zoom > 1 else zoom
        left, top = (
            int(np.floor((round(box[side]) - count * zoom) / 2 + 0.5))
            for side, count in zip(("width", "height"), self.size, strict=True)
        )
        return zoom, left, top

    def on_screen(self, x, y):
        """The middle of a pixel of the whole picture, on the screen."""
        box = self.page.locator("#view").bounding_box()
        zoom, left, top = self.fit()
        return box["x"] + left + (x + 0.5) * zoom, box["y"] + top + (y + 0.5) * zoom

    def hover(self, x, y):
        self.page.mouse.move(*self.on_screen(x, y))
        self.page.wait_for_function(
            "([x, y]) => document.getElementById('at-x').value == x && document.getElementById('at-y').value == y",
            arg=[x, y],
        )
        self.until("() => !document.getElementById('readout').textContent.includes('\\u2026')")

    def readout(self):
        """{name: texts} of the read-out."""
        rows = self.page.evaluate(
            "[...document.querySelectorAll('#readout tr')].map((row) => "
            "[row.dataset.name, [...row.querySelectorAll('td')].map((cell) => cell.textContent)])"
        )
        return dict(rows)

    def numbers(self, name):
        return np.array([float(text) for text in self.readout()[name]])

    def canvas(self, selector="#view"):
        """The pixels of a canvas (H, W, 3)."""
        width, height, text = self.page.evaluate(
            """(selector) => {
                const canvas = document.querySelector(selector), {width, height} = canvas;
                const {data} = canvas.getContext("2d").getImageData(0, 0, width, height);
                let text = "";
                for (let k = 0; k < data.length; k += 4096) text += String.fromCharCode(...data.subarray(k, k + 4096));
                return [width, height, btoa(text)];
            }""",
            selector,
        )
        return np.frombuffer(base64.b64decode(text), np.uint8).reshape(height, width, 4)[..., :3].astype(int)

    def stage(self):
        """The whole picture (H, W, 3), from the middles of its pixels on the stage."""
        zoom, left, top = self.fit()
        columns, rows = (
            start + (np.arange(count) * zoom + zoom // 2)
            for start, count in ((left, self.size[0]), (top, self.size[1]))
        )
        return self.canvas()[np.ix_(rows, columns)]

    def profile(self, curve="shown"):
        """The values of a row's profile; NaN where there is a gap."""
        drawn = self.page.get_attribute(f"#profile .{curve}", "d") or ""
        values = np.full(self.size[0], np.nan)
        x = 0
        for command, first, second in re.findall(r"([MVH])(-?[\d.e+-]+)(?: (-?[\d.e+-]+))?", drawn):
            if command == "M":
                x, value = int(first), float(second)
            elif command == "V":
                value = float(first)
            else:
                assert int(first) == x + 1
                values[x] = value
                x += 1
        return values

    def text(self, selector):
        return self.page.inner_text(selector)
