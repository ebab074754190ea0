"""Machine: the processor that a time was measured on, in words."""

import platform
from contextlib import suppress
from functools import cache
from pathlib import Path

__all__ = ["processor"]


@cache
def processor() -> str:
    """The processor's name and its widest vectors, as "AMD EPYC 9B14, AVX2"; the architecture where it has no name."""
    facts: dict[str, str] = {}
    with suppress(OSError):
        for line in Path("/proc/cpuinfo").read_text().split("\n\n")[0].splitlines():
            name, _, value = line.partition(":")
            facts[name.strip()] = value.strip()
    flags = facts.get("flags", "").split()
    widest = "AVX-512" if "avx512f" in flags else "AVX2" if "avx2" in flags else ""
    return ", ".join(filter(None, (facts.get("model name") or platform.machine(), widest)))
