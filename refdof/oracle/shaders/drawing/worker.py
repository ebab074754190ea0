"""The process that draws: reads messages from its standard input and answers each.

{"do": "compile", "language", "text"} is answered with {"slots"}; {"do": "draw", "size", "uniforms", "filters",
"seconds"} and its textures with {} and "image"; either with {"error"} where that cannot be.
"""

import math
import os
import signal
from typing import Any

import numpy as np

from .messages import receive, send
from .slots import Given, ShaderFault

__all__ = ["answer_all"]

_GRACE_S = 5  # the other side ends a late draw; where it is gone, this does


def _drawer(language: str) -> Any:
    if language == "wgsl":
        from .wgsl import WGSL

        return WGSL()
    from .glsl import GLSL

    return GLSL()


def _answer(
    drawer: Any, message: dict[str, Any], arrays: dict[str, np.ndarray]
) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    if message["do"] == "compile":
        return {"slots": [list(slot) for slot in drawer.compile(message["text"])]}, {}
    signal.alarm(math.ceil(message["seconds"]) + _GRACE_S)
    width, height = message["size"]
    image = drawer.draw((width, height), Given(message["uniforms"], arrays, message["filters"]))
    signal.alarm(0)
    return {}, {"image": image}


def answer_all() -> None:
    """Answer until the input ends."""
    questions, answers = os.fdopen(0, "rb"), os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what a driver may print is no answer
    drawer = None
    while True:
        try:
            message, arrays = receive(questions)
        except EOFError:
            return
        try:
            if drawer is None:
                drawer = _drawer(message["language"])
            answer, images = _answer(drawer, message, arrays)
        except ShaderFault as fault:
            answer, images = {"error": " ".join(str(fault).split())}, {}
        except Exception as error:  # whatever a driver or its wrapper raises
            said = (str(error).strip() or "no reason given").splitlines()[0]
            answer, images = {"error": f"{type(error).__name__}: {said}"}, {}
        send(answers, answer, images)
