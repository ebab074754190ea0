"""Packs of a few cases, in place of those of a level."""

from collections.abc import Sequence
from pathlib import Path
from unittest import mock

from refdof.oracle import write_pack
from refdof.oracle.cases import Case

__all__ = ["pack_of"]


def pack_of(cases: Sequence[Case], folder: Path) -> Path:
    """Write a pack of these cases into a folder."""
    with mock.patch("refdof.oracle.pack.cases_of", return_value=list(cases)):
        write_pack(folder)
    return folder
