"""Shaders in GLSL: right ones pass in every dialect, and wrong ones fail."""

import os

import pytest
from typer.testing import CliRunner

from refdof import InputError
from refdof.cli import app
from refdof.methods.singlepass.params import DEPTH_FILTERS
from refdof.oracle import check_shader
from refdof.oracle.cases import Case
from tests.oracle.shaders.cases import (
    CASES,
    CONSTANTS,
    CORE_STATUSES,
    DEVICE,
    GLSL,
    PORTS,
    core_statuses,
    function_only,
    need,
    statuses,
    varying,
)
from tests.packs import pack_of
from tests.ports.cases import mutated

pytestmark = pytest.mark.gl

SUFFIX = "frag"


def test_the_port_passes_the_core_pack(tmp_path):
    assert core_statuses(PORTS / "glsl" / "singlepass.frag", tmp_path) == CORE_STATUSES


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


def test_filters_of_depth(tmp_path):
    """A filter blends what the texture holds: depth itself, or what is linear in its inverse, as a z-buffer."""
    need("frag", tmp_path)
    filters = [Case(word, "singlepass", "bar", (24, 18), {"depth_filter": word}) for word in DEPTH_FILTERS]
    pack = pack_of(filters, tmp_path / "pack")
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


def test_a_value_in_the_shader_stays(outcomes):
    text = mutated(GLSL, "return color / total;", "return color / total * uMystery;")
    text = text.replace("out vec4", "uniform float uMystery = 1.0;\nout vec4")
    assert statuses(outcomes(text)) == ["pass"] * len(CASES)


def test_the_command(pack, tmp_path):
    words = ["check", "--pack", str(pack), "--shader", str(PORTS / "glsl" / "singlepass.frag")]
    done = CliRunner().invoke(app, words)
    assert (done.exit_code, done.output.splitlines()[-1]) == (0, "5 pass")
    (tmp_path / "bindings.toml").write_text('uBehindFactor = "3"')
    done = CliRunner().invoke(app, [*words, "--bindings", str(tmp_path / "bindings.toml")])
    assert done.exit_code == 1
    done = CliRunner().invoke(app, ["check", "--pack", str(pack), "--results", str(pack), "--bindings", "x.toml"])
    assert str(done.exception) == "bindings: got 'x.toml' without --shader; allowed with it"


def test_a_shader_named_after_another_method_does_not_do_these(outcomes):
    found = outcomes(GLSL, stem="poisson")
    assert statuses(found) == ["not supported"] * len(CASES)
    assert found[0].message == "poisson.frag is taken for poisson, by its name; this is singlepass"


@pytest.mark.skipif("REFDOF_SEEDS" not in os.environ, reason="the published listing is in no repository: REFDOF_SEEDS")
def test_the_published_listing_as_it_stands(tmp_path):
    from pathlib import Path

    need("frag", tmp_path)
    article = next(Path(os.environ["REFDOF_SEEDS"]).glob("004*")).read_text()
    listing = mutated(article.split("```")[-2], "vTexCoord", "texCoord")
    (tmp_path / "listing.frag").write_text(listing)
    cases = [
        Case(f"noise_{width}_{rows}", "singlepass", "noise", (width, height), {"row_order": rows}, rows)
        for width, height in ((320, 240), (317, 239))
        for rows in ("down", "up")
    ]
    pack = pack_of(cases, tmp_path / "pack")
    found = check_shader(tmp_path / "listing.frag", pack).outcomes
    print(*found, sep="\n")
    assert statuses(found) == ["pass"] * 4
