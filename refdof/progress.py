"""Progress: one line on stderr, where stderr is a terminal: what is done now, and how much of all.

Elsewhere a line is written only before functions are compiled, which takes minutes.

The line comes in two parts, since what draws the second takes a second to import:

1. a word at once, while a command is imported        `say_at_once`
2. a bar with the share of the whole run and its time     `progress_line`
"""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

__all__ = ["overall", "progress_line", "say_at_once"]

_COMPILING = "compiling"
_SLOW = "refdof: compiling what was not used before; some minutes, the first time only"
_CLEAR = "\r\x1b[2K"  # go to the line's start and empty it
# What a comparison does, one after the other; a name that is not here is a method's.
_GROUPS = (_COMPILING, "reference", "methods", "scores", "artefacts", "kernels", "lens chart", "motion")


@contextmanager
def say_at_once(words: str) -> Iterator[None]:
    """Words on the terminal as long as the block lasts."""
    shown = sys.stderr.isatty()
    if shown:
        print(words, end="", file=sys.stderr, flush=True)
    try:
        yield
    finally:
        if shown:
            print(_CLEAR, end="", file=sys.stderr, flush=True)


@contextmanager
def progress_line(first: str = "scene") -> Iterator[Any]:
    """A line as long as the block lasts.

    Parameters
    ----------
    first : str
        What is done first, of unknown length.

    Yields
    ------
    tell : (what, done, all) -> None
        all 0: nobody knows.
    """
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn

    console = Console(stderr=True)
    columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        line = bar.add_task(first, total=None)
        said = console.is_terminal

        def tell(what: str, done: int, count: int) -> None:
            nonlocal said
            if not said and what.rpartition(": ")[2] == _COMPILING:
                print(_SLOW, file=sys.stderr, flush=True)
                said = True
            bar.update(line, description=what, completed=done, total=count or None)

        yield tell


def overall(
    tell: Callable[[str, int, int], None], scene: str, number: int, count: int
) -> Callable[[str, int, int], None]:
    """`tell` for what `refdof.compare.compare` tells of one scene of `count`: by name, as a share of all scenes."""
    where = f"{scene} ({number + 1} of {count})" if count > 1 else scene

    def tell_share(what: str, done: int, all_of_it: int) -> None:
        group = _GROUPS.index(what if what in _GROUPS else "methods")
        share = (group + done / max(all_of_it, 1)) / len(_GROUPS)
        tell(f"{where}: {what}", round(1000 * (number + share)), 1000 * count)

    return tell_share
