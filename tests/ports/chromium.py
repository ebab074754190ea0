"""A headless Chromium and a server for it.

The browser is driven over a pipe by its DevTools protocol: JSON messages that end with a zero byte.
"""

import base64
import contextlib
import fcntl
import functools
import http.server
import json
import os
import select
import shutil
import signal
import threading
import time

import pytest

PROGRAMS = ("chromium", "chromium-browser", "google-chrome")
_OPTIONS = (
    "--headless=new",
    "--no-sandbox",  # containers allow none
    "--use-angle=swiftshader",  # WebGL on the CPU
    "--enable-unsafe-swiftshader",
    "--window-size=1100,900",
    "--disable-background-timer-throttling",  # of tabs behind others
    "--disable-renderer-backgrounding",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-dev-shm-usage",  # small in containers
    "--disable-extensions",
    "--remote-debugging-pipe",
)


def program():
    """Path of a Chromium; without one, the test is skipped, or fails where REFDOF_REQUIRE_CHROMIUM is 1."""
    found = next((found for found in map(shutil.which, PROGRAMS) if found), None)
    if found is None:
        reason = f"no Chromium: none of {', '.join(PROGRAMS)}"
        if os.environ.get("REFDOF_REQUIRE_CHROMIUM") == "1":
            pytest.fail(f"REFDOF_REQUIRE_CHROMIUM is set, but there is {reason}", pytrace=False)
        pytest.skip(reason)
    return found


class _Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *words):
        pass


@contextlib.contextmanager
def served(folder):
    """Serve a folder on this computer; the address."""
    handler = functools.partial(_Quiet, directory=folder)
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            yield f"http://127.0.0.1:{server.server_port}"
        finally:
            server.shutdown()
            thread.join()


class Browser:
    """One browser process; `close` ends it. `folder` gets its profile and its downloads."""

    def __init__(self, command, folder):
        self._ours, theirs, self._count, self._buffer = [], [], 0, b""
        for mine, other in ((1, 0), (0, 1)):  # what we write is its descriptor 3, what we read its 4
            ends = os.pipe()
            self._ours.append(ends[mine])
            theirs.append(fcntl.fcntl(ends[other], fcntl.F_DUPFD_CLOEXEC, 10))  # above those that it gets
            os.close(ends[other])
        moves = [(os.POSIX_SPAWN_DUP2, end, target) for target, end in enumerate(theirs, 3)]
        quiet = [(os.POSIX_SPAWN_OPEN, target, os.devnull, os.O_RDWR, 0) for target in (1, 2)]
        words = [command, *_OPTIONS, f"--user-data-dir={folder / 'profile'}", "about:blank"]
        self._process = os.posix_spawn(command, words, os.environ, file_actions=quiet + moves, setpgroup=0)
        for end in theirs:
            os.close(end)
        (folder / "downloads").mkdir()
        self.downloads = folder / "downloads"
        self.send("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(self.downloads))

    def close(self):
        os.killpg(self._process, signal.SIGKILL)
        os.waitpid(self._process, 0)
        for end in self._ours:
            os.close(end)

    def send(self, method, session=None, **params):
        """Send a command and return its result."""
        self._count += 1
        message = {"id": self._count, "method": method, "params": params, **({"sessionId": session} if session else {})}
        os.write(self._ours[0], json.dumps(message).encode() + b"\0")
        while True:
            answer = self._receive(60.0)
            if answer.get("id") == self._count:
                assert "error" not in answer, answer
                return answer["result"]

    def _receive(self, seconds):
        while b"\0" not in self._buffer:
            ready, _, _ = select.select([self._ours[1]], [], [], seconds)
            assert ready, f"Chromium was silent for {seconds:g} s"
            more = os.read(self._ours[1], 1 << 20)
            assert more, "Chromium has ended"
            self._buffer += more
        message, _, self._buffer = self._buffer.partition(b"\0")
        return json.loads(message)


class Tab:
    """One page of a browser."""

    def __init__(self, browser, before=""):
        """`before` is a script that runs before those of the page."""
        self._browser = browser
        self._target = browser.send("Target.createTarget", url="about:blank")["targetId"]
        attached = browser.send("Target.attachToTarget", targetId=self._target, flatten=True)
        self._session = attached["sessionId"]
        self.send("Page.enable")
        self.send("Page.addScriptToEvaluateOnNewDocument", source=before)

    def close(self):
        self._browser.send("Target.closeTarget", targetId=self._target)

    def send(self, method, **params):
        return self._browser.send(method, self._session, **params)

    def open(self, url):
        said = self.send("Page.navigate", url=url)
        assert "errorText" not in said, said
        self.until("document.readyState === 'complete'")

    def value(self, code):
        """The value of an expression; promises are awaited."""
        done = self.send("Runtime.evaluate", expression=code, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in done, done["exceptionDetails"]
        return done["result"].get("value")

    def until(self, code, seconds=60.0):
        end = time.monotonic() + seconds
        while not self.value(code):
            assert time.monotonic() < end, f"not within {seconds:g} s: {code}"
            time.sleep(0.02)

    def choose(self, selector, path):
        """Choose a file, or a folder, in an <input type=file>."""
        node = self.send("DOM.querySelector", nodeId=self.send("DOM.getDocument")["root"]["nodeId"], selector=selector)
        self.send("DOM.setFileInputFiles", nodeId=node["nodeId"], files=[str(path)])

    def drop(self, path):
        """Drag a file or folder to the middle of the page and drop it."""
        data = {"items": [], "files": [str(path)], "dragOperationsMask": 1}
        for kind in ("dragEnter", "dragOver", "drop"):
            self.send("Input.dispatchDragEvent", type=kind, x=400, y=200, data=data)

    def picture(self, path):
        """Write a PNG of the page as it is."""
        path.write_bytes(base64.b64decode(self.send("Page.captureScreenshot", captureBeyondViewport=True)["data"]))
