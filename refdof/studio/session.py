"""Session: one page's talk with Python. It takes messages, and tells pictures and answers.

The page owns the state; every message that needs one carries it. Work is done at the desk, in one thread.
"""

import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from refdof._check import InputError, as_choice, as_pair
from refdof.focus.focus_file import save_focus
from refdof.focus.focus_lens import KINDS, Focus
from refdof.focus.point import pick, placed
from refdof.image.file import save_image
from refdof.methods import METHODS
from refdof.optics.camera import Camera
from refdof.optics.systems.prescription import LENSES
from refdof.scene.builtin import SCENES
from refdof.scene.scene import Scene
from refdof.studio.command import command_of
from refdof.studio.desk import Desk
from refdof.studio.folder import Folder
from refdof.studio.pictures import Picture, Pictures
from refdof.studio.state import OVERLAYS, LensSetting, State, parse_state, point_as_json, state_as_json
from refdof.view import View

__all__ = ["Session"]

_FILM = 0.024  # m: height of a film frame, which gives a focal length to a field of view
_LARGEST_SIDE = 960  # of the first picture [px]
_MOST_ASKED = 1000  # messages of a page that wait for an answer
_PATIENCE = 1.0  # s after which a page is told why it waits
_COMPILING = "compiling what this picture needs for the first time: up to a minute"

Tell = Callable[[dict[str, Any], list[bytes]], None]
Put = Callable[[dict[str, Any]], None]


class Session:
    """A page and its scene.

    Parameters
    ----------
    desk : Desk
    folder : Folder
    scene, name : what is shown first, and how a command line calls it
    tell : callable
        Takes a message and its buffers for the page; called in any thread.
    put : callable
        Takes new values of the page's traits, "scene" and "state"; called in any thread.
    """

    def __init__(self, desk: Desk, folder: Folder, scene: Scene, name: str, tell: Tell, put: Put) -> None:
        self._desk, self._folder, self._tell, self._put = desk, folder, tell, put
        self._pictures, self._name = Pictures(scene, folder.lens), name
        self._answers = {
            "pick": self._pick,
            "save": self._save,
            "open": self._open,
            "command": self._command,
            "drop": self._drop,
        }
        self._gone, self._asked = False, 0
        self._last = self._first_state()
        self._desk.errand(self._start)

    def _start(self) -> None:
        if not self._gone:
            with self._faults_told():
                self._show(self._last)

    def close(self) -> None:
        """The page is gone: of what it asked for, only what it saves is still done."""
        self._gone = True
        self._desk.leave(self)

    def set_state(self, raw: Any) -> None:
        """The page has a new state: pictures of it."""
        number = raw.get("id") if isinstance(raw, dict) else None
        with self._faults_told(id=number if isinstance(number, int) else None):
            self._ask(parse_state(raw))

    def receive(self, content: Any, buffers: list[bytes] | None = None) -> None:
        """A message of the page; whatever is wrong with it is an answer."""
        ask = content.get("ask") if isinstance(content, dict) else None
        about = {"ask": ask if isinstance(ask, int) else None}
        with self._faults_told(**about):
            if self._asked >= _MOST_ASKED:
                raise InputError(f"message: {self._asked} wait for an answer; allowed are at most {_MOST_ASKED}")
            self._asked += 1
            self._desk.errand(self._answer(content, buffers, about))

    def _answer(self, content: Any, buffers: list[bytes] | None, about: dict[str, Any]) -> Callable[[], None]:
        def answer() -> None:
            self._asked -= 1
            if self._gone and not (isinstance(content, dict) and content.get("kind") == "save"):
                return
            with self._faults_told(**about):
                if not isinstance(content, dict):
                    raise InputError(f"message: got {type(content).__name__}; allowed is an object")
                kind = as_choice("kind", content.get("kind"), self._answers)
                self._tell({**self._answers[kind](content, buffers or []), **about}, [])

        return answer

    @contextmanager
    def _faults_told(self, **about: Any) -> Iterator[None]:
        """Tell the page of what goes wrong inside, and go on."""
        try:
            yield
        except InputError as error:
            self._tell({"kind": "error", **about, "text": " ".join(str(error).split())}, [])
        except Exception as error:
            traceback.print_exc(file=sys.stderr)
            self._tell({"kind": "error", **about, "text": f"refdof failed: {type(error).__name__}: {error}"[:500]}, [])

    def _ask(self, state: State) -> None:
        self._last = state

        def steps(newer: Callable[[], bool]) -> Iterator[None]:
            with self._faults_told(id=state.id):
                start = time.perf_counter()
                for picture in self._slow_told(self._pictures.steps(state, newer)):
                    if picture is not None:
                        self._tell_picture(state, picture, time.perf_counter() - start)
                    yield
                    start = time.perf_counter()

        self._desk.ask(self, steps)

    def _slow_told(self, pictures: Iterator[Picture | None]) -> Iterator[Picture | None]:
        """The same, and the page is told when the first takes long."""
        told = threading.Event()

        def tell() -> None:
            told.set()
            self._tell({"kind": "progress", "text": _COMPILING}, [])

        timer = threading.Timer(_PATIENCE, tell)
        timer.daemon = True
        timer.start()
        try:
            first = next(pictures, None)
        finally:
            timer.cancel()
            if told.is_set():
                self._tell({"kind": "progress", "text": ""}, [])
        yield first
        yield from pictures

    def _tell_picture(self, state: State, picture: Picture, seconds: float) -> None:
        height, width, _ = picture.levels.shape
        opaque = np.full((height, width, 4), 255, dtype=np.uint8)
        opaque[..., :3] = picture.levels
        message = {
            "kind": "picture",
            "id": state.id,
            "step": picture.step,
            "width": width,
            "height": height,
            "seconds": seconds,
            "overlay": state.overlay,
            "legend": None if picture.legend is None else picture.legend._asdict(),
            "points": self._markers(state, picture.view),
        }
        self._tell(message, [opaque.tobytes()])

    def _markers(self, state: State, view: View) -> list[dict[str, float] | None]:
        """Where the points are in the fine picture [px], and what they weigh; None where one is not to be seen."""
        scale = state.camera.width / view.camera.width, state.camera.height / view.camera.height
        marks: list[dict[str, float] | None] = []
        for point in state.points:
            try:
                found = placed([point], view, state.frame)
            except InputError:
                marks.append(None)
                continue
            x, y = (found.places[0] * scale).tolist()
            marks.append({"x": x, "y": y, "weight": float(found.weight[0]), "depth": float(found.depth[0])})
        return marks

    def _pick(self, content: dict[str, Any], _: list[bytes]) -> dict[str, Any]:
        state = parse_state(content.get("state"))
        view = self._pictures.view(state)
        place = as_pair("pixel", content.get("pixel"), minimum=0, maximum=8192)
        reply: dict[str, Any] = {"kind": "picked", "pixel": list(place), "point": None, "depth": None, "coc_px": None}
        width, height = view.camera.size
        if place[0] < width and place[1] < height and np.isfinite(view.pinhole().depth[place[1], place[0]]):
            reply["point"] = point_as_json(pick(view, place))
            reply["depth"] = float(view.pinhole().depth[place[1], place[0]])
            reply["coc_px"] = float(view.coc_px()[place[1], place[0]])
        return reply

    def _save(self, content: dict[str, Any], _: list[bytes]) -> dict[str, Any]:
        state, what = parse_state(content.get("state")), as_choice("what", content.get("what"), ("focus", "png", "exr"))
        if what == "focus":
            path = self._folder.new(content.get("name"), (".toml",))
            self._save_points(state, path)
            return {"kind": "saved", "name": self._folder.name_of(path), "command": self._command_text(state, path)}
        path = self._folder.new(content.get("name"), (f".{what}",))
        image = self._pictures.linear(state)
        points = path.with_suffix(".focus.toml")
        if state.lens.kind in KINDS:
            self._save_points(state, points)
        save_image(path, image)
        name = self._folder.name_of(path)
        try:
            command = self._command_text(state, points, name)
        except InputError:  # the picture is saved, and no command makes it
            command = None
        return {"kind": "saved", "name": name, "command": command}

    def _save_points(self, state: State, path: Path) -> None:
        save_focus(path, Focus(state.points, state.lens.kind if state.lens.kind in KINDS else "surface"))

    def _command(self, content: dict[str, Any], _: list[bytes]) -> dict[str, Any]:
        """The command; its focus file is the one that `Save focus.toml` writes with the same name."""
        points = None if content.get("name") is None else self._folder.new(content["name"], (".toml",))
        return {"kind": "command", "text": self._command_text(parse_state(content.get("state")), points)}

    def _command_text(self, state: State, points: Path | None = None, output: str = "picture.png") -> str:
        focus_file = "focus.toml" if points is None else self._folder.name_of(points)
        return command_of(self._pictures.scene, self._name, state, focus_file, output)

    def _drop(self, content: dict[str, Any], buffers: list[bytes]) -> dict[str, Any]:
        if len(buffers) != 1:
            raise InputError(f"drop: got {len(buffers)} files; allowed is one")
        return self._open({"name": self._folder.drop(content.get("name"), bytes(buffers[0]))}, [])

    def _open(self, content: dict[str, Any], _: list[bytes]) -> dict[str, Any]:
        name = content.get("name")
        found = self._folder.open(name)
        if isinstance(found, Scene):
            self._pictures, self._name = Pictures(found, self._folder.lens), str(name)
            self._show(self._first_state())
            return {"kind": "opened", "name": name, "what": "scene"}
        state = self._last
        if isinstance(found, Focus):
            state = replace(state, points=found.points, lens=replace(state.lens, kind=found.kind))
        else:
            state = replace(state, lens=replace(state.lens, kind="file", file=str(name)))
        self._put({"state": state_as_json(state)})
        return {"kind": "opened", "name": name, "what": "focus" if isinstance(found, Focus) else "lens"}

    def _first_state(self) -> State:
        """The scene's own shot."""
        camera, lens = self._pictures.scene.camera, self._pictures.scene.lens
        shrink = max(max(camera.size) / _LARGEST_SIDE, 1.0)
        camera = camera.with_size((max(round(camera.width / shrink), 1), max(round(camera.height / shrink), 1)))
        choice = LensSetting("thin", lens.radius, lens.focus_distance, _focal_length(camera), "double_gauss", None)
        return State(0, camera, choice, (), "lensblur", "none", 0.0, False)

    def _show(self, state: State) -> None:
        """Tell the page of a new scene, and what to ask for first."""
        self._last = state
        scene = self._pictures.scene
        depth = View(scene, state.camera.with_size((64, 48)), scene.lens).pinhole().depth
        seen = depth[np.isfinite(depth)]
        low, high = scene.vertices.min(axis=0), scene.vertices.max(axis=0)
        facts = {
            "name": self._name,
            "size": list(state.camera.size),
            "camera": state_as_json(state)["camera"],
            "lens": state_as_json(state)["lens"],
            "unit": "scene units",
            "diagonal": float(np.linalg.norm(high - low)),
            "depths": [float(seen.min()), float(seen.max())] if seen.size else [1.0, 100.0],
            "methods": [{"name": name, "kind": module.METHOD.kind} for name, module in METHODS.items()],
            "overlays": list(OVERLAYS),
            "scenes": list(SCENES),
            "lens_files": list(LENSES),
            "frames": None if scene.frames is None else list(scene.frames),
            "folder": self._folder.root.name,
            "files": self._folder.listing(),
        }
        self._put({"scene": facts, "state": state_as_json(state)})


def _focal_length(camera: Camera) -> float:
    """The focal length that has the camera's field of view on film [scene units, of a metre]."""
    return _FILM * camera.pixels_per_tangent / camera.height
