"""Shaders in GLSL: right ones pass in every dialect, wrong ones fail, and bad ones are told in one line."""

import os
import signal

import pytest
from typer.testing import CliRunner

from refdof import InputError
from refdof.cli import app
from refdof.methods.singlepass.params import DEPTH_FILTERS
from refdof.oracle import check_shader
from refdof.oracle.cases import Case
from refdof.oracle.shaders import source
from tests.oracle.shader_cases import (
    CASES,
    CONSTANTS,
    CORE,
    DEVICE,
    GLSL,
    PORTS,
    REVERSED,
    Kept,
    core_statuses,
    function_only,
    need,
    varying,
    write,
)
from tests.ports.cases import mutated

pytestmark = pytest.mark.gl


@pytest.fixture(scope="module")
def pack(tmp_path_factory):
    folder = tmp_path_factory.mktemp("shader")
    need("frag", folder)
    return write(folder / "pack")


@pytest.fixture(scope="module")
def kept():
    process = Kept()
    yield process
    process.close()


@pytest.fixture
def outcomes(pack, tmp_path, kept, monkeypatch):
    """What a shader's text makes of every case, with a text of bindings."""

    monkeypatch.setattr(source, "Process", kept)

    def run(text, bindings=None, timeout=20.0, name="shader.frag"):
        (tmp_path / name).write_text(text)
        file = None if bindings is None else tmp_path / "bindings.toml"
        if file is not None:
            file.write_text(bindings)
        return check_shader(tmp_path / name, pack, file, timeout).outcomes

    return run


def statuses(outcomes):
    return [outcome.status for outcome in outcomes]


@pytest.mark.skipif(not CORE.is_dir(), reason="there is no core pack beside the code")
def test_the_port_passes_the_core_pack(tmp_path):
    need("frag", tmp_path)
    found = core_statuses(PORTS / "glsl" / "singlepass.frag")
    assert found.pop("singlepass") == {"pass"}
    assert set().union(*found.values()) <= {"not supported"}


def test_the_port_passes_every_case(pack):
    told = []
    report = check_shader(PORTS / "glsl" / "singlepass.frag", pack, tell=lambda *words: told.append(words))
    assert statuses(report.outcomes) == ["pass"] * len(CASES)
    assert [done for _, done, _ in told] == [1, 2, 3, 4, 5]


DIALECTS = {
    "varying": varying(),
    "version 100": "#version 100\n#extension GL_OES_standard_derivatives : enable\n" + varying(),
    "version 120": "#version 120\n" + varying().replace("precision highp float;", ""),
    "version 300 es": "#version 300 es\n"
    + varying()
    .replace("texture2D", "texture")
    .replace("varying", "out vec4 fragColor;\nin")
    .replace("gl_FragColor", "fragColor"),
    "gl_FragData": varying().replace("gl_FragColor", "gl_FragData[0]"),
    "a function": function_only(),
}


@pytest.mark.parametrize("dialect", DIALECTS)
def test_dialects_with_constants(outcomes, dialect):
    found = outcomes(DIALECTS[dialect])
    assert statuses(found) == CONSTANTS, found
    assert found[-1].message == "the case has rad_scale = 1.0; the shader has no uniform for it"


def test_shadertoy(outcomes):
    text = varying().replace("varying vec2 vUv;", "").replace("uniform sampler2D tDiffuse;", "")
    text = text.replace("uniform sampler2D tDepth;", "").replace("tDiffuse", "iChannel0").replace("tDepth", "iChannel1")
    text = text.replace("uniform vec2 texelSize;", "").replace("texelSize", "(1.0 / iResolution.xy)")
    text = text.replace("texture2D", "texture").replace("void main()", "void mainImage(out vec4 c, in vec2 p)")
    text = text.replace("gl_FragColor", "c").replace("(vUv,", "(p / iResolution.xy,")
    text = text.replace("precision highp float;", "")
    with pytest.raises(InputError, match=r"^iChannel1: is a texture of unknown meaning"):
        outcomes(text)
    assert statuses(outcomes(text, 'iChannel1 = "depth / far"')) == CONSTANTS


@pytest.mark.parametrize(("depth", "word"), [(DEVICE, "device"), (REVERSED, "reversed")])
def test_depth_of_other_kinds_has_to_be_named(outcomes, depth, word):
    with pytest.raises(InputError, match=r"^tDepth: may hold depth of several kinds.*cameraNear"):
        outcomes(varying(depth))
    assert statuses(outcomes(varying(depth), f'tDepth = "{word}"')) == CONSTANTS


def test_filters_of_depth(tmp_path):
    """A filter blends what the texture holds: depth itself, or what is linear in its inverse, as a z-buffer."""
    need("frag", tmp_path)
    filters = [Case(word, "singlepass", "bar", (24, 18), {"depth_filter": word}) for word in DEPTH_FILTERS]
    pack = write(tmp_path / "pack", filters)
    (tmp_path / "planar.frag").write_text(varying())
    (tmp_path / "device.frag").write_text(varying(DEVICE))
    (tmp_path / "bindings.toml").write_text('tDepth = "device"')
    planar = check_shader(tmp_path / "planar.frag", pack).outcomes
    device = check_shader(tmp_path / "device.frag", pack, tmp_path / "bindings.toml").outcomes
    assert statuses(planar) == ["pass", "not supported", "pass"]
    assert statuses(device) == ["pass", "pass", "not supported"]


def test_circles_may_be_read_instead_of_made(outcomes):
    text = varying().replace("sizeAt(here, focus, focusScale)", "min(abs(texture2D(tCoc, uv).r), 20.0)")
    text = text.replace("sizeAt(there, focus, focusScale)", "min(abs(texture2D(tCoc, at).r), 20.0)")
    text = text.replace("uniform sampler2D tDepth;", "uniform sampler2D tDepth, tCoc;")
    assert statuses(outcomes(text)) == CONSTANTS


def test_depth_in_alpha(outcomes):
    text = varying().replace("texture2D(tDepth, p).r", "texture2D(tDepth, p).a")
    bindings = 'tDepth = { value = "color, depth / far", filter = "nearest" }'
    assert statuses(outcomes(text, bindings)) == CONSTANTS


def test_bindings_give_numbers_by_expressions(outcomes):
    text = mutated(varying(), "uniform float focusDistance, focusScale;", "uniform float uInverse, uStrength;")
    text = mutated(text, "gather(vUv, focusDistance, focusScale)", "gather(vUv, 1.0 / uInverse, uStrength)")
    bindings = 'uInverse = "1 / focus"\nuStrength = "coc_scale / max_blur_size"\n'
    assert statuses(outcomes(text, bindings)) == CONSTANTS
    assert statuses(outcomes(text, bindings.replace("/ max_blur_size", "/ 10")))[:4] != ["pass"] * 4


FAULTS = {
    "the spiral is mirrored": ("sin(angle)", "-sin(angle)"),
    "diameters": ("return abs(coc)", "return 2.0 * abs(coc)"),
    "half a pixel": ("gl_FragCoord.xy * uPixelSize)", "(gl_FragCoord.xy + 0.5) * uPixelSize)"),
    "no limit from behind": ("tapSize = min(tapSize, centerSize * uBehindFactor);", ";"),
    "NaN": ("return color / total;", "return color / (total - total);"),
    "nothing is drawn": ("void main()\n{", "void main()\n{\n    if (uFar > 0.0) discard;"),
    "a tone map": ("return color / total;", "return min(color / total, vec3(0.2));"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_wrong_shaders_fail(outcomes, fault):
    text = GLSL
    assert FAULTS[fault][0] in text
    found = outcomes(text.replace(*FAULTS[fault]))
    assert "fail" in statuses(found)
    assert "error" not in statuses(found)
    assert all(len(outcome.message.splitlines()) == 1 for outcome in found)


REFUSED = {
    "a name is not declared": (
        mutated(GLSL, "return color / total;", "return colour / total;"),
        rf"line {GLSL[: GLSL.index('return color / total;')].count(chr(10)) + 1}: .*colour",
    ),
    "a comma is lost, version of its own": ("// one\nuniform vec2 a\nvoid main() { gl_FragColor = a; }", "line 3: "),
    "an input is no coordinate": (GLSL.replace("out vec4", "flat in int id;\nout vec4"), "int id: is an input"),
    "no output": ("#version 330\nvoid main() { }", "writes no colour"),
    "no main": ("#version 330\nuniform float far;", "has no main"),
    "a uniform of unknown meaning": (
        mutated(GLSL, "return color / total;", "return color / total * uMystery;").replace(
            "out vec4", "uniform float uMystery;\nout vec4"
        ),
        r"uMystery: is a uniform \(float\) that nothing binds; .*focusscale",
    ),
    "a texture of unknown meaning": (GLSL.replace("uDepth", "uThing"), "uThing: is a texture of unknown meaning.*coc"),
    "a scalar pixel size": (
        GLSL.replace("uniform vec2 uPixelSize", "uniform float uPixelSize"),
        "uPixelSize: is float, 1 numbers; allowed are the 2",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_drawn_is_told_once(outcomes, name):
    text, said = REFUSED[name]
    with pytest.raises(InputError, match=said) as raised:
        outcomes(text)
    assert len(str(raised.value).splitlines()) == 1


def test_a_value_in_the_shader_stays(outcomes):
    text = mutated(GLSL, "return color / total;", "return color / total * uMystery;")
    text = text.replace("out vec4", "uniform float uMystery = 1.0;\nout vec4")
    assert statuses(outcomes(text)) == ["pass"] * len(CASES)


@pytest.mark.parametrize(
    ("bindings", "said"),
    [
        ("tDepth =", "bindings: got .*allowed is a TOML file"),
        ('tDeep = "device"', "bindings: tDeep: is not read by the shader; allowed are .*tDepth"),
        ('tDepth = "depht / far"', "bindings: tDepth: got .*allowed are the names color, depth"),
        ('tDepth = "__import__(1)"', "bindings: tDepth: got .*allowed are numbers"),
        ('tDepth = "far"', "bindings: tDepth: got 'far'; allowed is a picture"),
        ('tDepth = { value = "depth", filter = "cubic" }', "bindings: tDepth: filter"),
        ('tDepth = "color, depth, coc"', "bindings: tDepth: got 5 channels; allowed are 4"),
        ('texelSize = "far"', "bindings: texelSize: got 1 numbers; allowed are 2"),
        ('texelSize = "coc"', "bindings: texelSize: got 'coc'; allowed are the names angle_start"),
    ],
)
def test_bad_bindings(outcomes, bindings, said):
    with pytest.raises(InputError, match=said):
        outcomes(varying(), bindings)


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


def test_what_is_not_installed_is_named(pack, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"^shader: needs moderngl, which is not installed: pip install"):
        check_shader(PORTS / "glsl" / "singlepass.frag", pack)


@pytest.mark.parametrize(
    ("name", "content"),
    [("shader.hlsl", b"x"), ("shader.frag", b""), ("shader.frag", b"\xff\xfe"), ("shader.frag", b"a\0b")],
)
def test_files_that_are_no_shaders(pack, tmp_path, name, content):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError, match=r"^shader: got"):
        check_shader(tmp_path / name, pack)


def test_the_command(pack, tmp_path):
    words = ["check", "--pack", str(pack), "--shader", str(PORTS / "glsl" / "singlepass.frag")]
    done = CliRunner().invoke(app, words)
    assert (done.exit_code, done.output.splitlines()[-1]) == (0, "5 pass")
    (tmp_path / "bindings.toml").write_text('uBehindFactor = "3"')
    done = CliRunner().invoke(app, [*words, "--bindings", str(tmp_path / "bindings.toml")])
    assert done.exit_code == 1
    done = CliRunner().invoke(app, ["check", "--pack", str(pack), "--results", str(pack), "--bindings", "x.toml"])
    assert str(done.exception) == "bindings: got a file without --shader; allowed is one with a shader"


def test_a_shader_named_after_another_method_does_not_do_these(outcomes):
    found = outcomes(GLSL, name="poisson.frag")
    assert statuses(found) == ["not supported"] * len(CASES)
    assert found[0].message == "poisson.frag is taken for poisson, by its name; this is singlepass"


@pytest.mark.skipif("REFDOF_SEEDS" not in os.environ, reason="the published listing is in no repository: REFDOF_SEEDS")
def test_the_published_listing_as_it_stands(tmp_path):
    from pathlib import Path

    need("frag", tmp_path)
    article = next(Path(os.environ["REFDOF_SEEDS"]).glob("004*")).read_text()
    listing = mutated(article.split("```")[-2], "vTexCoord", "texCoord")
    (tmp_path / "listing.frag").write_text(listing)
    pack = write(
        tmp_path / "pack",
        [
            Case(f"noise_{width}_{rows}", "singlepass", "noise", (width, height), {"row_order": rows}, rows)
            for width, height in ((320, 240), (317, 239))
            for rows in ("down", "up")
        ],
    )
    found = check_shader(tmp_path / "listing.frag", pack).outcomes
    print(*found, sep="\n")
    assert statuses(found) == ["pass"] * 4
