"""Commands that refuse their words: in one line of the error output, with status 2."""

import sys

import pytest

from refdof.cli import main

__all__ = ["refused"]


def refused(monkeypatch, capsys, *words):
    """The line that `refdof` says of these words."""
    monkeypatch.setattr(sys, "argv", ["refdof", *words])
    with pytest.raises(SystemExit) as status:
        main()
    assert status.value.code == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert len(err.strip().splitlines()) == 1, err
    return err
