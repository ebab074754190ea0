"""The process that draws: a shader that never ends, or a driver that crashes, ends it alone."""

import signal

import pytest

from refdof.oracle import check_shader
from refdof.oracle.shaders import source
from tests.oracle.shaders.cases import GLSL, PORTS, statuses
from tests.ports.cases import mutated

pytestmark = pytest.mark.gl

SUFFIX = "frag"


def test_a_shader_that_never_ends_is_ended(outcomes):
    # Mesa itself ends loops after 65536 rounds, which takes minutes of these.
    reads = "color += 0.01 * texture(uTexture, color.xy).rgb; " * 100
    text = mutated(GLSL, "return color / total;", f"while (color.x > -1.0) {{ {reads} }} return color / total;")
    found = outcomes(text, timeout=0.5)
    assert statuses(found) == ["error"] * 5
    assert found[0].message == "the shader ran for more than 0.5 s and was ended"


@pytest.mark.parametrize(
    ("sent", "said"),
    [
        (signal.SIGSTOP, "the shader ran for more than 4 s and was ended"),  # as if it never came back from drawing
        (signal.SIGSEGV, "the driver ended the process with signal SIGSEGV"),
    ],
)
def test_a_case_that_ends_its_process_takes_no_other_with_it(pack, monkeypatch, sent, said):
    asked = []

    def ask(process, message, *more):
        asked.append(message["do"])
        if len(asked) == 3:
            process._process.send_signal(sent)
        return original(process, message, *more)

    original = source.Process.ask
    monkeypatch.setattr(source.Process, "ask", ask)
    found = check_shader(PORTS / "glsl" / "singlepass.frag", pack, timeout=4.0).outcomes
    assert statuses(found) == ["pass", "error", "pass", "pass", "pass"]
    assert found[1].message == said
    assert asked == ["compile", "draw", "draw", "compile", "draw", "draw", "draw"]


def test_processes_end(pack, monkeypatch):
    started = []
    original = source.Process.__init__

    def init(process):
        original(process)
        started.append(process._process)

    monkeypatch.setattr(source.Process, "__init__", init)
    check_shader(PORTS / "glsl" / "singlepass.frag", pack)
    assert [process.poll() is not None for process in started] == [True]
