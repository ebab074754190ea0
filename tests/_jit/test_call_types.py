"""Remembered call types: the machine code is that of Numba alone."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from refdof._jit import JIT_DISABLED

ROOT = Path(__file__).parents[2]
PROBE = """
import contextlib, sys
import numpy as np
import refdof._jit.lazy as lazy
from refdof._jit import call_types
plain = call_types._plain
if sys.argv[1] == "plain":
    lazy.remembered = contextlib.nullcontext
from refdof._jit import inline, kernel, prange

@inline
def third(a, k):
    return a[k] / 3 + k * a.dtype.type(0.5)

@kernel
def rows(a, out):
    for y in prange(a.shape[0]):
        total = 0
        for x in range(a.shape[1]):
            total += int(a[y, x] > 0.5) and x % 3 == 1
            out[y, x] = third(a[y], x) if a[y, x] < 1 else max(a[y, x], np.float32(2)) ** 2
        out[y, 0] -= total

for kind in (np.float32, np.float64):
    rows(np.ones((3, 5), kind), np.zeros((3, 5), kind))
assert call_types._Base.get_call_type is plain  # only while something is compiled
print(len(call_types._known), file=sys.stderr)
print(*rows.inspect_asm().values())
"""


def machine_code(how, folder):
    """The code, without the numbers that Numba gives to functions, and how many calls were remembered."""
    (folder / "probe.py").write_text(PROBE)
    words = {**os.environ, "PYTHONPATH": str(ROOT), "REFDOF_CACHE_DIR": str(folder / how)}
    command = [sys.executable, "probe.py", how]
    done = subprocess.run(command, env=words, cwd=folder, capture_output=True, text=True, timeout=300, check=True)
    return re.sub(r"v\d+|0x[0-9a-f]+|\d{6,}", "", done.stdout), int(done.stderr)


@pytest.mark.skipif(JIT_DISABLED, reason="nothing is compiled")
def test_the_machine_code_is_that_of_numba_alone(tmp_path):
    plain, none = machine_code("plain", tmp_path)
    code, some = machine_code("remembered", tmp_path)
    assert none == 0
    assert some > 20
    assert len(plain) > 10_000
    assert code == plain
