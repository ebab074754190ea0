"""Fixtures: a browser, a server of the studio, and pages of it."""

from urllib.parse import urlsplit

import numpy as np
import pytest

import refdof
from tests.studio.browser import HOSTILE, SIZE, Studio, served, write_cards
from tests.studio.page import Page


@pytest.fixture
def page(tmp_path):
    """A page's end of a session, without a browser."""
    page = Page(tmp_path)
    yield page
    page.desk.close()
    assert page.errors == []


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    found = tmp_path_factory.mktemp("studio")
    write_cards(found / "cards.ply")
    (found / HOSTILE).write_bytes((found / "cards.ply").read_bytes())
    return found


@pytest.fixture(scope="module")
def url(browser, folder):
    with served(folder, "cards.ply") as (found, _):
        yield found


@pytest.fixture(scope="module")
def cards(folder):
    """Where the cards' middles are in the picture [px], and their depths."""
    scene = refdof.load_scene(folder / "cards.ply")
    x, y, depth = scene.camera.with_size(SIZE).project(write_cards(folder / "cards.ply")).T
    return np.stack([x, y], axis=1), depth


@pytest.fixture
def open_page(browser, url):
    """Opens pages; at the end none has had a fault, and all was fetched from the server."""
    contexts, opened = [], []

    def page(width=1280, height=900, **words):
        contexts.append(browser.new_context(viewport={"width": width, "height": height}, **words))
        opened.append(Studio(contexts[-1].new_page(), words.pop("url", url)))
        return opened[-1]

    yield page
    for studio in opened:
        assert studio.faults == []
        assert {urlsplit(request).netloc for request in studio.requests} == {urlsplit(url).netloc}
    for context in contexts:
        context.close()


@pytest.fixture
def studio(open_page):
    return open_page()


@pytest.fixture(scope="module")
def shared(browser, url):
    """One page for several tests."""
    context = browser.new_context(viewport={"width": 1280, "height": 900})
    studio = Studio(context.new_page(), url)
    yield studio
    assert studio.faults == []
    context.close()
