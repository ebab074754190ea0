"""How the suite runs: hypothesis profiles, and which files are quick enough to run without compiling."""

import os
from pathlib import Path

import pytest
from hypothesis import settings

settings.register_profile("default", deadline=None, max_examples=50)
settings.register_profile("ci", deadline=None, max_examples=100, derandomize=True)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "default"))

# Tiny pictures: seconds even where every kernel is interpreted. `make fast` and the pass with bounds checks run these.
FAST = {
    "test_aperture.py",
    "test_attributes.py",
    "test_bad_calls.py",
    "test_baselines.py",
    "test_camera.py",
    "test_cascaded.py",
    "test_check.py",
    "test_contract.py",
    "test_depth_format.py",
    "test_fetches.py",
    "test_gaussian.py",
    "test_gpu_model.py",
    "test_hostile.py",
    "test_jit.py",
    "test_lens.py",
    "test_lens_pattern.py",
    "test_matting.py",
    "test_mipmap.py",
    "test_multiview.py",
    "test_multiview_edges.py",
    "test_lensblur.py",
    "test_mipmap_interpolation.py",
    "test_nbuffer.py",
    "test_owen.py",
    "test_planar.py",
    "test_rendering.py",
    "test_sampling.py",
    "test_scatter.py",
    "test_singlepass.py",
    "test_stated_numbers.py",
    "test_texture.py",
    "test_umbra.py",
}


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if Path(item.fspath).name in FAST:
            item.add_marker(pytest.mark.fast)
