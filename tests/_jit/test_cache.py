"""The cache cannot go stale, and machine code is what was written: in processes of their own, with empty caches.

None is fast: kernels' passes, interpreted or with checked bounds, would only compile the same once more.
"""

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import refdof
from refdof import _jit
from refdof._jit import compile as compile_

PACKAGE = Path(_jit.__file__).parents[1]
ROOT = Path(__file__).parents[2]


def run(folder, cache):
    words = {**os.environ, "PYTHONPATH": str(folder), "REFDOF_CACHE_DIR": str(cache), "PYTHONDONTWRITEBYTECODE": "1"}
    code = "from refdof.probe import answer; print(answer(1.0))"
    done = subprocess.run(
        [sys.executable, "-c", code], env=words, cwd=folder, capture_output=True, text=True, timeout=300, check=True
    )
    return done.stdout.strip()


def test_an_edited_helper_is_seen_at_once(tmp_path):
    """The kernel's file stays as it is; only the helper in another file changes."""
    package, cache = tmp_path / "refdof", tmp_path / "cache"
    package.mkdir()
    shutil.copytree(PACKAGE / "_jit", package / "_jit", ignore=shutil.ignore_patterns("__pycache__"))
    (package / "__init__.py").write_text("")
    (package / "helper.py").write_text(
        "from refdof._jit import inline\n\n\n@inline\ndef step(x):\n    return x + 1.0\n"
    )
    (package / "probe.py").write_text(
        "from refdof._jit import tile_kernel\nfrom refdof.helper import step\n\n\n"
        "@tile_kernel\ndef answer(x):\n    return step(x)\n"
    )
    assert run(tmp_path, cache) == "2.0"
    assert run(tmp_path, cache) == "2.0"
    assert len(list(cache.iterdir())) == 1
    helper = package / "helper.py"
    helper.write_text(helper.read_text().replace("1.0", "100.0"))
    assert run(tmp_path, cache) == "101.0"
    assert len(list(cache.iterdir())) == 2


def test_the_digest_covers_the_whole_package():
    assert compile_._package_folder() == Path(refdof.__file__).parent


PROBE = """
import sys
import numpy as np
from refdof._jit import kernel, prange, tile_kernel


@tile_kernel
def total(a):
    out = a[0] - a[0]
    for x in a:
        out += x
    return out


@kernel
def halves(a):
    out = np.empty_like(a)
    for k in prange(len(a)):
        out[k] = a[k] / a.dtype.type(2)
    return out


def answer(kind):
    a = np.arange(1, 9).astype(kind)
    print(complex(total(a)), halves(a).tolist(), sep="|")
    print([sum(f.stats.cache_hits.values()) for f in (total, halves) if hasattr(f, "stats")])
"""


def test_processes_that_compile_at_once_keep_their_signatures_apart(tmp_path):
    # Four processes start with an empty folder, each with a type of its own; then a copy elsewhere finds all of them.
    cache, kinds = tmp_path / "cache", ("float32", "float64", "complex64", "complex128")
    for place in ("here", "there"):
        package = tmp_path / place / "refdof"
        package.mkdir(parents=True)
        shutil.copytree(PACKAGE / "_jit", package / "_jit", ignore=shutil.ignore_patterns("__pycache__"))
        (package / "__init__.py").write_text("")
        (package / "probe.py").write_text(PROBE)

    def start(place, kind):
        words = {**os.environ, "PYTHONPATH": str(tmp_path / place), "REFDOF_CACHE_DIR": str(cache)}
        code = f"from refdof.probe import answer; answer({kind!r})"
        return subprocess.Popen(
            [sys.executable, "-c", code], env=words, cwd=tmp_path / place, stdout=subprocess.PIPE, text=True
        )

    for place, hits in (("here", 0), ("there", 1)):
        running = [start(place, kind) for kind in kinds]
        printed = [process.communicate(timeout=300)[0].splitlines() for process in running]
        for (values, found), kind in zip(printed, kinds, strict=True):
            numbers = np.arange(1, 9).astype(kind)
            assert values == f"{complex(36)}|{(numbers / 2).tolist()}"
            assert found == ("[]" if compile_.JIT_DISABLED else f"[{hits}, {hits}]")


BEYOND = """
import numpy as np
from refdof._jit import borrow, inline, kernel, prange, tile_kernel


@inline
def read(row, k):
    return row[k]


@tile_kernel
def in_a_tile(a, n):
    return read(a, n)


@kernel
def in_a_loop(a, n):
    out = np.zeros(n)
    for k in prange(n):
        out[k] = read(a, k + 1)
    return out


@kernel
def in_a_borrowed_row(a, n):
    for k in prange(1):
        borrow(a)[n] = 1.0


for function in (in_a_tile, in_a_loop, in_a_borrowed_row):
    function(np.zeros(9), 8)
    try:
        function(np.zeros(9), 9)
    except IndexError:
        print(function.__name__)
"""


@pytest.mark.skipif(_jit.JIT_DISABLED, reason="about compiled code; the compiled pass runs it")
def test_checked_bounds_are_told_of_whatever_the_loop(tmp_path):
    (tmp_path / "beyond.py").write_text(BEYOND)  # Numba reads sources
    words = {**os.environ, "PYTHONPATH": str(ROOT), "REFDOF_CACHE_DIR": str(tmp_path), "NUMBA_BOUNDSCHECK": "1"}
    done = subprocess.run([sys.executable, "beyond.py"], env=words, cwd=tmp_path, capture_output=True, text=True)
    assert done.stdout.split() == ["in_a_tile", "in_a_loop", "in_a_borrowed_row"], done.stderr


def test_a_folder_that_nobody_used_for_a_month_is_removed(tmp_path):
    package, cache = tmp_path / "refdof", tmp_path / "cache"
    package.mkdir()
    shutil.copytree(PACKAGE / "_jit", package / "_jit", ignore=shutil.ignore_patterns("__pycache__"))
    (package / "__init__.py").write_text("")
    (package / "probe.py").write_text("from refdof import _jit\n\n\ndef answer(x):\n    return x\n")
    for name, days in (("old", 40), ("young", 10)):
        (cache / name).mkdir(parents=True)
        os.utime(cache / name, (time.time() - days * 86400,) * 2)
    assert run(tmp_path, cache) == "1.0"
    assert not (cache / "old").exists()
    assert (cache / "young").exists()


LAZY = """
import sys
import numpy as np
from numba.core.codegen import JITCodeLibrary
made = []
finish = JITCodeLibrary._finalize_final_module
JITCodeLibrary._finalize_final_module = lambda self: (made.append(self.name), finish(self))
from refdof._jit import compile, inline, kernel, prange, tile_kernel
if sys.argv[1] == "eager":
    from numba.core.compiler import Compiler
    compile._HOW["pipeline_class"] = Compiler


@inline
def bend(x):
    return np.float32(1) / (x * x + np.float32(0.3)) - np.sqrt(x)


@inline
def bend_twice(x):
    return bend(bend(x) * bend(x))


@tile_kernel
def total(a):
    out = np.float32(0)
    for k in range(len(a)):
        out += bend_twice(a[k])
    return out


@kernel
def every(a):
    out = np.empty_like(a)
    for k in prange(len(a)):
        out[k] = bend_twice(a[k]) + bend(a[k])
    return out


a = np.linspace(0, 3, 1000, dtype=np.float32)
print(float(total(a)).hex(), every(a).tobytes().hex())
print(bend.__class__.__name__, [name for name in made if "bend" in name])
print(bend(np.float32(2.0)) == bend.py_func(np.float32(2.0)))
"""


@pytest.mark.skipif(compile_.JIT_DISABLED, reason="about compiled code; the compiled pass runs it")
def test_helpers_are_not_made_into_machine_code_and_no_bit_changes(tmp_path):
    # Beside Numba's own way, from an empty cache and from a full one. A helper can be called from Python all the same.
    script = tmp_path / "lazy.py"
    script.write_text(LAZY)

    def lines(how):
        words = {**os.environ, "PYTHONPATH": str(PACKAGE.parent), "REFDOF_CACHE_DIR": str(tmp_path / how)}
        command = [sys.executable, str(script), how]
        done = subprocess.run(command, env=words, capture_output=True, text=True, timeout=300, check=True)
        return done.stdout.splitlines()

    cold, cached, eager = lines("lazy"), lines("lazy"), lines("eager")
    assert cold[0] == cached[0] == eager[0]
    assert cold[1] == cached[1] == "HelperDispatcher []"
    assert "bend" in eager[1].split(" ", 1)[1]
    assert cold[2] == cached[2] == eager[2] == "True"
