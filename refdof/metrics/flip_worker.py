"""FLIP worker: a process that compares pairs of display images, because flip-evaluator lets no other thread run.

The only file that imports flip-evaluator. As a script it imports nothing else of refdof, so it starts in a fifth of a
second. It reads a pair after the other from its standard input: height and width as int64, then both images. It
answers each with one float64 and (H, W) float32, and ends with its input.

That library ends the interpreter on some inputs, takes NaN for black and misreads integers and a fourth channel. So
only its LDR mode is used, with a fixed viewing distance, and only finite float32 (H, W, 3) in C order and [0, 1].
"""

import os
import struct
from typing import Any

import numpy as np

__all__ = ["ANSWER", "FLIP_PPD", "SIZE", "evaluate"]

FLIP_PPD = 67.0206  # pixels per degree, of the display and distance that FLIP's authors name
SIZE, ANSWER = struct.Struct("<qq"), struct.Struct("<d")


def evaluate(reference: Any, image: Any) -> tuple[float, Any]:
    """Mean FLIP error of two display images, and that of each pixel, (H, W) float32."""
    import flip_evaluator  # slow to import

    errors, mean, _ = flip_evaluator.evaluate(
        reference,
        image,
        "LDR",
        inputsRGB=True,
        applyMagma=False,
        computeMeanError=True,
        parameters={"ppd": FLIP_PPD},
    )
    return float(mean), np.ascontiguousarray(np.reshape(errors, reference.shape[:2]), dtype=np.float32)


def _answer_all() -> None:
    questions, answers = os.fdopen(0, "rb"), os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what the library may print is no answer
    while size := questions.read(SIZE.size):
        shape = (2, *SIZE.unpack(size), 3)
        pair = np.empty(shape, dtype=np.float32)  # the library takes no array that is read-only
        questions.readinto(pair.data.cast("B"))
        mean, errors = evaluate(pair[0], pair[1])
        answers.write(ANSWER.pack(mean))
        answers.write(errors.data)
        answers.flush()


if __name__ == "__main__":
    _answer_all()
