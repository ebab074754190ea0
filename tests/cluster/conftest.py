"""Worker processes, as few as possible: each takes a second to start."""

import os

import pytest

from refdof.cluster import connected


@pytest.fixture(scope="session")
def _log_name(tmp_path_factory):
    """Where tasks tell what they do; workers inherit the name."""
    return tmp_path_factory.mktemp("cluster") / "log"


@pytest.fixture
def log(_log_name, monkeypatch):
    monkeypatch.setenv("REFDOF_TEST_LOG", str(_log_name))
    _log_name.unlink(missing_ok=True)
    return _log_name


@pytest.fixture(scope="package")
def two(_log_name):
    """Two workers that no test kills."""
    os.environ["REFDOF_TEST_LOG"] = str(_log_name)
    try:
        with connected(workers=2) as cluster:
            yield cluster
    finally:
        del os.environ["REFDOF_TEST_LOG"]
