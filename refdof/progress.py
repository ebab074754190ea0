"""Progress: one line on stderr, where stderr is a terminal."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

__all__ = ["progress_line"]


@contextmanager
def progress_line() -> Iterator[Any]:
    """A line as long as the block lasts.

    Yields
    ------
    tell : (what, done, all) -> None
    """
    console = Console(stderr=True)
    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        line = bar.add_task("scene", total=1)

        def tell(what: str, done: int, count: int) -> None:
            bar.update(line, description=what, completed=done, total=count)

        yield tell
