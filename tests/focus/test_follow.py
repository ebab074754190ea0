"""Focus points on geometry that moves: they keep their place, stay sharp, and fade smoothly in time."""

import json
import math
import tomllib
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from typer.testing import CliRunner

from refdof import Camera, InputError, ThinLens, View, load_scene, render
from refdof.cli import app
from refdof.focus.fading import shares
from refdof.focus.focus_lens import KINDS, Focus, focus_lens
from refdof.focus.point import FocusPoint, pick, placed
from refdof.image.file import load_image
from tests.animated_gltf import Builder
from tests.flat_scene import rectangle, scene_of

CAMERA = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov_y=40.0, size=(48, 36))
LENS = ThinLens(0.2, 4.0)
THIRDS = (1.0, 1.0, 1.0)
COUNT = 48  # frames


def flight(move, parts=None):
    """A view of cards whose first one, two triangles, is at `move(frame)` (x, y, z) from its start."""
    parts = parts or [
        rectangle(-0.4, 0.4, -0.4, 0.4, 3.0, (0.9, 0.5, 0.1)),
        rectangle(-9.0, 9.0, -9.0, 9.0, 12.0, (0.2, 0.4, 0.8)),
    ]
    scene = scene_of(parts, CAMERA, LENS)
    shifts = np.zeros((COUNT, len(scene.vertices), 3))
    shifts[:, scene.faces[:2].ravel()] = np.array([move(frame) for frame in range(COUNT)])[:, None]
    return View(scene.with_frames(scene.vertices + shifts), CAMERA, LENS)


def away(frame):
    return 0.01 * frame, 0.005 * frame, -0.1 * frame


def share_of(view, frame, triangle=0):
    barycentrics = np.array([[1.0, 1.0, 1.0]]) / 3.0
    return float(shares(np.array([triangle]), barycentrics, view, frame)[0])


def test_a_point_keeps_its_place_on_a_turning_object(tmp_path):
    """Its world place at each frame is the turn of the one where it was picked, by hand, to roundings."""
    made = Builder()
    corners = np.array([[-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]], dtype=np.float32)
    made.node(root=True, mesh=made.mesh((corners, [[0, 1, 2], [0, 2, 3]], {}, {})))
    angles = np.radians([0.0, 40.0])
    turns = np.stack([0 * angles, np.sin(angles / 2), 0 * angles, np.cos(angles / 2)], axis=1)
    made.move(0, "rotation", [0.0, 1.0], turns)
    scene = load_scene(made.write(tmp_path))
    view = View(scene, Camera((0, 0, 6), (0, 0, 0), fov_y=40.0, size=(48, 36)), LENS)
    at, point = 6, pick(view.at_frame(6), (29, 12))

    def place(frame):
        posed = scene.at_frame(frame)
        return np.array(point.barycentrics) @ posed.vertices[posed.faces[point.triangle]]

    for frame in (0, 3, 11.5, 24):
        turn = math.radians(40.0 * (frame - at) / 24.0)
        c, s = math.cos(turn), math.sin(turn)
        x, y, z = place(at)
        # Quaternions in the file are float32 and differ from the angle's by 6e-8; the triangle's own place does not.
        np.testing.assert_allclose(place(frame), (c * x + s * z, y, c * z - s * x), atol=1e-6)
        assert np.linalg.norm(place(frame)) == pytest.approx(np.linalg.norm(place(at)), abs=1e-9)
        posed = scene.at_frame(frame).vertices[scene.faces[point.triangle]]
        np.testing.assert_allclose(
            np.linalg.norm(place(frame) - posed, axis=1),
            np.linalg.norm(place(at) - scene.at_frame(at).vertices[scene.faces[point.triangle]], axis=1),
            atol=1e-9,
        )
    found = placed([point], view, at)
    np.testing.assert_allclose(found.places[0], (29.5, 12.5), atol=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_a_point_stays_sharp_at_every_frame(kind):
    """One point: its own depth is in focus all over the picture, to roundings of numbers near 1."""
    view = flight(away)
    point = pick(view.at_frame(9), (26, 17))
    blurs = []
    for frame in range(0, COUNT, 5):
        lens = focus_lens(Focus((point,), kind), view, frame)
        depth = placed([point], view, frame).depth[0]
        assert depth == pytest.approx(3.0 + 0.1 * frame, abs=1e-9)
        circle = np.abs(lens.coc_px(np.full((36, 48), depth), CAMERA))
        assert circle.max() < 1e-6  # [px]; inverse distances cancel to 1e-15, times P E / ... of 1e2 px, and more
        blurs.append(float(np.abs(LENS.coc_px(depth, CAMERA))))
    assert max(blurs) > 1.0  # a lens that stays where it was blurs it


def test_two_points_that_move_apart_stay_sharp():
    """A card flies off, a wall stays. A point lies up to 0.71 px from its pixel's centre, where the surface is another.

    On the way to the other point, d px off, the inverse distance changes by 1/3 - 1/12 at most. A cubic falloff is at
    most 3 times as steep as the straight line: 3 * 0.71 / d of P E (1/3 - 1/12) = 2.5 px; with d >= 12, below 0.5 px,
    the radius of a pixel.
    """
    view = flight(away)
    points = (pick(view, (24, 18)), pick(view, (6, 6)))
    for frame in range(0, COUNT, 6):
        found = placed(list(points), view, frame)
        assert math.dist(*found.places) > 12.0
        lens = focus_lens(Focus(points), view, frame)
        inverse = lens.inverse_focus(CAMERA)
        for (x, y), depth in zip(found.places, found.depth, strict=True):
            circle = CAMERA.pixels_per_tangent * LENS.radius * abs(inverse[int(y), int(x)] - 1.0 / depth)
            assert circle < 0.5


def passing(first):
    """A wall's point, triangle 2, before which a card stands from frame `first` on; before, it is far aside."""
    parts = [rectangle(-0.4, 0.4, -0.4, 0.4, 3.0), rectangle(-0.3, 0.3, -0.3, 0.3, 6.0)]
    return flight(lambda frame: (0.0 if frame >= first else 50.0, 0.0, 0.0), parts)


def test_a_point_that_is_hidden_at_once_fades_over_half_a_second():
    view = passing(20)
    found = [share_of(view, frame, 2) for frame in range(COUNT)]
    assert found[:14] == [1.0] * 14
    assert found[26:] == [0.0] * (COUNT - 26)
    # Weights (1 + cos(pi k / 7)) / 14: from frame 19, all beyond k = 0 are hidden, and 4/7 remain.
    assert found[19] == pytest.approx(4 / 7, abs=1e-12)
    assert found[20] == pytest.approx(3 / 7, abs=1e-12)
    assert max(abs(b - a) for a, b in pairwise(found)) == pytest.approx(1 / 7, abs=1e-12)
    still = replace(view.scene.at_frame(20), animation=None)
    assert share_of(View(still, CAMERA, LENS), 20, 2) == 0.0  # without time, it jumps


def test_what_passes_for_one_frame_hardly_counts():
    parts = [rectangle(-0.4, 0.4, -0.4, 0.4, 3.0), rectangle(-0.3, 0.3, -0.3, 0.3, 6.0)]
    view = flight(lambda frame: (0.0 if frame == 20 else 50.0, 0.0, 0.0), parts)
    assert share_of(view, 20, 2) == pytest.approx(6 / 7, abs=1e-12)


def test_a_point_has_faded_out_when_it_leaves():
    """A card jumps out of the picture at frame 20: the share is 0 from there on, and 1 until 13 frames before."""
    view = flight(lambda frame: (50.0 if frame >= 20 else 0.0, 0.0, 0.0))
    found = [share_of(view, frame) for frame in range(COUNT)]
    assert found[20:] == [0.0] * (COUNT - 20)
    assert found[:8] == [1.0] * 8
    assert found == sorted(found, reverse=True)
    assert max(abs(b - a) for a, b in pairwise(found)) == pytest.approx(1 / 7, abs=1e-12)
    with pytest.raises(InputError, match="points: none of them is in the picture"):
        placed([FocusPoint(0, THIRDS)], view, 20)
    assert placed([FocusPoint(0, THIRDS, keep=True)], view, 20).weight[0] == 1.0


def test_a_point_behind_the_camera_does_not_count():
    """It flies through the plane of the lens from one frame to the next."""
    view = flight(lambda frame: (0.0, 0.0, 40.0 if frame >= 20 else 0.0))
    assert [share_of(view, frame) for frame in (20, 21, 30)] == [0.0] * 3
    assert 0.0 < share_of(view, 14) < 1.0


@pytest.mark.parametrize("kind", KINDS)
def test_the_lens_changes_smoothly(kind):
    """A point on a card at 6 is hidden at once, one on the wall at 12 stays: the focus goes over as the share does.

    A plane through both points, or a surface, does not depend on their weights; so weights alone would jump at the end.
    The mean of distances does: weights are s 6 / 6 and 6 / 12. Below a share of 1/2, twice it is left of the point.
    """
    parts = [rectangle(-0.4, 0.4, -0.4, 0.4, 3.0), rectangle(-0.3, 0.3, -0.3, 0.3, 6.0)]
    parts.append(rectangle(-9.0, 9.0, -9.0, 9.0, 12.0))
    view = flight(lambda frame: (0.0 if frame >= 20 else 50.0, 0.0, 0.0), parts)
    near, wall = FocusPoint(2, THIRDS), pick(view, (8, 8))

    def inverse(points, frame):
        return focus_lens(Focus(points, kind), view, frame).inverse_focus(CAMERA)

    both, alone = inverse((near, wall), 0), inverse((wall,), 0)
    assert np.abs(both - alone).max() > 0.01
    frames = [inverse((near, wall), frame) for frame in range(10, 30)]
    for frame, found in enumerate(frames, 10):
        share = share_of(view, frame, 2)
        if kind == "distance":
            both = (share / 6.0 + 0.5 / 12.0) / (share + 0.5)
        left = min(2.0 * share, 1.0)
        np.testing.assert_allclose(found, left * both + (1.0 - left) * alone, rtol=1e-9)  # through focal lengths
    steps = [np.abs(after - before).max() for before, after in pairwise(frames)]
    assert max(steps) < np.abs(frames[0] - alone).max() * 2.0 / 7.0 + 1e-9


def test_a_frame_alone_is_the_frame_of_a_sequence():
    view, focus = passing(20), Focus((FocusPoint(2, THIRDS), FocusPoint(0, THIRDS, keep=True)))
    sequence = [focus_lens(focus, view, frame).inverse_focus(CAMERA) for frame in range(14, 28)]
    for frame in (27, 20, 14):
        alone = focus_lens(focus, passing(20), frame)
        np.testing.assert_array_equal(alone.inverse_focus(CAMERA), sequence[frame - 14])
        posed = View(passing(20).scene.at_frame(frame), CAMERA, LENS)  # at the scene's own frame
        np.testing.assert_array_equal(focus_lens(focus, posed).inverse_focus(CAMERA), sequence[frame - 14])


def test_a_still_scene_looks_at_no_other_frame(monkeypatch):
    view = flight(away)
    still = View(replace(view.scene, animation=None), CAMERA, LENS)
    monkeypatch.setattr(View, "at_frame", lambda self, frame: self if self is still else pytest.fail("another frame"))
    made = []
    monkeypatch.setattr(View, "product", lambda self, name, build: made.append(name) or build())
    placed([FocusPoint(0, THIRDS)], still, 7)
    assert set(made) == {"pinhole", "layers 1", "surfaces", "tracer"}


def lift(folder):
    """A GLB file: a card that comes nearer, before a wall; seen by a camera of the file that stands still."""
    made = Builder()
    card = np.array([[-0.7, -0.7, 0], [0.7, -0.7, 0], [0.7, 0.7, 0], [-0.7, 0.7, 0]], dtype=np.float32)
    faces = [[0, 1, 2], [0, 2, 3]]
    made.node(root=True, mesh=made.mesh((card, faces, {}, {})))
    made.node(root=True, mesh=made.mesh((card * 20, faces, {}, {})), translation=[0, 0, -6])
    made.header["cameras"] = [{"type": "perspective", "perspective": {"yfov": 0.8, "aspectRatio": 4 / 3, "znear": 0.1}}]
    made.node(root=True, camera=0, translation=[0, 0, 6])
    made.move(0, "translation", [0.0, 0.25], [[0, 0, 0], [0, 0, 3]])
    return made.write(folder)


def command(*words):
    return CliRunner().invoke(app, [*words], catch_exceptions=False).stdout


def test_the_command_line_follows_an_animation(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    lift(tmp_path)
    size = ["--size", "24x18"]
    early = command("pick", "moving.glb", "--pixel", "12,9", "--frame", "0", *size)
    late = command("pick", "moving.glb", "--pixel", "12,9", "--frame", "6", *size)
    assert early != late  # another place of the card, which is nearer
    assert command("pick", "moving.glb", "--pixel", "12,9", *size) == early
    # Half the card is 0.7 P / 6 = 2.5 px wide at frame 0, and 5.0 at frame 6: pixel 8 is the wall's, then the card's.
    found = [json.loads(command("pick", "moving.glb", "--pixel", "8,9", "--frame", f, "--json", *size)) for f in "06"]
    card = tomllib.loads(early)["point"][0]["triangle"] // 2
    assert [point["triangle"] // 2 for point in found] == [1 - card, card]
    (tmp_path / "focus.toml").write_text(early)
    words = ["focus", "moving.glb", "--points", "focus.toml", "--method", "scatter", "--format", "npy", *size]
    assert command(*words, "--out", "all", "--frames", "0:7").strip() == "out=all, frames=7"
    command(*words, "--out", "one", "--frames", "5:6")
    assert (tmp_path / "one" / "00005.npy").read_bytes() == (tmp_path / "all" / "00005.npy").read_bytes()
    scene = load_scene(tmp_path / "moving.glb")
    for frame, depth in ((0, 6.0), (3, 4.5), (6, 3.0)):
        posed = scene.at_frame(frame)
        camera = posed.camera.with_size((24, 18))
        thin = render("scatter", posed, camera, replace(scene.lens, focus_distance=depth)).image
        # The focal surface of one point is even; it is float64, and the picture float32.
        np.testing.assert_allclose(load_image(tmp_path / "all" / f"{frame:05d}.npy"), thin, atol=1e-5)
    command("render", "moving.glb", "--method", "scatter", "--focus-points", "focus.toml", "-o", "still.npy", *size)
    assert (tmp_path / "still.npy").read_bytes() == (tmp_path / "all" / "00000.npy").read_bytes()
    with pytest.raises(InputError, match="frame: got -1"):
        command("pick", "moving.glb", "--pixel", "12,9", "--frame", "-1", *size)
