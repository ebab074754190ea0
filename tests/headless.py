"""Headless Chromium by Playwright, for tests of pages; see `tests.ports.chromium.program` on a missing one."""

import contextlib

from playwright.sync_api import sync_playwright

from tests.ports import chromium


@contextlib.contextmanager
def launched():
    """A browser."""
    found = chromium.program()
    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=found, args=["--no-sandbox", "--disable-dev-shm-usage"])
        yield opened
        opened.close()
