"""The shared context draws after wgpu has looked for devices, which leaves no context current."""

import numpy as np
import pytest
import wgpu


@pytest.fixture
def context_after_wgpu(opened_context, request):
    wgpu.gpu.enumerate_adapters_sync()
    return request.getfixturevalue("context")


def test_draws_after_another_library_looked_for_devices(context_after_wgpu):
    image = np.arange(4, dtype="f4")
    texture = context_after_wgpu.texture((2, 2), 1, image.tobytes(), alignment=4, dtype="f4")
    np.testing.assert_array_equal(np.frombuffer(texture.read(alignment=4), "f4").reshape(4), image)
    texture.release()
