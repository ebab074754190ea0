"""A session: messages in, pictures and answers out; what they say is checked on a scene whose numbers are known."""

import queue
import shlex
import threading

import numpy as np
import pytest
from typer.testing import CliRunner

import refdof.cli
from refdof.focus.focus_file import load_focus
from refdof.image.file import load_image
from refdof.studio.folder import Folder
from refdof.studio.session import Session
from tests.studio import flat
from tests.studio.page import WAIT, Page

pytestmark = pytest.mark.fast


def test_a_page_is_told_the_scene_and_a_first_state(page):
    scene, state = page.first["scene"], page.first["state"]
    assert scene["size"] == [flat.WIDTH, flat.HEIGHT]
    np.testing.assert_allclose(scene["depths"], [flat.NEAR, flat.FAR], rtol=1e-6)  # depths of layers are float32
    # 24 mm of film over twice the tangent of half the field of view, 48 px over 2 x 50 px.
    assert state["lens"]["focal_length"] == pytest.approx(0.024 * 50.0 / 48.0)
    message, levels = page.picture({**state, "id": 1, "method": "scatter"})
    assert levels.shape == (flat.HEIGHT, flat.WIDTH, 3)
    assert message["legend"] is None


def test_while_something_moves_there_is_a_coarse_picture_only(page):
    state = flat.state(1, moving=True, size=[640, 480])
    _, levels = page.picture(state, "coarse")
    assert levels.shape == (120, 160, 3)
    page.session.set_state(flat.state(2, size=[64, 48]))
    assert [page.message(kind="picture")[0]["id"] for _ in range(2)] == [2, 2]  # no fine one of state 1 before


def test_picks_and_markers_are_where_the_scene_is(page):
    state = flat.state(1)
    for x, depth in ((3, flat.NEAR), (60, flat.FAR)):
        found = page.call(kind="pick", pixel=[x, 20], state=state)
        assert found["depth"] == pytest.approx(depth, rel=1e-6)
        # c = P E (1 / focus - 1 / depth)
        assert found["coc_px"] == pytest.approx(flat.SCALE * 0.1 * (1 / flat.NEAR - 1 / depth), abs=1e-6)
        state["points"].append(found["point"])
    message, _ = page.picture({**state, "id": 2, "lens": {**state["lens"], "kind": "surface"}})
    for mark, x in zip(message["points"], (3, 60), strict=True):
        assert (mark["x"], mark["y"]) == (pytest.approx(x + 0.5, abs=1e-6), pytest.approx(20.5, abs=1e-6))
    outside = {**state["points"][0], "triangle": 3, "barycentrics": [1, 0, 0]}  # a corner far outside of the picture
    message, _ = page.picture({**state, "id": 3, "points": [outside]})
    assert message["points"] == [None]
    background = page.call(kind="pick", pixel=[200, 20], state={**state, "points": []})
    assert background["point"] is None


def test_a_focal_surface_is_sharp_at_both_cards(page):
    state = flat.state(1)
    state["points"] = [page.call(kind="pick", pixel=[x, 20], state=state)["point"] for x in (3, 60)]
    surface = {**state, "id": 2, "lens": {**state["lens"], "kind": "surface"}}
    message, _ = page.picture({**surface, "overlay": "coc"})
    assert message["legend"]["unit"] == "px"
    view = page.session._pictures.view(page.session._last)
    coc = view.coc_px()
    assert abs(coc[20, 3]) < 1e-3  # the surface passes through the points, half a pixel away at most
    assert abs(coc[20, 60]) < 1e-3


def test_overlays_show_what_is_known(page):
    for number, overlay in enumerate(("coc", "depth", "layers", "focus"), 1):
        message, levels = page.picture(flat.state(number, overlay=overlay))
        left, right = levels[24, 10].astype(int), levels[24, 50].astype(int)
        legend = message["legend"]
        if overlay == "coc":  # in focus: white; 1.875 px behind it, which is the largest: red
            assert legend["high"] == pytest.approx(flat.SCALE * 0.1 * (1 / flat.NEAR - 1 / flat.FAR), rel=1e-6)
            assert left.tolist() == [255, 255, 255]
            assert right[0] > right[2] + 50
        if overlay == "depth":
            assert (legend["low"], legend["high"]) == (pytest.approx(flat.NEAR), pytest.approx(flat.FAR))
            assert left.tolist() == [255, 255, 255]
            assert right.tolist() == [26, 26, 26]  # 0.1
        if overlay == "layers":  # two surfaces on the left, one on the right
            assert left.sum() > right.sum() > 0
        if overlay == "focus":  # orange where it is in focus
            assert left[0] > left[2] + 100
            assert right[2] > right[0]


def test_the_command_makes_the_saved_picture_once_more(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    page = Page(tmp_path, refdof.load_scene("cans"), "cans")
    state = {**page.first["state"], "id": 1, "size": [48, 36], "method": "scatter"}
    state["camera"]["eye"][0] += 0.25
    state["lens"] |= {"kind": "thin", "radius": 0.2, "focus": 5.5}
    pointed = {**state, "lens": {**state["lens"], "kind": "surface"}}
    picked = page.call(kind="pick", pixel=[24, 20], state=state)["point"]
    real = {**state, "lens": {**state["lens"], "kind": "file", "f_number": 4.0}}
    wanted = [(state, "thin.exr"), ({**pointed, "points": [picked]}, "points.exr"), (real, "real.exr")]
    for number, (one, name) in enumerate(wanted):
        saved = page.call(kind="save", what="exr", name=name, state=one)
        assert saved["name"] == name
        words = shlex.split(saved["command"])[1:]
        assert CliRunner().invoke(refdof.cli.app, [*words[:-1], f"{number}.exr"], catch_exceptions=False).exit_code == 0
        np.testing.assert_array_equal(load_image(tmp_path / f"{number}.exr"), load_image(tmp_path / name))
        assert page.call(kind="command", state=one)["text"].startswith("refdof render cans --method scatter")
    assert load_focus(tmp_path / "points.focus.toml").points[0].triangle == picked["triangle"]
    page.desk.close()


def test_a_copied_command_reads_what_the_same_name_saves(page):
    state = flat.state(1)
    state["points"] = [page.call(kind="pick", pixel=[3, 20], state=state)["point"]]
    state = {**state, "lens": {**state["lens"], "kind": "surface"}}
    assert " --focus-points mine.toml " in page.call(kind="command", name="mine.toml", state=state)["text"]
    assert page.call(kind="save", what="focus", name="mine.toml", state=state)["name"] == "mine.toml"


def test_the_frame_of_a_still_scene_is_left_out_of_its_command(page, tmp_path):
    later = flat.state(1, frame=18)  # nothing moves: every frame is the same picture
    assert page.call(kind="command", state=later)["text"] == page.call(kind="command", state=flat.state(1))["text"]
    assert page.call(kind="save", what="png", name="a.png", state=later)["command"].startswith("refdof render ")


def test_markers_are_where_a_lens_file_shows_them(page):
    state = flat.state(1)
    point = page.call(kind="pick", pixel=[29, 21], state=state)["point"]
    through = {**state, "id": 2, "points": [point], "lens": {**state["lens"], "kind": "file"}}
    (mark,) = page.picture(through)[0]["points"]
    # The field of view is that of 24 mm of film behind the lens: all moves away from the middle by one factor.
    across, down = (mark["x"] - 32.0) / (29.5 - 32.0), (mark["y"] - 24.0) / (21.5 - 24.0)
    assert across == pytest.approx(down, rel=1e-6)
    assert abs(across - 1.0) > 0.1
    again = page.call(kind="pick", pixel=[int(mark["x"]), int(mark["y"])], state=through)["point"]
    assert again["triangle"] == point["triangle"]
    np.testing.assert_allclose(again["barycentrics"], point["barycentrics"], atol=0.02)  # half a pixel of the card


def test_focus_files_are_saved_and_opened(page, tmp_path):
    state = flat.state(1, lens_kind="plane")
    state["points"] = [
        page.call(kind="pick", pixel=[x, 20], state=state | {"lens": flat.state()["lens"]})["point"] for x in (3, 60)
    ]
    assert page.call(kind="save", what="focus", name="a.toml", state=state)["name"] == "a.toml"
    assert load_focus(tmp_path / "a.toml").kind == "plane"
    page.picture(flat.state(2))
    while not page.put.empty():
        page.put.get()
    assert page.call(kind="open", name="a.toml")["what"] == "focus"
    given = page.put.get(timeout=WAIT)["state"]
    assert given["lens"]["kind"] == "plane"
    assert [point["triangle"] for point in given["points"]] == [point["triangle"] for point in state["points"]]
    assert page.call(kind="open", name="cooke_triplet")["what"] == "lens"
    assert page.put.get(timeout=WAIT)["state"]["lens"] | {"radius": 0, "focus": 0} == given["lens"] | {
        "kind": "file",
        "file": "cooke_triplet",
        "radius": 0,
        "focus": 0,
    }


def test_a_mesh_of_the_folder_is_opened(page, tmp_path):
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    assert page.call(kind="open", name="a.obj")["what"] == "scene"
    traits = page.put.get(timeout=WAIT)
    assert traits["scene"]["name"] == "a.obj"
    state = {**traits["state"], "id": 9, "size": [32, 24], "method": "scatter"}
    _, levels = page.picture(state)
    assert levels.max() > 0


def test_whatever_is_wrong_with_a_message_is_an_answer(page):
    assert "kind: got 'nix'" in page.error(kind="nix")
    assert "kind" in page.error(kind=["pick"])
    assert "state" in page.error(kind="pick", pixel=[1, 2])
    assert "pixel" in page.error(kind="pick", pixel="here", state=flat.state())
    assert "pixel" in page.error(kind="pick", pixel=[-1, 0], state=flat.state())
    assert "what" in page.error(kind="save", what="exe", name="a.exe", state=flat.state())
    assert "name" in page.error(kind="save", what="png", name="../a.png", state=flat.state())
    assert "points" in page.error(kind="save", what="focus", name="a.toml", state=flat.state())
    assert "name" in page.error(kind="open", name="../a.toml")
    assert "drop" in page.error(kind="drop", name="a.obj")
    for raw in (None, 3, "text", [], {"kind": "pick", "ask": "x"}):
        page.session.receive(raw)
        assert page.message(kind="error")[0]["text"]
    for raw in (None, 3, {"id": 4}, flat.state(lens_kind="surface")):  # no points
        page.session.set_state(raw)
        assert page.message(kind="error")[0]["text"]
    page.picture(flat.state(5))


def test_of_two_pages_each_has_its_own(page, tmp_path):
    told = queue.Queue()
    other = Session(page.desk, Folder(tmp_path), flat.scene(), "flat", lambda *given: told.put(given), lambda _: None)
    other.set_state(flat.state(1, overlay="depth"))
    page.session.set_state(flat.state(1))
    mine, _ = page.message(kind="picture", step="fine")
    theirs = next(message for message, _ in iter(lambda: told.get(timeout=WAIT), None) if message.get("step") == "fine")
    assert [(one["id"], one["overlay"]) for one in (mine, theirs)] == [(1, "none"), (1, "depth")]
    other.close()
    assert page.picture(flat.state(2))[0]["id"] == 2
    assert told.empty()


def test_of_a_page_that_is_gone_only_what_it_saves_is_done(page, tmp_path):
    told, put, free = queue.Queue(), queue.Queue(), threading.Event()
    page.desk.errand(lambda: free.wait(WAIT))
    other = Session(page.desk, Folder(tmp_path), flat.scene(), "flat", lambda *given: told.put(given), put.put)
    other.receive({"kind": "command", "ask": 1, "state": flat.state()})
    other.receive({"kind": "save", "ask": 2, "what": "png", "name": "last.png", "state": flat.state()})
    other.close()
    free.set()
    assert told.get(timeout=WAIT)[0]["ask"] == 2
    assert (tmp_path / "last.png").is_file()
    assert told.empty()
    assert put.empty()


def test_there_is_an_end_to_messages_that_wait(page):
    free = threading.Event()
    page.desk.errand(lambda: free.wait(WAIT))
    for ask in range(1001):
        page.session.receive({"kind": "nix", "ask": ask})
    assert "message: 1000 wait" in page.message(kind="error", ask=1000)[0]["text"]
    free.set()
    page.message(kind="error", ask=999)
    page.picture(flat.state(1))


def test_a_number_that_json_lacks_is_not_sent_back(page):
    page.session.set_state(flat.state(float("nan")))
    assert page.message(kind="error")[0]["id"] is None
