"""The N-buffer in WGSL: every level equals refdof's, bit for bit.

REFDOF_REQUIRE_VULKAN=1 makes a missing software renderer a failure.
"""

import os
from pathlib import Path

import numpy as np
import pytest

from refdof.raster.filters.n_buffer import n_buffer

SOURCE = (Path(__file__).parents[2] / "ports" / "wgsl" / "nbuffer.wgsl").read_text()


@pytest.fixture(scope="module")
def device():
    try:
        wgpu = pytest.importorskip("wgpu")
        found = [one for one in wgpu.gpu.enumerate_adapters_sync() if one.info["adapter_type"] == "CPU"]
        found = [one for one in found if one.info["backend_type"] == "Vulkan"]
        assert found, "there is no software renderer for Vulkan"
    except (pytest.skip.Exception, AssertionError, RuntimeError) as missing:
        if os.environ.get("REFDOF_REQUIRE_VULKAN") == "1":
            pytest.fail(f"REFDOF_REQUIRE_VULKAN is set, but: {missing}", pytrace=False)
        pytest.skip(str(missing))
    return found[0].request_device_sync()


def levels_of(device, source, depth, count):
    """`count` levels (count, H, W, 2): minimum, maximum."""
    import wgpu

    height, width = depth.shape
    usage = wgpu.TextureUsage
    code = device.create_shader_module(code=source)
    steps = {
        word: device.create_compute_pipeline(layout="auto", compute={"module": code, "entry_point": word})
        for word in ("bottom", "double")
    }

    def texture(kind):
        return device.create_texture(
            size=(width, height, 1),
            format=kind,
            usage=usage.TEXTURE_BINDING | usage.STORAGE_BINDING | usage.COPY_SRC | usage.COPY_DST,
        )

    previous = texture("r32float")
    layout = {"bytes_per_row": 4 * width, "rows_per_image": height}
    device.queue.write_texture({"texture": previous}, depth.tobytes(), layout, (width, height, 1))
    levels = []
    for level in range(count):
        step, target = steps["double" if level else "bottom"], texture("rg32float")
        entries = [
            {"binding": 0, "resource": previous.create_view()},
            {"binding": 1, "resource": target.create_view()},
        ]
        if level:
            data = np.array([2 ** (level - 1), 0, 0, 0], dtype="<u4").tobytes()
            side = device.create_buffer_with_data(data=data, usage=wgpu.BufferUsage.UNIFORM)
            entries.append({"binding": 2, "resource": {"buffer": side, "offset": 0, "size": 16}})
        encoder = device.create_command_encoder()
        work = encoder.begin_compute_pass()
        work.set_pipeline(step)
        work.set_bind_group(0, device.create_bind_group(layout=step.get_bind_group_layout(0), entries=entries))
        work.dispatch_workgroups(-(-width // 8), -(-height // 8))
        work.end()
        device.queue.submit([encoder.finish()])
        layout = {"bytes_per_row": 8 * width, "rows_per_image": height}
        levels.append(device.queue.read_texture({"texture": target}, layout, (width, height, 1)))
        previous = target
    return np.stack([np.frombuffer(data, "<f4").reshape(height, width, 2) for data in levels])


def picture(height, width):
    random = np.random.default_rng(5)
    depth = random.uniform(0.5, 90.0, (height, width)).astype(np.float32)
    depth[random.random((height, width)) < 0.3] = np.inf
    depth[: height // 2, : width // 3] = np.inf  # squares that hold nothing
    return depth


@pytest.mark.parametrize(("height", "width"), [(37, 53), (48, 64), (1, 9), (5, 64), (1, 1)])
def test_every_level_is_refdof_s_bit_for_bit(device, height, width):
    depth = picture(height, width)
    expected = n_buffer(depth)
    found = levels_of(device, SOURCE, depth, len(expected.lowest))
    assert np.array_equal(found[..., 0].view(np.uint32), expected.lowest.view(np.uint32))
    assert np.array_equal(found[..., 1].view(np.uint32), expected.highest.view(np.uint32))


def test_a_level_is_the_extremes_of_squares(device):
    """By their definition, without refdof."""
    depth = picture(11, 14)
    found = levels_of(device, SOURCE, depth, 5)
    for level in range(5):
        for y, x in np.ndindex(depth.shape):
            square = depth[y : y + 2**level, x : x + 2**level]
            full = square[np.isfinite(square)]
            wanted = (full.min(), full.max()) if full.size else (np.inf, -np.inf)
            assert tuple(found[level, y, x]) == wanted


FAULTS = {
    "the neighbour is one pixel away": ("pixel.xy + side", "pixel.xy + min(side, 1u)"),
    "the neighbour is a pixel short": ("pixel.xy + side", "pixel.xy + side - min(side, 1u) * u32(side > 1u)"),
    "the last corner is missing": ("min(c.x, d.x)", "c.x"),
    "the picture ends a column early": ("size - 1u", "size - min(size, vec2u(2u))"),
    "empty pixels count in the maximum": ("bitcast<f32>(bits | 0x80000000u)", "bitcast<f32>(bits)"),
    "the maximum is a minimum": ("max(c.y, d.y)", "min(c.y, d.y)"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_no_planted_fault_passes(device, fault):
    assert SOURCE.count(FAULTS[fault][0]) == 1
    depth = picture(37, 53)
    expected = n_buffer(depth)
    found = levels_of(device, SOURCE.replace(*FAULTS[fault]), depth, len(expected.lowest))
    assert (found[..., 0] != expected.lowest).any() or (found[..., 1] != expected.highest).any()
