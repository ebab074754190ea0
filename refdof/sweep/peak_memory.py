"""Peak memory: how much more memory a block of code held than was held before it. On Linux only.

1. Give free memory back to the system, so that the block does not find it again     `_trim`
2. Let the kernel forget the highest resident size so far                              /proc/self/clear_refs
3. Read the highest resident size since                                                /proc/self/status, VmHWM
"""

import ctypes
import gc
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

__all__ = ["Peak", "peak_memory"]

_FORGET_HIGHEST = "5"  # Linux, Documentation/filesystems/proc: "clear_refs"


@dataclass
class Peak:
    """The most memory above what was held before [bytes]; NaN until the block ends, and where it cannot be told."""

    bytes: float = float("nan")


@contextmanager
def peak_memory() -> Iterator[Peak]:
    """Watch the memory of this process, all threads, as long as the block lasts."""
    peak, before = Peak(), None
    gc.collect()
    _trim()
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text(_FORGET_HIGHEST)
        before = _resident("VmHWM")
    yield peak
    if before is not None:
        peak.bytes = float(max(_resident("VmHWM") - before, 0))


def _trim() -> None:
    with suppress(OSError, AttributeError):  # a C library other than GNU's
        ctypes.CDLL(None).malloc_trim(0)


def _resident(what: str) -> int:
    """A size of this process [bytes]."""
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith(what + ":"):
            return int(line.split()[1]) * 1024
    raise OSError(f"/proc/self/status has no {what}")
