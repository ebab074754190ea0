"""The server: who has no token, comes from another page or asks for something else is refused, and it lives on."""

import contextlib
import http.client
import json
import subprocess
import sys
import threading

import pytest
import websockets
from websockets.sync.client import connect

from refdof import InputError
from refdof.studio import server
from refdof.studio.desk import Desk
from refdof.studio.folder import Folder
from tests.studio import flat

pytestmark = pytest.mark.fast
WAIT = 120.0  # s: the first picture compiles
TRIANGLE = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


class Running:
    """The server of a flat scene, in a thread."""

    def __init__(self, root):
        ready = threading.Event()

        def tell(url):
            self.url = url
            ready.set()

        work = lambda: server.serve(flat.scene(), "flat", root, 0, None, tell)  # noqa: E731
        threading.Thread(target=work, daemon=True).start()
        assert ready.wait(WAIT)
        self.base, self.token = self.url.split("/?token=")
        self.port = int(self.base.rsplit(":", 1)[1])

    def request(self, path, method="GET", body=None, token=None, chunked=False, **headers):
        wire = http.client.HTTPConnection("127.0.0.1", self.port, timeout=WAIT)
        joint = "&" if "?" in path else "?"
        headers = {name.replace("_", "-"): value for name, value in headers.items()}
        with contextlib.closing(wire):
            wire.request(
                method,
                f"{path}{joint}token={self.token if token is None else token}",
                body,
                headers,
                encode_chunked=chunked,
            )
            answer = wire.getresponse()
            return answer.status, answer.read(), dict(answer.getheaders())

    def socket(self, origin="own", token=None, **words):
        token = self.token if token is None else token
        origin = self.base if origin == "own" else origin
        return connect(f"ws://127.0.0.1:{self.port}/socket?token={token}", origin=origin, max_size=None, **words)


@pytest.fixture(scope="module")
def running(tmp_path_factory):
    return Running(tmp_path_factory.mktemp("root"))


def received(socket, **wanted):
    """The next message with these values, and its buffers."""
    while True:
        frame = json.loads(socket.recv(timeout=WAIT))
        buffers = [socket.recv(timeout=WAIT) for _ in range(frame.get("buffers", 0))]
        message = frame.get("message", frame)
        if all(message.get(key) == value for key, value in wanted.items()):
            return message, buffers


def opened(socket):
    """What the server says first: the session's name, then scene and state."""
    session = json.loads(socket.recv(timeout=WAIT))["session"]
    return session, json.loads(socket.recv(timeout=WAIT))["set"]


def alive(running):
    """A picture, over a new socket."""
    with running.socket() as socket:
        opened(socket)
        socket.send(json.dumps({"set": {"state": flat.state(5)}}))
        message, (raw,) = received(socket, kind="picture", step="fine", id=5)
    return len(raw) == 4 * flat.WIDTH * flat.HEIGHT == 4 * message["width"] * message["height"]


def test_the_page_is_served_and_may_fetch_from_here_only(running):
    for path, kind in (("/", "text/html"), ("/studio.js", "text/javascript"), ("/studio.css", "text/css")):
        status, _, headers = running.request(path)
        assert status == 200
        assert headers["content-type"].startswith(kind)
        assert "default-src 'none'" in headers["content-security-policy"]
        assert headers["cache-control"] == "no-store"
    assert alive(running)


@pytest.mark.parametrize("token", ["", "wrong", "%C3%A4", "a" * 5000])
def test_a_wrong_token_is_refused(running, token):
    assert running.request("/", token=token)[0] == 403
    assert running.request("/drop", "POST", TRIANGLE, token=token)[0] == 403
    with pytest.raises(websockets.InvalidStatus) as caught, running.socket(token=token):
        pass
    assert caught.value.response.status_code == 403


@pytest.mark.parametrize("origin", ["http://example.com", "null", "http://127.0.0.1:1", "https://127.0.0.1", None])
def test_a_foreign_origin_is_refused(running, origin):
    if origin is not None:  # plain files are asked for without one
        assert running.request("/", Origin=origin)[0] == 403
    with pytest.raises(websockets.InvalidStatus), running.socket(origin=origin):
        pass
    assert alive(running)


def test_another_name_of_the_machine_is_refused(running):
    assert running.request("/", Host="example.com")[0] == 403  # a name that leads here
    assert running.request("/", Host=f"localhost:{running.port}")[0] == 200


def test_other_paths_are_none_of_the_servers(running):
    for path in ("/../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/page/view.js", "//etc/passwd", "/session.py"):
        assert running.request(path)[0] == 404
    assert running.request("/", "POST", b"")[0] == 405


def test_large_files_are_refused_before_they_are_read(running):
    with running.socket() as socket:
        session, _ = opened(socket)
        wire = http.client.HTTPConnection("127.0.0.1", running.port, timeout=WAIT)
        with contextlib.closing(wire):
            wire.putrequest("POST", f"/drop?token={running.token}&session={session}&name=a.obj")
            wire.putheader("Content-Length", str(1 << 30))
            wire.endheaders()
            answer = wire.getresponse()
            assert answer.status == 413
            answer.read()
    assert alive(running)


def test_long_bodies_without_a_length_are_cut_off(running, monkeypatch):
    monkeypatch.setattr(server, "MOST_DROPPED", 1000)
    with running.socket() as socket:
        session, _ = opened(socket)
        parts = iter([b"x" * 600] * 3)
        path = f"/drop?session={session}&name=a.obj"
        assert running.request(path, "POST", parts, chunked=True, Transfer_Encoding="chunked")[0] == 413
    assert alive(running)


def test_a_dropped_mesh_is_opened(running):
    with running.socket() as socket:
        session, _ = opened(socket)
        assert running.request("/drop?session=none&name=a.obj", "POST", TRIANGLE)[0] == 404
        assert running.request(f"/drop?session={session}&name=a.obj&ask=3", "POST", TRIANGLE)[0] == 204
        assert received(socket, kind="opened", ask=3)[0]["name"] == "a.obj"
        assert running.request(f"/drop?session={session}&name=..%2Fb.obj&ask=4", "POST", TRIANGLE)[0] == 204
        assert "name" in received(socket, kind="error", ask=4)[0]["text"]
        assert running.request(f"/drop?session={session}&name=c.obj&ask=5", "POST", b"no mesh \xff")[0] == 204
        assert received(socket, kind="error", ask=5)[0]["text"]


@pytest.mark.parametrize(
    "frame",
    [
        "",
        "no json",
        "[" * 100000,
        "3",
        "null",
        '{"set": 3}',
        '{"set": {"state": NaN}}',
        '{"message": [1]}',
        b"\0\1",
        "{}",
    ],
    ids=range(10),
)
def test_malformed_messages_are_answered(running, frame):
    with running.socket() as socket:
        opened(socket)
        socket.send(frame)
        assert received(socket, kind="error")[0]["text"]
        socket.send(json.dumps({"set": {"state": flat.state(6)}}))
        received(socket, kind="picture", id=6)


def test_an_oversized_message_ends_its_socket_only(running):
    with running.socket() as socket:
        opened(socket)
        socket.send("x" * (2 << 20))
        with pytest.raises(websockets.ConnectionClosed):
            received(socket, kind="none")
    assert alive(running)


def test_a_page_that_vanishes_ends_nothing(running):
    with running.socket() as socket:
        opened(socket)
        socket.send(json.dumps({"set": {"state": flat.state(7, size=[640, 480])}}))
        socket.socket.shutdown(2)
    assert alive(running)


def test_there_is_an_end_to_pages(running):
    with contextlib.ExitStack() as stack:
        with contextlib.suppress(websockets.InvalidStatus):  # those of tests before may not have left yet
            for _ in range(server._MOST_PAGES):
                stack.enter_context(running.socket())
        with pytest.raises(websockets.InvalidStatus), running.socket():
            pass
    for _ in range(100):  # they leave one after the other
        with contextlib.suppress(websockets.InvalidStatus):
            assert alive(running)
            return
    raise AssertionError("no page may come any more")


def test_a_port_that_is_taken_is_said(running, tmp_path):
    with pytest.raises(InputError, match=f"port: got {running.port}"):
        server.serve(flat.scene(), "flat", tmp_path, running.port, None, print)


def test_the_command_prints_its_url_and_ends_at_ctrl_c(tmp_path):
    command = [sys.executable, "-m", "refdof.cli", "studio", "cans", "--no-open"]
    with subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as child:
        try:
            url = child.stdout.readline()
            assert url.startswith("http://127.0.0.1:")
            for _ in range(60):  # where signals are ignored, as in the background of a shell, until the server listens
                child.send_signal(2)
                with contextlib.suppress(subprocess.TimeoutExpired):
                    out, errors = child.communicate(timeout=2.0)
                    break
        finally:
            child.kill()
    assert (out, errors) == ("", "")
    assert child.returncode in (0, 130)


def test_bad_words_are_one_line(tmp_path):
    for words, said in ((["nowhere"], "scene: got 'nowhere'"), (["--port", "70000"], "port: got 70000")):
        command = [sys.executable, "-m", "refdof.cli", "studio", "--no-open", *words]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=WAIT)
        assert done.returncode == 2
        assert said in done.stderr
        assert done.stderr.count("\n") == 1


def test_a_folder_is_not_a_desk(tmp_path):
    """Routes are made without serving."""
    desk = Desk(print)
    app = server.application(desk, Folder(tmp_path), flat.scene(), "flat", "token", 1)
    assert {route.path for route in app.routes} == {"/", "/studio.css", "/studio.js", "/page.js", "/drop", "/socket"}
    desk.close()
