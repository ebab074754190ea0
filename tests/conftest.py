"""How the suite runs: threads, hypothesis profiles, and a browser."""

import os

import pytest
from hypothesis import settings

# Pytest's workers share processors. OpenMP's threads, which wait for more work by counting, took more than half of the
# time of all of them; now they sleep. OpenMP reads this when Numba first runs a parallel loop.
os.environ.setdefault("OMP_WAIT_POLICY", "passive")

settings.register_profile("default", deadline=None, max_examples=50)
settings.register_profile("ci", deadline=None, max_examples=100, derandomize=True)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "default"))


def pytest_collection_modifyitems(items):
    """Files with a slow test come first: at the end, workers would wait for one of them."""
    slow = {item.path for item in items if item.get_closest_marker("slow")}
    items.sort(key=lambda item: item.path not in slow)


@pytest.fixture(scope="module")
def browser():
    """Chromium. It ends with the file of tests: Playwright's event loop would be in the way of others."""
    from tests.headless import launched  # Playwright is slow to import

    with launched() as opened:
        yield opened
