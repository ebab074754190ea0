"""The OpenGL context that all tests here share. REFDOF_REQUIRE_GL=1 makes a missing one a failure."""

import os

import pytest

from tests.gl.shader import GLMissing, open_context

_RENDERER = pytest.StashKey[str]()


@pytest.fixture
def context(opened_context):
    """Made the current one for each test: a library that looks for devices, such as wgpu, leaves none current."""
    with opened_context:
        yield opened_context


@pytest.fixture(scope="session")
def opened_context(pytestconfig):
    try:
        opened = open_context()
    except GLMissing as missing:
        if os.environ.get("REFDOF_REQUIRE_GL") == "1":
            pytest.fail(f"REFDOF_REQUIRE_GL is set, but there is {missing}", pytrace=False)
        pytest.skip(str(missing))
    pytestconfig.stash[_RENDERER] = f"{opened.info['GL_RENDERER']}, OpenGL {opened.info['GL_VERSION']}"
    return opened


def pytest_terminal_summary(terminalreporter, config):
    if _RENDERER in config.stash:
        terminalreporter.write_line(f"GL_RENDERER: {config.stash[_RENDERER]}")
