"""Commands: the command line that makes one picture of a comparison, from the one that made all."""

import shlex
from collections.abc import Sequence

from refdof.comparison import Row

__all__ = ["FLAGS", "picture_command"]

FLAGS = (
    "--no-file-camera",
    "--no-vignetting",
    "--wide",
    "--json",
)  # options of `refdof compare | filter` without value
_REPLACED = ("--methods", "--preset", "--set", "--out", "--wide", "--json")
_COMMANDS = ("compare", "filter")


def picture_command(command: str, row: Row, position: int = 0) -> str:
    """The same command for one scene and one method, into a folder of its own; empty if it is none of refdof's.

    Parameters
    ----------
    command : str
        A `refdof compare` or `refdof filter` line.
    row : Row
    position : int
        Which of several scenes.
    """
    words = shlex.split(command)
    if len(words) < 2 or words[0] != "refdof" or words[1] not in _COMMANDS:
        return ""
    scenes, options = _parsed(words[2:])
    kept = words[:2] + (scenes[position : position + 1] if len(scenes) > 1 else scenes)
    out = "out"
    for words_of_one in options:
        name, _, value = "=".join(words_of_one).partition("=")
        if name == "--out":
            out = value
        if name not in _REPLACED or (name == "--set" and value.partition(".")[0] == row.method):
            kept += words_of_one
    kept += ["--methods", row.method, *(["--preset", row.preset] if row.preset != "best" else [])]
    file_name = "".join(letter if letter.isalnum() else "-" for letter in row.name).strip("-")
    return shlex.join([*kept, "--out", f"{out}-{file_name}"])


def _parsed(words: Sequence[str]) -> tuple[list[str], list[list[str]]]:
    """Arguments; and options, each with its value."""
    arguments, options = [], []
    rest = iter(words)
    for word in rest:
        if not word.startswith("-") or word == "-":
            arguments.append(word)
        elif "=" in word or word in FLAGS:
            options.append([word])
        else:
            options.append([word, *[value for value in (next(rest, None),) if value is not None]])
    return arguments, options
