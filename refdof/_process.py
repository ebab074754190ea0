"""Process: the command line's work is done by a child process, so that Ctrl-C ends it at any moment.

Python hears Ctrl-C between two of its own steps. A kernel, or a pass of the compiler, is one long step. So the process
that was started does nothing but wait (on Linux; elsewhere there is one process, and Ctrl-C waits for the step):

1. fork before anything slow is imported                                           `work_in_child`
2. a Ctrl-C reaches the child as well; it has most of a second to end by itself
3. then it is killed with all processes below it, and what it had not finished is removed   `unfinished`

A child whose parent is gone is killed, too.
"""

import ctypes
import mmap
import os
import shutil
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Lock

__all__ = ["INTERRUPTED", "die_with_parent", "hear_no_more", "unfinished", "work_in_child"]

INTERRUPTED = 130  # what a shell reports after Ctrl-C
_PATIENCE = 0.7  # seconds
_ROOM = 1 << 16  # bytes of names; what does not fit is not removed
_SAID = b"!"  # the memory's last byte
_DIE_WITH_PARENT = 1  # PR_SET_PDEATHSIG
_ADOPT = 36  # PR_SET_CHILD_SUBREAPER: orphans below this process become its children
_BY_THE_TERMINAL = 0x80  # si_code of a signal that the kernel sends, to all processes of the terminal's group


class _Names:
    """What is unfinished in this process, and the memory that a parent reads it from."""

    paths: dict[Path, None]
    memory: mmap.mmap | None

    def __init__(self) -> None:
        self.paths, self.memory, self.lock = {}, None, Lock()

    def tell(self) -> None:
        if self.memory is not None:
            names = b"\0".join(os.fsencode(path) for path in self.paths)[: _ROOM - 2]
            self.memory[: len(names) + 1] = names + b"\n"


_names = _Names()


@contextmanager
def unfinished(*paths: Path) -> Iterator[None]:
    """While the block runs, these absolute paths are removed if the process is killed after Ctrl-C."""
    with _names.lock:
        _names.paths.update(dict.fromkeys(paths))
        _names.tell()
    try:
        yield
    finally:
        with _names.lock:
            for path in paths:
                _names.paths.pop(path, None)
            _names.tell()


def hear_no_more() -> None:
    """Ignore Ctrl-C from now on: one was heard, and this process says so and ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if _names.memory is not None:
        _names.memory[-1:] = _SAID


def die_with_parent() -> None:
    """Let the kernel kill this process when its parent ends; on Linux only."""
    if sys.platform == "linux":
        parent = os.getppid()
        ctypes.CDLL(None).prctl(_DIE_WITH_PARENT, signal.SIGKILL)
        if os.getppid() != parent:  # it was gone already
            os._exit(1)


def work_in_child() -> None:
    """Return in a child process; this one ends when and as the child does."""
    if sys.platform != "linux":
        return
    memory = mmap.mmap(-1, _ROOM)
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    heard = {signal.SIGCHLD, signal.SIGINT, signal.SIGTERM, signal.SIGHUP}
    heard = {number for number in heard if signal.getsignal(number) is not signal.SIG_IGN}
    signal.pthread_sigmask(signal.SIG_BLOCK, heard)
    ctypes.CDLL(None).prctl(_ADOPT, 1)
    child = os.fork()
    if child == 0:
        die_with_parent()
        _names.memory = memory
        signal.pthread_sigmask(signal.SIG_UNBLOCK, heard)
        return
    _end_as(_wait_for(child, heard, memory))


def _wait_for(child: int, heard: set[signal.Signals], memory: mmap.mmap) -> int:
    """The child's exit status, as of `os.waitstatus_to_exitcode`."""
    last = None
    while True:
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            code = os.waitstatus_to_exitcode(status)
            return INTERRUPTED if code == -signal.SIGINT and last is not None else code
        if last is not None and time.monotonic() >= last:
            return _kill(child, memory)
        came = signal.sigtimedwait(heard, 10.0 if last is None else max(last - time.monotonic(), 0.0))
        if came is None or came.si_signo == signal.SIGCHLD:
            continue
        if came.si_code != _BY_THE_TERMINAL:
            with suppress(ProcessLookupError):
                os.kill(child, came.si_signo)
        if came.si_signo == signal.SIGINT and last is None:
            last = time.monotonic() + _PATIENCE


def _kill(child: int, memory: mmap.mmap) -> int:
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    _kill_orphans()
    for name in memory[:].split(b"\n")[0].split(b"\0"):
        path = Path(os.fsdecode(name))
        if name and path.is_absolute():
            shutil.rmtree(path, ignore_errors=True)
            with suppress(OSError):
                path.unlink()
    if sys.stderr.isatty():
        print("\r\x1b[2K\x1b[?25h", end="", file=sys.stderr)  # what a progress line hid
    if memory[-1:] != _SAID:
        print("refdof: interrupted; nothing was written", file=sys.stderr)
    return INTERRUPTED


def _kill_orphans() -> None:
    """Kill all processes of this session that the dead child had started, and theirs: they could still write."""
    children = Path(f"/proc/self/task/{os.getpid()}/children")
    with suppress(OSError):  # a kernel may have no such file
        while ours := [n for n in map(int, children.read_text().split()) if os.getsid(n) == os.getsid(0)]:
            for number in ours:
                os.kill(number, signal.SIGKILL)
            for number in ours:
                os.waitpid(number, 0)


def _end_as(status: int) -> None:
    """End this process: by the signal -status, if it is negative."""
    with suppress(OSError):
        sys.stderr.flush()
    if status < 0:
        signal.signal(-status, signal.SIG_DFL)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {-status})
        os.kill(os.getpid(), -status)
    os._exit(status if status >= 0 else 128 - status)
