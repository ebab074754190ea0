"""The command `refdof studio`: a scene in the browser, where a click says what shall be sharp."""

import os
import sys
import webbrowser
from pathlib import Path
from typing import Annotated

import typer

from refdof._check import InputError, as_integer
from refdof.options import Limit, NoFileCamera, Threads
from refdof.shot import SceneChoice

__all__ = ["add_studio"]

_DEFAULT_SCENE = "town"


def add_studio(app: typer.Typer) -> None:
    """Give `app` the command."""
    app.command()(studio)


def studio(
    scene: Annotated[
        str, typer.Argument(metavar="[SCENE]", help="Built-in scene or mesh file.", show_default=False)
    ] = _DEFAULT_SCENE,
    port: Annotated[int, typer.Option("--port", help="Port on 127.0.0.1; 0 is a free one.")] = 0,
    no_open: Annotated[bool, typer.Option("--no-open", help="Print the page's URL only; open no browser.")] = False,
    limit: Limit = None,
    no_file_camera: NoFileCamera = None,
    threads: Threads = None,
) -> None:
    """Open a scene in the browser: click to focus.

    Files of the current folder may be opened and written, no others. Ctrl-C ends it.
    """
    port = as_integer("port", port, minimum=0, maximum=65535)
    threads = None if threads is None else as_integer("threads", threads, minimum=1)
    try:
        from refdof.studio.server import serve
    except ModuleNotFoundError as error:
        raise InputError(
            f"studio: needs {error.name}, which is not installed; allowed is refdof with its extra, refdof[studio]"
        ) from None

    def ready(url: str) -> None:
        print(url, flush=True)
        if not no_open:
            webbrowser.open(url)

    if not serve(SceneChoice(None, None, limit, no_file_camera).load(scene), scene, Path.cwd(), port, threads, ready):
        sys.stdout.flush()
        os._exit(0)  # without waiting for what compiles: all files are closed
