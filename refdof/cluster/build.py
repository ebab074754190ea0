"""Build: what the bits of a result depend on besides its inputs, and whether two processes have the same."""

import sys
from functools import cache
from importlib import import_module
from importlib.metadata import version
from typing import NamedTuple

from refdof._check import InputError
from refdof._jit import JIT_DISABLED, processor, source_digest

__all__ = ["Build", "own_build", "python_version", "refuse_other"]


class Build(NamedTuple):
    """Versions, the kind of processor, whether kernels are compiled, and a digest of the sources and all of these."""

    refdof: str
    python: str
    numpy: str
    numba: str
    embreex: str
    processor: str
    compiled: str
    sources: str


def python_version() -> str:
    """Of the interpreter: 3.11.7."""
    return ".".join(map(str, sys.version_info[:3]))


@cache
def own_build() -> Build:
    """The build of this process."""
    return Build(
        import_module("refdof").__version__,  # whose rooms come after this one
        python_version(),
        version("numpy"),
        version("numba"),
        version("embreex"),
        processor(),
        "no" if JIT_DISABLED else "yes",
        source_digest(),
    )


def refuse_other(worker: str, theirs: Build, ours: Build) -> None:
    """Raise if a worker's results might have other bits, and say why: the first thing that differs."""
    for name, got, allowed in zip(Build._fields, theirs, ours, strict=True):
        if got != allowed:
            raise InputError(f"worker {worker}: got {name} {got}; allowed is {name} {allowed}, as here")
