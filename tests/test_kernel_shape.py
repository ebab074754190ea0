"""Kernels of made-up methods, whose shapes are known, and of the methods in the package."""

import math
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter, shift

from refdof import METHODS, InputError
from refdof.kernel_shape import kept_kernel_shapes, kernel_shape
from refdof.methods._contract import Method
from tests.methods.naive_baselines import disc_shares


@dataclass(frozen=True)
class Nothing:
    """No parameters."""


def made_up(monkeypatch, picture):
    """A method that makes `picture(view)`."""
    record = Method("none", "none", "single image", (), Nothing, (), None, ("None.",))
    module = SimpleNamespace(METHOD=record, Params=Nothing, render=lambda view, _params, _recorder: picture(view))
    monkeypatch.setitem(METHODS, "made_up", module)


def of_color(monkeypatch, blur):
    made_up(monkeypatch, lambda view: np.stack([blur(view.pinhole().color[..., c].astype(float)) for c in range(3)], 2))


@pytest.mark.parametrize("light", [1, 2, 5])
def test_the_impulse_is_what_it_is_said_to_be(monkeypatch, light):
    seen = []

    def picture(view):
        pinhole, coc = view.pinhole(), view.coc_px()
        seen.append((pinhole, coc))
        return pinhole.color

    made_up(monkeypatch, picture)
    for in_front in (False, True):
        found = kernel_shape("made_up", 6.0, light, in_front)
        # P and the depths are exact, up to some roundings of float64.
        np.testing.assert_allclose(seen[-1][1], -6.0 if in_front else 6.0, rtol=1e-12)
        color, depth = seen[-1][0]
        np.testing.assert_allclose(depth, 1.0 if in_front else 2.0, rtol=1e-15)
        y, x = np.nonzero(color.any(axis=2))
        assert (len(y), np.ptp(y) + 1, np.ptp(x) + 1) == (light * light, light, light)
        assert (color[y, x] == 1.0).all()
        assert found.energy == 1.0
        assert (found.radius, found.offset_x, found.offset_y) == pytest.approx((0.0, 0.0, 0.0), abs=1e-6)
    assert len(seen) == 8
    assert len({tuple(np.argwhere(color.any(axis=2)).min(axis=0)) for (color, _), _ in seen[:4]}) == 4


def test_a_gaussian_kernel(monkeypatch):
    of_color(monkeypatch, lambda image: gaussian_filter(image, 5.0, truncate=6.0, mode="constant"))
    found = kernel_shape("made_up", 8.0)
    # sqrt(2) deviations over 8 / sqrt(2); 6 deviations keep all but 2e-8.
    assert found.radius == pytest.approx(math.sqrt(2.0) * 5.0 / (8.0 / math.sqrt(2.0)), rel=1e-5)
    assert (found.offset_x, found.offset_y, found.anisotropy) == pytest.approx((0.0, 0.0, 0.0), abs=1e-6)
    assert found.energy == pytest.approx(1.0, rel=1e-6)
    # Half the size of the light is taken off: the kernel is the same.
    for light in (2, 4, 8):
        assert kernel_shape("made_up", 8.0, light).radius == pytest.approx(found.radius, rel=1e-5)


def test_a_kernel_that_is_moved_stretched_and_dimmed(monkeypatch):
    def blur(image):
        return 0.7 * shift(gaussian_filter(image, (6.0, 3.0), truncate=6.0, mode="constant"), (2, -1), order=0)

    of_color(monkeypatch, blur)
    found = kernel_shape("made_up", 8.0)
    # Down by 2 and to the left by 1; variances 36 and 9, cut at 6 deviations.
    assert (found.offset_x, found.offset_y) == pytest.approx((-1.0, 2.0), abs=1e-6)
    assert found.anisotropy == pytest.approx(27.0 / 45.0, rel=1e-5)
    assert found.radius == pytest.approx(math.sqrt(45.0 / 32.0), rel=1e-5)
    assert found.energy == pytest.approx(0.7, rel=1e-6)


def test_a_method_that_loses_the_light(monkeypatch):
    of_color(monkeypatch, np.zeros_like)
    found = kernel_shape("made_up")
    assert found.energy == 0.0
    assert all(map(math.isnan, found[:4]))


def test_scatter_spreads_light_over_a_disc_of_pixels():
    shares = disc_shares(8.0)
    variance = sum(share * (i * i + j * j) for (i, j), share in shares.items())
    assert variance == pytest.approx(
        32.0 + 1.0 / 6.0, abs=0.05
    )  # the disc's, and a pixel's; the rim is not independent
    found = kernel_shape("scatter", 8.0)
    assert found.radius == pytest.approx(math.sqrt(variance / 32.0), abs=1e-4)  # float32 sums of 200 terms: 1e-5
    assert found.energy == pytest.approx(1.0, abs=1e-4)
    assert found.anisotropy < 1e-4


@pytest.mark.parametrize("name", ["lensblur", "multiview"])
def test_rays_spread_light_over_the_disc(name):
    found = kernel_shape(name, 8.0)
    # 64 points spread evenly over the lens: their second moments miss a disc's by 1/64 at most.
    assert found.radius == pytest.approx(1.0, abs=1 / 64)
    assert math.hypot(found.offset_x, found.offset_y) < 8.0 / 64
    assert found.anisotropy < 2 / 64


@pytest.mark.parametrize("name", METHODS)
def test_records_tell_what_is_measured(name):
    found = kernel_shape(name)
    assert (found.radius, found.energy) == pytest.approx(METHODS[name].METHOD.kernel, abs=0.005 + 1e-9)  # two digits


def test_kernels_are_measured_once(monkeypatch, tmp_path):
    monkeypatch.setattr("refdof._store.results_folder", lambda: tmp_path)
    calls, told = [], []

    def blur(image):
        calls.append(None)
        return 0.5 * image

    of_color(monkeypatch, blur)
    for _ in range(2):
        (found,) = kept_kernel_shapes([("made_up", "best", {})], lambda done, count: told.append((done, count)))
        assert found == kernel_shape("made_up")
        assert found.energy == 0.5
    assert len(calls) == 3 * 12  # four places, three channels: one for the store, two beside it
    assert told == [(0, 1), (0, 1)]


def test_bad_kernels_are_named():
    for words, message in (
        ({"method": "none"}, "method: got 'none'"),
        ({"circle": 1.0}, "circle: got 1; allowed is a finite number >= 2 and <= 32"),
        ({"light": 9}, "light: got 9; allowed is a whole number in 1 .. 8"),
        ({"in_front": 1}, "in_front: got 1"),
        ({"params": {"no": 1}}, "parameter of scatter: got 'no'"),
        ({"params": 3}, "params: got int; allowed is a Mapping"),
    ):
        with pytest.raises(InputError, match=message):
            kernel_shape(**{"method": "scatter", **words})
