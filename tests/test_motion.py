"""Flicker of made-up methods over a move that is known to the pixel, and of the reference."""

import math
from dataclasses import replace

import numpy as np
import pytest

from refdof import METHODS, InputError, ThinLens, View
from refdof.comparison import Row
from refdof.motion import blurred_in_all, flickers, moved_views, small_size, with_motion
from tests import flat_scene
from tests.fake_comparison import comparison
from tests.test_kernel_shape import made_up

P, FOCUS = 64.0, 4.0
SHOT = flat_scene.camera(32, 24, P)


def view(near=2.0, radius=0.5):
    """A card to the left of the middle, near, before a wall in focus."""
    card = flat_scene.rectangle(-9.0, 0.0, -9.0, 9.0, near, (0.9, 0.5, 0.1))
    wall = flat_scene.rectangle(-9.0, 9.0, -9.0, 9.0, FOCUS, (0.2, 0.2, 0.2))
    scene = flat_scene.scene_of([card, wall], SHOT, ThinLens(radius, FOCUS))
    return View(scene, scene.camera, scene.lens)


def test_the_focal_plane_moves_by_a_sixteenth_of_a_pixel():
    views = moved_views(view())
    assert len(views) == 16
    points = np.array([[0.0, 0.0, -FOCUS], [0.3, 0.2, -2.0 * FOCUS], [0.1, -0.2, -FOCUS / 2.0]])
    first = SHOT.project(points)
    for k, one in enumerate(views):
        moved = one.camera.project(points) - first
        # To the left, by k / 16 px; half of that twice as far, twice half as far. Roundings of float64.
        np.testing.assert_allclose(moved[:, 0], np.array([-1.0, -0.5, -2.0]) * k / 16.0, atol=1e-11)
        np.testing.assert_allclose(moved[:, 1:], 0.0, atol=1e-11)
        assert one.lens is views[0].lens


def test_only_what_no_frame_has_sharp_counts():
    views = moved_views(view())
    region = blurred_in_all(views)
    # The card's edge starts between columns 15 and 16, and moves to the left by 2 px * 15 / 16 in all.
    assert (region == region[:1]).all()
    # The last frame has its last pixel in column 13, whose circle of 8 px, and a pixel, end before column 22.
    assert np.flatnonzero(region[0]).tolist() == list(range(22))


def test_a_method_that_jumps_once(monkeypatch):
    def picture(one):
        late = one.camera.eye[0] > 7.5 * FOCUS / P / 16.0
        return np.full((24, 32, 3), 0.6 if late else 0.2)

    made_up(monkeypatch, picture)
    found = flickers(view(), ["made_up"], samples=16)
    # 0.4 in two of 14 times. The reference's own is taken off: it is small.
    assert found["made_up"] == pytest.approx(0.8 / 14.0 - found["reference"], rel=1e-12)
    assert abs(found["reference"]) < 0.005


def test_the_reference_flickers_as_the_truth_does_whatever_its_noise():
    # At distance t right of the card's edge, in radii of its circle, the card covers the lens's part beyond t: the
    # integral of 2 / pi sqrt(1 - t^2). Its second derivative is largest at the rim, where it has no bound, but over
    # frames 1/8 px apart it is a second difference of this.
    def covered(t):
        t = np.clip(t, -1.0, 1.0)
        return 0.5 - (t * np.sqrt(1.0 - t * t) + np.arcsin(t)) / math.pi

    circle = P * 0.5 * (1.0 / 2.0 - 1.0 / FOCUS)  # 8 px
    frames = [covered((np.arange(22) + 0.5 - (16.0 - 2.0 * k / 16.0)) / circle) for k in range(16)]
    change = np.diff(np.stack(frames), n=2, axis=0)
    contrast = np.abs(np.array([0.9, 0.5, 0.1]) - 0.2).mean()
    truth = contrast * np.abs(change).mean()
    # Each of 14 x 24 x 22 x 3 values has noise of 0.02, sqrt(6) times that in a second difference; that of channels is
    # the same, that of rows is not.
    noise = math.sqrt(6.0) * 0.02 * contrast
    found = flickers(view(), [], samples=64)["reference"]
    assert abs(found) <= truth + 4.0 * noise / math.sqrt(14 * 24 * 22)
    # Its noise alone would be more than ten times the truth.
    assert noise * math.sqrt(2.0 / math.pi) > 10 * truth


def test_methods_flicker_more_than_the_reference():
    found = flickers(view(), ["scatter", "singlepass"], samples=256, frames=8)
    assert list(found) == ["reference", "scatter", "singlepass"]
    # The pinhole's edge jumps once by a pixel, 1/16 of the card's fade: its contrast of 0.3 by 1/16 twice in six times.
    # An eighth of that, over 17 of 22 columns.
    assert min(found["scatter"], found["singlepass"]) > 0.3 / 16 * 2 / 6 / 8


def frame_of(one):
    return round(one.camera.eye[0] * 16.0 * P / FOCUS)


def test_a_method_that_swings_in_a_comparison(monkeypatch):
    def picture(one):
        image = np.full((24, 32, 3), 0.5, dtype=np.float32)
        image[:, :24] += (-1.0) ** frame_of(one) / 64.0  # where no frame is sharp
        image[:, 24:] += frame_of(one) % 3  # does not count
        return image

    def truth(one, other):
        # It has a second difference of 2 / 1024 in every frame, and row 7 moves most.
        image = np.full((24, 32, 3), frame_of(one) ** 2 / 1024.0, dtype=np.float32)
        image[7] *= 2.0
        image[:, 24:] = frame_of(one)
        image[3, 24:] *= 2.0  # more than row 7, but in focus
        seen.append(other)
        return image

    made_up(monkeypatch, picture)
    seen, told, rows = [], [], [Row("made_up", {}, None, {}, 0.0, 0.0, kind) for kind in ("best", "paper")]
    given = comparison(methods=())
    found = with_motion(replace(given, rows=rows), moved_views(view(), 5), 16, truth, lambda *done: told.append(done))
    # d, -d, d: 4 d. One row of 24 has twice the reference's. Exact in float32, roundings of a mean of float64.
    own = 2.0 / 1024.0 * 25.0 / 24.0
    assert found.motion.flicker["reference"] == pytest.approx(own, rel=1e-12)
    for row in found.rows:
        assert row.artefacts["flicker"] == found.motion.flicker[row.name] == pytest.approx(4.0 / 64.0 - own, rel=1e-12)
    assert list(found.motion.pictures) == ["reference", "made_up", "made_up (paper)"]
    assert (found.motion.row, found.motion.frames, found.motion.size) == (7, 5, (32, 24))
    assert found.motion.strips["reference"][:, 0, 0].tolist() == [2.0 * k * k / 1024.0 for k in range(5)]
    assert seen == [0] * 5 + [1] * 5
    assert told == [(k, 20) for k in range(20)]  # two sequences of the reference, and two rows


def test_frames_are_small():
    for size, small in (
        ((640, 480), (160, 120)),
        ((48, 36), (48, 36)),
        ((480, 640), (90, 120)),
        ((1600, 20), (160, 11)),  # no less than the window of SSIM
        ((9, 5), (9, 5)),
    ):
        assert small_size(size) == small


def test_nothing_out_of_focus_has_no_flicker():
    assert math.isnan(flickers(view(near=FOCUS), [], samples=16, frames=3)["reference"])


def test_bad_moves_are_named():
    far = view()
    far = View(far.scene, far.camera, ThinLens(0.5, math.inf))
    for call, message in (
        (lambda: moved_views(far), "view: got a lens focused at infinity"),
        (lambda: moved_views(view(), 2), "frames: got 2"),
        (lambda: moved_views(3), "view: got int"),
        (lambda: flickers(view(), ["none"]), "methods: got 'none'"),
        (lambda: flickers(view(), [], seed=-1), "seed: got -1"),
        (lambda: flickers(view(), list(METHODS), samples=0), "samples: got 0"),
    ):
        with pytest.raises(InputError, match=message):
            call()
