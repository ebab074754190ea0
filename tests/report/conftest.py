"""Fixtures: pages of reports in it that have no fault and fetch nothing."""

import pytest

from tests.report.browser import Viewer


@pytest.fixture
def open_report(browser, tmp_path):
    """Opens the text of a page; at the end none has had a fault, or asked for anything but itself."""
    contexts, opened = [], []

    def page(text, size, width=1280, height=900, **words):
        contexts.append(browser.new_context(viewport={"width": width, "height": height}, offline=True, **words))
        path = tmp_path / f"page {len(opened)}.html"
        path.write_text(text, encoding="utf-8")
        opened.append((Viewer(contexts[-1].new_page(), path, size), path))
        return opened[-1][0]

    yield page
    for viewer, path in opened:
        assert viewer.faults == []
        assert set(viewer.requests) <= {path.as_uri()}
    for context in contexts:
        context.close()
