"""Hostile functions and programs: none spoils a pack, is waited for too long, or gets a wrong verdict."""

import sys
import time

import numpy as np
import pytest

from refdof.oracle import Plan, check, check_command
from tests.oracle.small_pack import command, port, posix, statuses

pytestmark = pytest.mark.fast

GOOD = np.zeros((18, 24, 3), np.float32)


def left(color, depth, coc, params):
    raise SystemExit(0)


class Ragged:
    def __array__(self, *words, **more):
        raise RuntimeError("no\narray")


@pytest.mark.parametrize(
    ("function", "said"),
    [
        (left, "raised SystemExit"),
        (lambda *words: 1 / 0, "raised ZeroDivisionError"),
        (lambda *words: {}, "image: is missing"),
        (lambda *words: {7: GOOD, "image": GOOD}, "7: is no result"),
        (lambda *words: {("a",): GOOD, "image": GOOD}, "is no result"),
        (lambda *words: [[1.0], [1.0, 2.0]], "is no array"),
        (lambda *words: Ragged(), "is no array"),
        (lambda *words: {"image": GOOD, "size": GOOD}, "size: is float32 of shape"),
    ],
)
def test_functions(pack, function, said):
    outcome = check(function, pack, plan=Plan(only="cards")).outcomes[0]
    assert outcome.status == "error"
    assert said in outcome.message


def test_a_function_cannot_spoil_what_it_is_given(pack):
    def spoiling(color, depth, coc, params):
        image = port(color, depth, coc, params)
        for array in (color, depth, coc):
            array[...] = np.nan
        params.clear()
        return image

    assert check(spoiling, pack).passed


RIGHT = "(out / 'image.f32').write_bytes((case / 'expected' / 'image.f32').read_bytes())\n"
WRONG = "(out / 'image.f32').write_bytes((case / 'inputs' / 'color.f32').read_bytes())\n"
LATER = """
if os.fork() == 0:
    {leave}
    while True:
        time.sleep(0.01)
        print('x', file=sys.stderr, flush=True)
"""


@posix
@pytest.mark.parametrize(
    ("code", "status", "said"),
    [
        (RIGHT + "sys.stdout.write('x' * 20_000_000)", "pass", "image"),
        (RIGHT + "sys.stderr.write('x' * 20_000_000)", "pass", "image"),
        ("sys.stderr.write('x' * 5_000_000 + chr(10) + 'the end'); sys.exit(3)", "error", "status 3: the end"),
        ("sys.stderr.write('a' + chr(27) + '[2J' + chr(7) + 'b'); sys.exit(3)", "error", "a [2J b"),
        ("sys.stderr.buffer.write(bytes([255, 10])); sys.exit(3)", "error", "status 3"),
        ("print('nothing said'); os.kill(os.getpid(), 9)", "error", "status -9"),
        ("while True: pass", "error", "ran for more than 1.5 s"),
        (RIGHT + "sys.stdin.read()", "pass", "image"),
        (RIGHT + LATER.format(leave="pass") + "sys.exit(0)", "pass", "image"),
        (RIGHT + LATER.format(leave="os.setsid()") + "sys.exit(0)", "pass", "image"),
        (LATER.format(leave="pass") + "time.sleep(60)", "error", "ran for more than 1.5 s"),
        (RIGHT + "(out / 'more').write_text('x')", "error", "more: is no result"),
        (RIGHT + "(case / 'more').write_text('x')", "error", "has changed the pack: more: is not in the manifest"),
        (
            WRONG + "(case / 'expected/image.npy').write_bytes((case / 'inputs/color.npy').read_bytes())",
            "error",
            "has changed the pack: expected/image.npy: is not as it was written",
        ),
        (WRONG + "(case / 'case.json').unlink()", "error", "has changed the pack: case.json: is missing"),
        ("out.rmdir()", "error", "no folder"),
        ("out.rmdir(); out.symlink_to(case / 'expected')", "error", "no folder"),
        ("(out / 'image.f32').symlink_to(case / 'expected' / 'image.f32')", "error", "no regular file"),
    ],
)
def test_programs(copied, tmp_path, code, status, said):
    if "setsid" in code:  # it is out of the group: where there is no /proc, nobody but this test ends it
        code = code.replace("while True:", f"while not pathlib.Path({str(tmp_path / 'end')!r}).exists():")
    began = time.monotonic()
    report = check_command(command(tmp_path, code), copied, timeout=1.5, plan=Plan(only="cards"))
    (tmp_path / "end").touch()
    assert time.monotonic() - began < 10.0
    outcome = report.outcomes[0]
    assert outcome.status == status, outcome.message
    assert said in outcome.message
    assert outcome.message.isprintable()


BEATS = """
if os.fork() == 0:
    {leave}
    while True:
        time.sleep(0.01)
        with open({file!r}, 'a') as file:
            file.write('x')
while not os.path.exists({file!r}):
    time.sleep(0.01)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="what has left its process group is found in /proc, Linux's")
@pytest.mark.parametrize("leave", ["os.setsid()", "os.setsid(); os.fork() and os._exit(0)"])
@pytest.mark.parametrize(("then", "status"), [(RIGHT, "pass"), ("time.sleep(60)", "error")])
def test_what_leaves_its_process_group_is_ended(pack, tmp_path, leave, then, status):
    beats = tmp_path / "beats"
    code = BEATS.format(leave=leave, file=str(beats)) + then
    report = check_command(command(tmp_path, code), pack, timeout=1.5, plan=Plan(only="cards"))
    assert statuses(report) == [status]
    last = beats.stat().st_size
    time.sleep(0.2)
    assert beats.stat().st_size == last > 0


@posix
def test_a_command_line_is_no_shell_and_marks_are_filled_in_once(pack, tmp_path):
    words = command(tmp_path, RIGHT + "assert sys.argv[1].endswith('cards')")
    assert check_command(words, pack, plan=Plan(only="cards")).passed
    evil = f"{words} '; touch {tmp_path / 'evil'}' '$(touch {tmp_path / 'evil'})'"
    assert statuses(check_command(evil, pack, plan=Plan(only="cards"))) == ["error"]
    assert not (tmp_path / "evil").exists()


@posix
def test_given_stages_are_in_a_copy_of_the_case(pack, tmp_path):
    code = (
        "given = [line.split()[1] for line in (case / 'params.txt').read_text().splitlines() if 'given' in line]\n"
        "factor = 1.0 if given == ['size'] and (case / 'inputs/size.npy').stat().st_size == 128 + 1728 else 0.5\n"
        "import numpy as np\n"
        f"golden = pathlib.Path({str(pack / 'cards')!r}.replace('cards', 'cases/cards')) / 'expected'\n"
        "assert (case / 'expected').exists() == (not given)\n"
        "for name, place in (('size', 'stages/size'), ('image', 'image')):\n"
        "    values = np.load(golden / f'{place}.npy') * np.float32(factor)\n"
        "    (out / f'{name}.f32').write_bytes(values.tobytes())\n"
    )
    outcome = check_command(command(tmp_path, code), pack, plan=Plan(only="cards", given=("size",))).outcomes[0]
    assert outcome.causes == {"size": "own", "image": "inherited"}, outcome.message
