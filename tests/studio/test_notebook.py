"""The notebook's widget: the same state and messages as the page's, through anywidget."""

import queue

import numpy as np
import pytest

import refdof.studio
from refdof import InputError
from refdof.studio.page import view_module
from tests.studio import flat

pytestmark = pytest.mark.fast
WAIT = 120.0  # s: the first picture compiles


@pytest.fixture
def widget(tmp_path):
    made = refdof.studio.widget(flat.scene(), tmp_path)
    made.sent = queue.Queue()
    made.send = lambda content, buffers=None: made.sent.put((content, buffers or []))
    yield made
    made.close()


def message(widget, **wanted):
    while True:
        content, buffers = widget.sent.get(timeout=WAIT)
        if all(content.get(key) == value for key, value in wanted.items()):
            return content, buffers


def test_a_state_of_the_notebook_gets_pictures(widget):
    widget.set_state({"state": flat.state(3)})  # as a notebook's front end does
    content, (raw,) = message(widget, kind="picture", step="fine", id=3)
    picture = np.frombuffer(raw, dtype=np.uint8).reshape(content["height"], content["width"], 4)
    assert (picture[..., 3] == 255).all()
    assert picture[..., :3].max() > 0
    assert widget.scene["size"] == [flat.WIDTH, flat.HEIGHT]


def test_messages_are_answered(widget):
    widget._handle_custom_msg({"kind": "pick", "ask": 2, "pixel": [3, 20], "state": flat.state()}, [])
    assert message(widget, ask=2)[0]["depth"] == pytest.approx(flat.NEAR, rel=1e-6)
    widget._handle_custom_msg({"kind": "nix", "ask": 3}, [])
    assert message(widget, ask=3)[0]["kind"] == "error"


def test_its_module_is_the_pages(widget):
    assert str(widget._esm) == view_module()


def test_bad_input(tmp_path):
    with pytest.raises(InputError, match="scene: got 'nowhere'"):
        refdof.studio.widget("nowhere")
    with pytest.raises(InputError, match="folder"):
        refdof.studio.widget(flat.scene(), 3)


def test_without_the_extra_it_is_said(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "refdof.studio.notebook", None)
    with pytest.raises(InputError, match=r"refdof\[notebook\]"):
        refdof.studio.widget(flat.scene())
