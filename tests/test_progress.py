"""Progress on a terminal: a word at once, then scenes by name and the share of the whole run; nothing elsewhere."""

import os
import pty
import re
import subprocess
import sys

import pytest

from refdof.progress import overall, progress_line

pytestmark = pytest.mark.fast


def on_a_terminal(words, folder):
    """What a command shows on stderr, a terminal of 100 columns."""
    ours, theirs = pty.openpty()
    environment = {**os.environ, "COLUMNS": "100", "TERM": "xterm"}
    process = subprocess.Popen(
        [sys.executable, "-m", "refdof.launch", *words],
        cwd=folder,
        env=environment,
        stdout=subprocess.DEVNULL,
        stderr=theirs,
    )
    os.close(theirs)
    shown = b""
    while True:
        try:
            piece = os.read(ours, 65536)
        except OSError:  # the terminal was hung up
            break
        if not piece:
            break
        shown += piece
    os.close(ours)
    assert process.wait(timeout=60) == 0, shown
    return shown.decode()


def test_render_says_what_it_does_from_the_start(tmp_path):
    words = ["render", "branches", "--method", "singlepass", "--size", "32x24", "-o", "a.png"]
    shown = on_a_terminal(words, tmp_path)
    assert shown.startswith("refdof: starting")
    assert "branches: scene" in shown
    assert "branches: singlepass" in shown
    assert shown.rstrip().endswith("\x1b[2K") or shown.endswith("\x1b[?25h")  # an empty line is left, and the cursor
    done = subprocess.run(
        [sys.executable, "-m", "refdof.launch", *words], cwd=tmp_path, capture_output=True, text=True, timeout=600
    )
    assert (done.returncode, done.stderr) == (0, "")


def test_compare_counts_all_scenes(tmp_path):
    # So large that the second scene takes longer than the bar is shown without a change, a tenth of a second.
    words = ["compare", "branches", "cans", "--methods", "singlepass, scatter", "--size", "192x144", "--samples", "16"]
    shown = on_a_terminal(words, tmp_path)
    shares = [int(share) for share in re.findall(r"(\d+)%", shown)]
    assert shares == sorted(shares)
    assert "cans (2 of 2): " in shown


def test_without_a_terminal_only_compiling_is_said_once(capsys):
    with progress_line() as tell:
        share = overall(tell, "fence", 0, 1)
        share("scores", 0, 2)
        assert capsys.readouterr().err == ""
        for tell_compiling in (share, tell):  # of a comparison, and of other commands
            tell_compiling("compiling", 0, 3)
            tell_compiling("compiling", 3, 3)
    said = "refdof: compiling what was not used before; some minutes, the first time only\n"
    assert capsys.readouterr().err == said
    with progress_line() as tell:
        tell("compiling", 0, 3)
        assert capsys.readouterr().err == said  # before it is done


def test_shares_grow_over_steps_and_scenes():
    told = []
    for number, scene in enumerate(("a", "b")):
        tell = overall(lambda *words: told.append(words), scene, number, 2)
        for what, done, count in (
            ("compiling", 0, 3),
            ("reference", 1, 2),
            ("reference", 2, 2),
            ("scatter", 0, 2),
            ("mipmap", 1, 2),
            ("scores", 1, 2),
            ("artefacts", 1, 2),
            ("kernels", 0, 2),
            ("lens chart", 0, 1),
            ("motion", 1, 2),
        ):
            tell(what, done, count)
    assert told[0] == ("a (1 of 2): compiling", 0, 2000)
    assert told[1] == ("a (1 of 2): reference", 188, 2000)  # 1.5 of 8 parts
    assert told[4] == ("a (1 of 2): mipmap", 312, 2000)
    assert told[9] == ("a (1 of 2): motion", 938, 2000)
    assert told[10] == ("b (2 of 2): compiling", 1000, 2000)
    assert told[15] == ("b (2 of 2): scores", 1438, 2000)
