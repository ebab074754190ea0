"""Ctrl-C ends a command within a second, whatever it does, and leaves no file; other ends pass through."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="elsewhere Ctrl-C waits for the running step")
PROGRAM = [sys.executable, "-m", "refdof.launch"]
# Most of a second is given, and a process of this size takes a moment to be taken down on a busy machine.
WITHIN = 3.0


def said_of_interrupt(error):
    """Whether a program says that it was interrupted, after that it compiles at most."""
    *before, last = error.splitlines()
    compiling = "refdof: compiling what was not used before; some minutes, the first time only"
    return before in ([], [compiling]) and last == "refdof: interrupted; nothing was written"


def started(words, folder, **options):
    """The program, with an empty cache, in a session of its own where SIGINT is heard."""
    environment = {**os.environ, "REFDOF_CACHE_DIR": str(folder / "cache")}
    return subprocess.Popen(
        [*PROGRAM, *words],
        env=environment,
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
        **options,
    )


def children_of(number):
    """Numbers of all processes below one."""
    found = []
    for entry in os.listdir("/proc"):
        if entry.isdigit():
            try:
                with open(f"/proc/{entry}/stat") as file:
                    parent = int(file.read().rsplit(")", 1)[1].split()[1])
            except OSError:
                continue
            if parent == number:
                found += [int(entry), *children_of(int(entry))]
    return found


@pytest.mark.parametrize("seconds", [0.05, 0.3, 1.0, 2.5, 6.0])
@pytest.mark.parametrize("words", ["render fence --method singlepass -o a.png", "compare fence --out out"])
def test_interrupt_while_importing_and_compiling(tmp_path, words, seconds):
    process = started(words.split(), tmp_path)
    time.sleep(seconds)
    below = children_of(process.pid)
    began = time.monotonic()
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to all of them
    _, error = process.communicate(timeout=60)
    assert time.monotonic() - began < WITHIN
    if "Traceback" in error:  # before the first line of refdof was reached
        assert seconds < 0.1
        assert "/refdof/" not in error.replace("/refdof/__init__.py", "")
    elif seconds > 0.5:
        assert said_of_interrupt(error)
        assert process.returncode == 130
    assert sorted(path.name for path in tmp_path.iterdir() if path.name != "cache") in ([], ["out"])
    deadline = time.monotonic() + 5.0
    while any(os.path.exists(f"/proc/{child}") for child in below) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not [child for child in below if os.path.exists(f"/proc/{child}")]


STUCK = """
import sys, time
from pathlib import Path
from refdof._process import work_in_child
work_in_child()
from refdof.image.atomic import atomic_folder, atomic_path
import signal
signal.signal(signal.SIGINT, signal.SIG_IGN)  # as a step of a kernel hears nothing
with atomic_path("a.png"), atomic_folder("folder") as folder:
    (folder / "b").write_text("b")
    START
    print("ready", flush=True)
    time.sleep(60)
"""


# It writes without end, and has started another process.
BUSY = """__import__("subprocess").Popen(["sh", "-c", f"sleep 61 & while :; do mkdir -p '{folder}/a'; done"])"""


def stuck(tmp_path, more="pass"):
    process = subprocess.Popen(
        [sys.executable, "-c", STUCK.replace("START", more)],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    assert process.stdout.readline() == "ready\n"
    return process


@pytest.mark.fast
def test_what_hears_nothing_is_killed_and_leaves_no_file(tmp_path):
    process = stuck(tmp_path)
    assert len(list(tmp_path.iterdir())) == 2
    began = time.monotonic()
    process.send_signal(signal.SIGINT)
    _, error = process.communicate(timeout=60)
    assert 0.5 < time.monotonic() - began < WITHIN
    assert error == "refdof: interrupted; nothing was written\n"
    assert process.returncode == 130
    assert not list(tmp_path.iterdir())


@pytest.mark.fast
def test_what_it_had_started_is_killed_too_and_writes_no_more(tmp_path):
    process = stuck(tmp_path, BUSY)
    while len(below := children_of(process.pid)) < 3:
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=60) == 130
    time.sleep(0.2)
    assert not list(tmp_path.iterdir())
    assert not [child for child in below if Path(f"/proc/{child}").exists()]
    process.communicate()


@pytest.mark.fast
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL, signal.SIGHUP])
def test_the_work_ends_with_the_process_that_was_started(tmp_path, number):
    process = stuck(tmp_path)
    (child,) = children_of(process.pid)
    process.send_signal(number)
    process.wait(timeout=60)
    assert process.returncode == -number
    deadline = time.monotonic() + 10.0
    while os.path.exists(f"/proc/{child}") and time.monotonic() < deadline:
        time.sleep(0.02)
    assert not os.path.exists(f"/proc/{child}")
    process.communicate()


@pytest.mark.fast
@pytest.mark.parametrize(
    ("end", "status"), [("sys.exit(3)", 3), ("os.abort()", -signal.SIGABRT), ("pass", 0), ("1 / 0", 1)]
)
def test_ends_pass_through(end, status):
    code = (
        "import os, sys\nfrom refdof._process import work_in_child\nwork_in_child()\nprint('said', flush=True)\n" + end
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout) == (status, "said\n")


@pytest.mark.fast
def test_the_program_and_its_pipes():
    done = subprocess.run([*PROGRAM, "--version"], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("refdof ")
    done = subprocess.run([*PROGRAM, "render", "nowhere", "--method", "x"], capture_output=True, text=True, timeout=60)
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1
