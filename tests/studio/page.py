"""A page for tests: it sends what a page sends, and keeps what it is told."""

import queue

import numpy as np

from refdof.studio.desk import Desk
from refdof.studio.folder import Folder
from refdof.studio.session import Session
from tests.studio import flat

WAIT = 120.0  # s: the first picture compiles


class Page:
    """Sends what a page sends, and keeps what it is told."""

    def __init__(self, root, scene=None, name="flat"):
        self.told, self.put, self.errors = queue.Queue(), queue.Queue(), []
        self.desk = Desk(self.errors.append)
        tell = lambda message, buffers: self.told.put((message, buffers))  # noqa: E731
        self.session = Session(self.desk, Folder(root), scene or flat.scene(), name, tell, self.put.put)
        self.first = self.put.get(timeout=WAIT)
        self.asked = 0

    def message(self, **wanted):
        """The next message with these values; others are dropped."""
        while True:
            message, buffers = self.told.get(timeout=WAIT)
            if message["kind"] == "error" and wanted.get("kind") != "error":
                raise AssertionError(message["text"])
            if all(message.get(key) == value for key, value in wanted.items()):
                return message, buffers

    def picture(self, state, step="fine"):
        self.session.set_state(state)
        message, (raw,) = self.message(kind="picture", id=state["id"], step=step)
        rgba = np.frombuffer(raw, dtype=np.uint8).reshape(message["height"], message["width"], 4)
        assert (rgba[..., 3] == 255).all()
        return message, rgba[..., :3]

    def call(self, **content):
        self.asked += 1
        self.session.receive({**content, "ask": self.asked})
        return self.message(ask=self.asked)[0]

    def error(self, **content):
        self.asked += 1
        self.session.receive({**content, "ask": self.asked})
        return self.message(kind="error", ask=self.asked)[0]["text"]
