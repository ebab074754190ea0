"""How the suite runs: hypothesis profiles, and a cache folder for each worker."""

import os
from pathlib import Path

from hypothesis import settings

# Numba's index of a cache folder is not safe while several processes compile: every xdist worker has its own folder.
if worker := os.environ.get("PYTEST_XDIST_WORKER"):
    cache = os.environ.get("REFDOF_CACHE_DIR") or Path.home() / ".cache" / "refdof" / "tests"
    os.environ["REFDOF_CACHE_DIR"] = str(Path(cache) / worker)

settings.register_profile("default", deadline=None, max_examples=50)
settings.register_profile("ci", deadline=None, max_examples=100, derandomize=True)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "default"))
