"""The process that draws: reads messages from its standard input and answers each.

{"do": "compile", "language", "text"} is answered with {"slots"}; {"do": "draw", "size", "uniforms", "filters",
"seconds"} and its textures with {} and "image"; either with {"error"} where that cannot be.
"""

import math
import os
import signal
from typing import Any

from refdof._check import Float
from refdof.oracle.shaders.messages import receive, send
from refdof.oracle.shaders.slots import ShaderFault

__all__: list[str] = []

_GRACE_S = 5  # the other side ends a late draw; where it is gone, this does


def _drawer(language: str) -> Any:
    if language == "wgsl":
        from refdof.oracle.shaders.wgsl import WGSL

        return WGSL()
    from refdof.oracle.shaders.glsl import GLSL

    return GLSL()


def _answer(drawer: Any, message: dict[str, Any], arrays: dict[str, Float]) -> tuple[dict[str, Any], dict[str, Float]]:
    if message["do"] == "compile":
        return {"slots": [list(slot) for slot in drawer.compile(message["text"])]}, {}
    signal.alarm(math.ceil(message["seconds"]) + _GRACE_S)
    width, height = message["size"]
    image = drawer.draw((width, height), message["uniforms"], arrays, message["filters"])
    signal.alarm(0)
    return {}, {"image": image}


def _answer_all() -> None:
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
            answer, images = {"error": str(fault)}, {}
        except Exception as error:  # whatever a driver or its wrapper raises
            said = (str(error).strip() or "no reason given").splitlines()[0]
            answer, images = {"error": f"{type(error).__name__}: {said}"}, {}
        send(answers, answer, images)


if __name__ == "__main__":
    _answer_all()
