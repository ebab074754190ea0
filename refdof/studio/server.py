"""Server: the studio's page on this machine only, for whoever has the token of its URL.

A page of another site can send requests here, too. So every request needs the token, a Host that is this machine's, and
no Origin but our own; scripts, styles and connections of the page are limited to this server.
"""

import asyncio
import contextlib
import json
import os
import secrets
import signal
import socket
import sys
import tempfile
import threading
import traceback
from collections.abc import AsyncIterator, Callable, Iterator
from pathlib import Path
from typing import Any

import uvicorn
from starlette.applications import Starlette
from starlette.requests import HTTPConnection, Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket, WebSocketDisconnect

from refdof._check import InputError
from refdof.scene.scene import Scene
from refdof.studio.desk import Desk
from refdof.studio.folder import Folder
from refdof.studio.page import page_file, view_module
from refdof.studio.session import Session

__all__ = ["application", "serve"]

MOST_DROPPED = 256 << 20  # bytes of a file
_MOST_MESSAGE = 1 << 20  # bytes of a message
_MOST_WAITING = 16  # messages for a page that does not take them: then older pictures are left out
_MOST_PAGES = 16
_HEADERS = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
}
_TYPES = {".html": "text/html", ".css": "text/css", ".js": "text/javascript"}


def serve(scene: Scene, name: str, root: Path, port: int, threads: int | None, ready: Callable[[str], None]) -> bool:
    """Serve until Ctrl-C. True if nothing works on: what compiles cannot be stopped.

    Parameters
    ----------
    scene, name
        Shown first, and how a command line calls it.
    root : Path
        The folder whose files may be opened and written.
    port : int
        0 is a free one.
    threads : int or None
        That render; None: as many as there are.
    ready : callable
        Called with the page's URL.

    Raises
    ------
    InputError
        If the port is taken.
    """
    listening = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind(("127.0.0.1", port))
    except OSError as error:
        listening.close()
        raise InputError(f"port: got {port}: {error.strerror}; allowed is a free port, or 0 for any") from None
    port, token = listening.getsockname()[1], secrets.token_urlsafe(24)
    with tempfile.TemporaryDirectory(prefix="refdof-studio-") as dropped:
        desk = Desk(_report, threads)
        app = application(desk, Folder(root, Path(dropped)), scene, name, token, port)
        config = uvicorn.Config(
            app,
            log_level="error",
            access_log=False,
            lifespan="off",
            ws="websockets-sansio",
            ws_max_size=_MOST_MESSAGE,
            timeout_graceful_shutdown=1,
            server_header=False,
        )
        try:
            with contextlib.suppress(KeyboardInterrupt):
                _Server(config, lambda: ready(f"http://127.0.0.1:{port}/?token={token}")).run(sockets=[listening])
        finally:
            with _deaf():
                ended = desk.close()
                listening.close()
    return ended


class _Server(uvicorn.Server):
    """Tells when it has started, and hears Ctrl-C."""

    def __init__(self, config: uvicorn.Config, started: Callable[[], None]) -> None:
        super().__init__(config)
        self._told = started

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """As uvicorn's; signals are its own by now."""
        await super().startup(sockets)
        self._told()


@contextlib.contextmanager
def _deaf() -> Iterator[None]:
    """Whoever presses Ctrl-C twice has been heard."""
    if threading.current_thread() is not threading.main_thread():  # no signals come here
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def application(desk: Desk, folder: Folder, scene: Scene, name: str, token: str, port: int) -> Starlette:
    """The server's routes, for requests to this port with this token."""
    sessions: dict[str, Session] = {}

    def refused(connection: HTTPConnection) -> str | None:
        """Why a request is refused, if it is."""
        hosts = [f"{host}:{port}" for host in ("127.0.0.1", "localhost")]
        if connection.headers.get("host") not in hosts:
            return "this server answers to 127.0.0.1 only"
        origin = connection.headers.get("origin")
        if origin is not None and origin not in [f"http://{host}" for host in hosts]:
            return "requests of other pages are refused"
        given = connection.query_params.get("token", "")
        if not secrets.compare_digest(given.encode(), token.encode()):
            return "the token is missing or wrong: use the URL that `refdof studio` printed"
        return None

    def file(request: Request) -> Response:
        if (reason := refused(request)) is not None:
            return PlainTextResponse(reason, 403, _HEADERS)
        path = request.url.path.lstrip("/") or "index.html"
        text = view_module() if path == "studio.js" else page_file(path)
        if path == "index.html":
            text = text.replace("{{token}}", token)
        return Response(text, 200, _HEADERS, _TYPES[os.path.splitext(path)[1]])

    async def drop(request: Request) -> Response:
        if (reason := refused(request)) is not None:
            return PlainTextResponse(reason, 403, _HEADERS)
        session = sessions.get(request.query_params.get("session", ""))
        if session is None:
            return PlainTextResponse("session: there is no such page", 404, _HEADERS)
        content = await _body(request)
        if content is None:
            return PlainTextResponse(f"a file may have at most {MOST_DROPPED >> 20} MiB", 413, _HEADERS)
        ask = request.query_params.get("ask", "")
        about = {
            "kind": "drop",
            "name": request.query_params.get("name", ""),
            "ask": int(ask) if ask.isdecimal() else None,
        }
        session.receive(about, [content])
        return Response(None, 204, _HEADERS)

    async def talk(socket: WebSocket) -> None:
        if refused(socket) is not None or "origin" not in socket.headers or len(sessions) >= _MOST_PAGES:
            await socket.close(4403)  # before it is accepted: an answer 403
            return
        await socket.accept()
        loop, waiting = asyncio.get_running_loop(), _Waiting()
        number = secrets.token_urlsafe(9)

        def send(message: dict[str, Any], buffers: list[bytes]) -> None:
            with contextlib.suppress(RuntimeError):  # the loop is closed
                loop.call_soon_threadsafe(waiting.put, message, buffers)

        def tell(message: dict[str, Any], buffers: list[bytes]) -> None:
            send({"message": message, "buffers": len(buffers)}, buffers)

        session = Session(desk, folder, scene, name, tell, lambda traits: send({"set": traits}, []))
        sessions[number] = session
        writer = asyncio.create_task(_write(socket, waiting))
        try:
            await socket.send_text(json.dumps({"session": number}))
            async for text in _texts(socket):
                _receive(session, text)
        finally:
            writer.cancel()
            del sessions[number]
            session.close()

    pages = [Route(f"/{path}", file) for path in ("", "studio.css", "studio.js", "page.js")]
    return Starlette(routes=[*pages, Route("/drop", drop, methods=["POST"]), WebSocketRoute("/socket", talk)])


class _Waiting:
    """Messages for a page; of pictures that wait, the newest are kept."""

    def __init__(self) -> None:
        self._messages: list[tuple[dict[str, Any], list[bytes]]] = []
        self._some = asyncio.Event()

    def put(self, message: dict[str, Any], buffers: list[bytes]) -> None:
        self._messages.append((message, buffers))
        if len(self._messages) > _MOST_WAITING:
            pictures = [k for k, (_, parts) in enumerate(self._messages) if parts]
            del self._messages[pictures[0] if pictures else 0]
        self._some.set()

    async def get(self) -> tuple[dict[str, Any], list[bytes]]:
        while not self._messages:
            self._some.clear()
            await self._some.wait()
        return self._messages.pop(0)


async def _write(socket: WebSocket, waiting: _Waiting) -> None:
    with contextlib.suppress(WebSocketDisconnect, RuntimeError):  # the page is gone: its reader ends, too
        while True:
            message, buffers = await waiting.get()
            await socket.send_text(json.dumps(message))
            for part in buffers:
                await socket.send_bytes(part)


async def _texts(socket: WebSocket) -> AsyncIterator[str]:
    with contextlib.suppress(WebSocketDisconnect):
        while True:
            message = await socket.receive()
            if message["type"] == "websocket.disconnect":
                return
            yield message.get("text") or ""


def _receive(session: Session, text: str) -> None:
    """A frame of a page."""
    try:
        frame = json.loads(text)
    except (ValueError, RecursionError):
        frame = None
    if isinstance(frame, dict) and isinstance(frame.get("set"), dict) and "state" in frame["set"]:
        session.set_state(frame["set"]["state"])
    else:
        session.receive(frame.get("message") if isinstance(frame, dict) else None)


async def _body(request: Request) -> bytes | None:
    """The body of a request; None if it is too long, which its header may say before it is read."""
    said = request.headers.get("content-length", "0")
    if not said.isdecimal() or int(said) > MOST_DROPPED:
        return None
    parts, size = [], 0
    async for part in request.stream():
        parts.append(part)
        size += len(part)
        if size > MOST_DROPPED:
            return None
    return b"".join(parts)


def _report(error: BaseException) -> None:
    traceback.print_exception(error, file=sys.stderr)
