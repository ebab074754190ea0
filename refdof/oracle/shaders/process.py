"""The process that draws, seen from outside: a shader that never ends, or a driver that crashes, ends it alone."""

import os
import signal
import subprocess
import sys
import weakref
from collections.abc import Mapping
from contextlib import suppress
from threading import Timer
from typing import Any

from refdof._check import Float
from refdof.oracle.shaders import drawing
from refdof.oracle.shaders.drawing.messages import receive, send

__all__ = ["Ended", "Process"]

_MESA = {"EGL_PLATFORM": "surfaceless", "LIBGL_ALWAYS_SOFTWARE": "1", "GALLIUM_DRIVER": "llvmpipe"}

_RUN = """
import importlib.util, sys
spec = importlib.util.spec_from_file_location("drawing", sys.argv[1])
sys.modules["drawing"] = package = importlib.util.module_from_spec(spec)
spec.loader.exec_module(package)
from drawing.worker import answer_all
answer_all()
"""


class Ended(Exception):
    """The process ended before it answered: one line that says why."""


class Process:
    """A process that runs `drawing.worker` without the rest of refdof; it ends with this object, or its input."""

    def __init__(self) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-c", _RUN, str(drawing.__file__)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            start_new_session=True,  # an interrupt ends this process, which then ends that one
            env={**os.environ, **_MESA},
        )
        self.stop = weakref.finalize(self, _stop, self._process)

    def ask(
        self, message: Mapping[str, Any], seconds: float, arrays: Mapping[str, Float] | None = None
    ) -> tuple[dict[str, Any], dict[str, Float]]:
        """Send a message and wait for its answer, which is a message, too.

        Raises
        ------
        Ended
            If the process ends instead, or is ended after `seconds`.
        """
        questions, answers = self._process.stdin, self._process.stdout
        assert questions is not None
        assert answers is not None
        timer = Timer(seconds, self._process.kill)
        timer.start()
        try:
            send(questions, message, arrays)
            return receive(answers)
        except (OSError, EOFError, ValueError):
            late = not timer.is_alive()
            self._process.kill()
            status = self._process.wait()
            if late:
                raise Ended(f"the shader ran for more than {seconds:g} s and was ended") from None
            raise Ended(f"the driver ended the process with {_words(status)}") from None
        finally:
            timer.cancel()


def _words(status: int) -> str:
    with suppress(ValueError):
        return f"signal {signal.Signals(-status).name}"
    return f"status {status}"


def _stop(process: subprocess.Popen[bytes]) -> None:
    process.kill()
    with suppress(OSError), process:  # closes the pipes, which may hold what was never read
        pass
