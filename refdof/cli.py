"""The command line `refdof`: what it is called with finds its command, and only that is imported.

stdout carries the result only; progress and errors go to stderr. Exit status: 0 done, 2 bad input, with one line that
names the argument, what it got and what is allowed.
"""

import errno
import gc
import os
import re
import sys
import warnings
from typing import Annotated, Any

import typer

import refdof
from refdof._check import InputError
from refdof._process import INTERRUPTED, hear_no_more
from refdof.command_group import Commands

__all__ = ["app", "main"]

_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EIO)
_UsageError: Any = typer.BadParameter.__bases__[0]  # wrong words on the command line, whichever click typer brings

app = typer.Typer(
    name="refdof",
    cls=Commands,
    add_completion=False,
    rich_markup_mode=None,  # brackets, as of units, stay; and rich is slow to import
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _version(wanted: bool) -> None:
    if wanted:
        print(f"refdof {refdof.__version__}")
        raise typer.Exit


@app.callback(invoke_without_command=True)
def _refdof(
    context: typer.Context,
    version: Annotated[
        bool, typer.Option("--version", help="Print the version.", callback=_version, is_eager=True)
    ] = False,
) -> None:
    """Reference implementation of depth-of-field rendering: references with error bars, exact layers, and published
    methods pixel for pixel.
    """
    if context.invoked_subcommand is None:
        print(context.get_help())
        raise typer.Exit(2)


def main() -> None:
    """Run the command line; bad input is one line on stderr and status 2."""
    warnings.formatwarning = _one_line
    gc.freeze()  # what is imported stays to the end: looking for garbage in it takes a tenth of a short run
    try:
        status = app(standalone_mode=False)
        if sys.stdout is not None:  # None: it was closed before
            sys.stdout.flush()
    except BrokenPipeError:  # who reads has enough, as `head` does
        _silence()
        sys.exit(0)
    except OSError as error:
        if error.filename is not None or error.errno not in _FULL:
            raise
        _silence()
        _fail(f"stdout: cannot write ({error.strerror}); allowed is a place with room", 2)
    except InputError as error:
        _fail(str(error), 2)
    except _UsageError as error:
        _fail(_number_expected(error) or error.format_message(), 2)
    except (typer.Abort, KeyboardInterrupt):
        status = INTERRUPTED
    if status == INTERRUPTED:
        hear_no_more()
        _fail("interrupted; nothing was written", INTERRUPTED)
    gc.freeze()
    sys.exit(status if isinstance(status, int) else 0)


def _number_expected(error: Any) -> str:
    """What is wrong with a word in the place of a number, in refdof's words; empty where that is not the error."""
    kind = re.search(r"\b(integer|number|float)\b", getattr(error, "message", ""))
    if kind is None or getattr(error, "param", None) is None:
        return ""
    if hasattr(error.__cause__, "errors"):  # of pydantic, in newer versions of typer
        got = error.__cause__.errors()[0]["input"]
    else:
        got = error.message.partition("' is not ")[0][1:]
    allowed = "a whole number" if kind[1] == "integer" else "a number"
    return f"{error.param.opts[-1].lstrip('-')}: got {got!r:.80}; allowed is {allowed}"


def _one_line(message: Warning | str, *_: Any, **__: Any) -> str:
    return "refdof: warning: " + " ".join(str(message).split()) + "\n"


def _silence() -> None:
    """Let Python's own last flush of stdout go nowhere."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _fail(message: str, status: int) -> None:
    print("refdof: " + " ".join(message.split()), file=sys.stderr)
    sys.exit(status)


if __name__ == "__main__":
    main()
