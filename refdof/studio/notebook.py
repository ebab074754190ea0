"""Notebook: the studio's view as a widget, with the same module and messages as the page."""

import sys
import traceback
from typing import Any

import anywidget
import traitlets

from refdof.scene.scene import Scene
from refdof.studio.desk import Desk
from refdof.studio.folder import Folder
from refdof.studio.page import page_file, view_module
from refdof.studio.session import Session

__all__ = ["StudioWidget"]


class StudioWidget(anywidget.AnyWidget):
    """A scene whose focus is set by clicks, below a cell of a notebook: `refdof.studio.widget`."""

    _esm = view_module()
    _css = page_file("studio.css")
    scene = traitlets.Dict().tag(sync=True)
    state = traitlets.Dict().tag(sync=True)

    def __init__(self, scene: Scene, name: str, folder: Folder) -> None:
        super().__init__()
        self._putting = False
        self._desk = Desk(lambda error: traceback.print_exception(error, file=sys.stderr))
        self._session = Session(self._desk, folder, scene, name, self._tell, self._put)
        self.observe(self._state_set, "state")
        self.on_msg(self._heard)

    def close(self) -> None:
        """Take the widget away, and end its thread."""
        self._session.close()
        self._desk.close()
        super().close()

    def _tell(self, message: dict[str, Any], buffers: list[bytes]) -> None:
        self.send(message, buffers)

    def _put(self, traits: dict[str, Any]) -> None:
        self._putting = True
        try:
            self.set_trait("scene", traits.get("scene", self.scene))
            self.set_trait("state", traits.get("state", self.state))
        finally:
            self._putting = False

    def _state_set(self, change: Any) -> None:
        if not self._putting:  # the page sends what it is given back, with a number of its own
            self._session.set_state(change["new"])

    def _heard(self, _: Any, content: Any, buffers: Any) -> None:
        self._session.receive(content, [bytes(part) for part in buffers or []])
