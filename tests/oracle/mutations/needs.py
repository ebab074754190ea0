"""What the machine needs to run the ports: a C compiler, OpenGL and Vulkan."""

import os
import shutil
from pathlib import Path

import pytest

from tests.oracle.shaders.cases import need

__all__ = ["need_all"]


def need_all(folder: Path) -> None:
    """Skip where something is missing, or fail where REFDOF_REQUIRE_CC, _GL or _VULKAN is 1."""
    if shutil.which("cc") is None:
        reason = "no C compiler: there is no `cc`"
        if os.environ.get("REFDOF_REQUIRE_CC") == "1":
            pytest.fail(f"REFDOF_REQUIRE_CC is set, but {reason}", pytrace=False)
        pytest.skip(reason)
    need("frag", folder)
    need("wgsl", folder)
