"""What the twins need is compiled once, ahead, in processes."""

import subprocess
from types import SimpleNamespace

import pytest

from refdof import _jit
from refdof.stability import ahead

pytestmark = pytest.mark.fast


def test_each_method_once(tmp_path, monkeypatch):
    started, told = [], []

    def run(command, env, **_):
        method, mark = command[-2:]
        started.append((method, env["NUMBA_NUM_THREADS"]))
        (tmp_path / mark).touch()  # as the process does
        return SimpleNamespace(returncode=0)

    monkeypatch.setattr(ahead, "subprocess", SimpleNamespace(run=run, DEVNULL=subprocess.DEVNULL))
    monkeypatch.setattr(ahead, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr("refdof.warm.cache_folder", lambda: tmp_path)
    monkeypatch.setattr(ahead, "thread_count", lambda: 2)
    monkeypatch.setattr(ahead.os, "cpu_count", lambda: 2)
    ahead.compile_twins(["mipmap", "scatter"], lambda *words: told.append(words))
    assert sorted(started) == [("mipmap", "1"), ("scatter", "1")]
    assert told == [("compiling", 0, 2), ("compiling", 1, 2), ("compiling", 2, 2)]
    ahead.compile_twins(["mipmap", "scatter"], lambda *words: told.append(words))
    assert len(started) == 2


@pytest.mark.skipif(_jit.JIT_DISABLED, reason="about compiled code; the compiled pass runs it")
def test_the_process_leaves_its_mark(tmp_path, monkeypatch):
    monkeypatch.setenv("REFDOF_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(ahead, "cache_folder", lambda: tmp_path)
    ahead._compile("accumulation")
    assert len(list(tmp_path.rglob("accumulation-twin.warm"))) == 1
