"""No option is silently ignored: with what leaves it without effect it is refused, in one line of one form."""

import re

import pytest
import typer
from typer.testing import CliRunner

from refdof import InputError
from refdof.cli import app
from refdof.command_group import COMMANDS

pytestmark = pytest.mark.fast

RENDER = ["render", "fence", "--method", "singlepass", "--size", "9x9", "-o", "a.npy"]
OF_MIPMAP = ["render", "fence", "--method", "mipmap", "--size", "9x9", "-o", "a.npy", "--stages", "b"]
OF_POISSON = ["export", "fence", "--methods", "poisson,mipmap", "--size", "9x9", "--out", "a"]
EXPLAIN = ["explain", "CASE", "--pixel", "0,0"]
FRAME, A_LENS = ["--color", "a.npy"], ["--fov", "40", "--focus", "3", "--lens-radius", "1"]
RESULTS, IMPL, SHADER = ["--results", "."], ["--impl", "x {case} {out}"], ["--shader", "x.frag"]

SHOTS = (RENDER, ["export", "fence", "--out", "a"], ["compare", "fence"], ["sweep", "fence"])
THIN_SHOTS = (
    ["explain", "fence", "--method", "mipmap", "--pixel", "1,1"],
    ["focus", "fence", "--points", "no.toml", "--method", "mipmap", "--out", "a"],
)

# A command line, the option that it would ignore, its value (None: a flag), and why.
REFUSED = [
    (RENDER, "steps", "1,4", "without --stages"),
    (RENDER, "pixel", "1,4", "without --stages"),
    (OF_MIPMAP, "steps", "1,4", "with methods that record none (mipmap)"),
    (OF_MIPMAP, "pixel", "1,4", "with methods that record none (mipmap)"),
    (["export", "fence", "--methods", "mipmap", "--out", "a"], "steps", "4", "with methods that record none (mipmap)"),
    (["compare", "fence", "--json"], "wide", None, "with --json"),
    (OF_POISSON, "pixel", "1,4", "with methods that record none (poisson, mipmap)"),
    *((words, option, value, "without --lens")
      for words in SHOTS
      for option, value in (("wavelengths", "7"), ("no-vignetting", None))),
    *((words, option, value, why) for words in (*SHOTS, *THIN_SHOTS) for option, value, why in (
        ("focal-length", "50", "without --f-number or --sensor"),
        ("sensor", "24", "without --f-number or --focal-length"),
    )),
    *((words, *one) for words in SHOTS for one in (
        ("f-number", "2", "without --lens, --focal-length or --sensor"),
        ("units", "cm", "without --f-number or --lens"),
    )),
    *((words, *one) for words in THIN_SHOTS for one in (
        ("f-number", "2", "without --focal-length or --sensor"),
        ("units", "cm", "without --f-number"),
    )),
    *((["pick", "fence", "--pixel", "1,1"], *one) for one in (
        ("focal-length", "50", "without --sensor"),
        ("sensor", "24", "without --focal-length"),
    )),
    *(([*words, "--lens", "biconvex"], option, value, "with --lens, which has its own")
      for words in SHOTS for option, value in (("focal-length", "50"), ("sensor", "24"))),
    *(([*words, "--focal-length", "50", "--sensor", "24"], "fov", "30",
       "with --focal-length and --sensor, which set it") for words in SHOTS),
    *(([*words, "--lens", "biconvex"], "fov", "30", "with --lens, which sets it")
      for words in SHOTS),
    *(([*words, "--focus-points", "x.toml"], option, value, why) for words in (
        RENDER, ["export", "fence", "--methods", "mipmap", "--out", "a"], ["compare", "fence", "--out", "a"],
        ["sweep", "fence", "--out", "a"],
    ) for option, value, why in (
        ("focus", "3", "with --focus-points, which set it"),
        ("lens", "biconvex", "with --focus-points, which need a thin lens"),
    )),
    *(([command, "fence"], "max-samples", "64", "without --tolerance") for command in ("compare", "sweep")),
    *((["sweep", "--preset", "tradeoff"], option, value, "with --preset, which takes all")
      for option, value in (("method", "mipmap"), ("vary", "delta=0,1"))),
    *((["sweep", "fence", "--vary", f"{option.replace('-', '_')}={value}"], option, value,
       f"with --vary {option.replace('-', '_')}, which sets it")
      for option, value in (("size", "20x20"), ("lens-radius", "2"), ("focus", "2"))),
    (["filter", *FRAME, "--json"], "wide", None, "with --json"),
    (["score", "a.npy", "b.npy", "--json"], "wide", None, "with --json"),
    (["score", "a.npy", "b.npy", "--variance", "c.npy"], "second", "d.npy", "with --variance"),
    *((["filter", *FRAME, "--coc", "c.npy"], option, "2", "with --coc, which replaces it")
      for option in ("fov", "focus", "lens-radius", "f-number", "sensor", "units")),
    *((["filter", *FRAME, *A_LENS], option, "2", "with --lens-radius") for option in ("sensor", "units")),
    *(([command, "fence", "--tolerance", "0.1"], "samples", "64", "with --tolerance, which replaces it")
      for command in ("compare", "sweep")),
    *((EXPLAIN, name, value, "with a case, which has its own") for name, value in (
        ("method", "poisson"), ("set", "rad_scale=1"), ("preset", "paper"), ("size", "9x9"), ("lens-radius", "0"),
        ("focus", "0"), ("eye", "0,0,9"), ("target", "0,1,0"), ("up", "0,0,1"), ("fov", "30"),
        ("limit", "pixels=9"), ("no-file-camera", None),
        ("shading", "unlit"), ("background", "0,0,0"),
    )),
    *((["check", "--pack", ".", *how], "given", "size", "without --impl") for how in (RESULTS, SHADER)),
    *(([command, "--pack", ".", *how], "bindings", "x.toml", "without --shader")
      for command in ("check", "diagnose") for how in (RESULTS, IMPL)),
    *(([command, "--pack", ".", *RESULTS], "timeout", "1", "with --results, which runs nothing")
      for command in ("check", "diagnose")),
]  # fmt: skip

# Two values for one thing, and what is said.
TWICE = [
    ([*RENDER, "--set", "rad_scale=1", "--set", "rad_scale=2"], "rad_scale: got 1 and 2; allowed is one value"),
    (["render", "fence", "--method", "accumulation", "-o", "a.npy", "--seed", "1", "--set", "seed=2"], "seed: got 2"),
    (["compare", "fence", "--set", "mipmap.delta=1", "--set", "mipmap.delta=2"], "mipmap.delta: got 1 and 2"),
]

# Options that a command heeds whatever else is given.
SEEN = "shading background eye target up"
SHOT = f"{SEEN} size lens-radius"
HEEDED = {
    "scenes": "json",
    "methods": "json",
    "render": f"method output set preset {SHOT} limit no-file-camera focus-points seed samples stages threads json",
    "export": f"out methods set layers {SHOT} limit no-file-camera focus-points threads json",
    "compare": f"methods out crop motion set preset {SHOT} limit no-file-camera focus-points seed tolerance "
    "scheduler workers threads json",
    "sweep": f"preset budget quality predict out set {SEEN} limit "
    "no-file-camera focus-points seed tolerance scheduler workers threads json",
    "filter": "color depth depth-kind near far coc reference methods out crop set preset threads json",
    "score": "variance threads json",
    "claims": "source only threads json",
    "stability": "methods only html threads json",
    "warm": "",
    "golden": "out level methods update exr threads json",
    "check": "pack results impl shader only shard not-supported waivers html json junit",
    "diagnose": "pack results impl shader case json",
    "explain": "pixel stage out threads json",
    "lens": "focus out threads json",
    "studio": "port no-open limit no-file-camera threads",
    "pick": "pixel frame size eye target up fov limit no-file-camera name json",
    "focus": f"points method out frames format set preset {SHOT} limit no-file-camera fov threads json",
}


def command_of(name):
    _, command, _ = typer.main.get_command(app).resolve_command(None, [name])
    return command


def options_of(name):
    return {word[2:] for part in command_of(name).params for word in part.opts if word.startswith("--")}


def named(text, command):
    """The options that a text names, but for those of another command, in backquotes after it, which are looked up."""
    for other, words in re.findall(r"`refdof ([a-z]+)\b([^`]*)`", text):
        assert set(re.findall(r"--([a-z][a-z-]*)", words)) <= options_of(other)
    return set(re.findall(r"--([a-z][a-z-]*)", re.sub(r"`refdof [^`]*`", "", text)))


@pytest.fixture
def told(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case").mkdir()
    (tmp_path / "case" / "case.json").write_text("{}")

    def run(words):
        words = ["case" if word == "CASE" else word for word in words]
        error = CliRunner().invoke(app, words, standalone_mode=False).exception
        assert isinstance(error, InputError)
        return str(error)

    return run


@pytest.mark.parametrize(("words", "option", "value", "why"), REFUSED, ids=lambda part: str(part)[:40])
def test_options_without_effect_are_refused(told, tmp_path, words, option, value, why):
    said = told([*words, f"--{option}", *([] if value is None else [value])])
    number = value is None or (value.replace(".", "").isdigit() and option not in ("steps", "pixel"))
    value = "True" if value is None else value
    shown = rf"\[?'?{re.escape(value)}(?:\.0)?'?\]?" if number else rf"\[?'{re.escape(value)}'\]?"
    assert re.fullmatch(rf"{option}: got {shown} {re.escape(why)}; allowed with[^;]*", said)
    assert named(said, words[0]) <= options_of(words[0])
    assert [path.name for path in tmp_path.iterdir()] == ["case"]


@pytest.mark.parametrize(("words", "said"), TWICE)
def test_two_values_for_one_thing_are_refused(told, words, said):
    assert told(words).startswith(said)


def test_every_option_is_heeded_or_refused():
    """So that a new option comes into one of the tables."""
    for name in COMMANDS:
        options = options_of(name)
        sometimes = {option for words, option, *_ in REFUSED if words[0] == name}
        assert options - {"help"} == sometimes | set(HEEDED[name].split()), name
        assert not sometimes & set(HEEDED[name].split()), name


@pytest.mark.parametrize("name", COMMANDS)
def test_help_names_the_options_of_its_command_only(name):
    command = command_of(name)
    for text in (command.help, *(getattr(part, "help", None) or "" for part in command.params)):
        assert named(text, name) <= options_of(name), text


def test_what_the_options_need_is_accepted(told):
    """Then the next thing is complained of: nothing is there."""
    assert told(["check", "--pack", "no", *IMPL, "--given", "size", "--timeout", "1"]).startswith("pack: ")
    assert told(["diagnose", "--pack", "no", *IMPL, "--timeout", "1"]).startswith("pack: ")
    assert told(["check", "--pack", "no", "--shader", "no.frag", "--bindings", "x"]).startswith("shader: ")
    assert told(["compare", "no", "--tolerance", "0.1", "--max-samples", "64"]).startswith("scene: ")
    assert told([*EXPLAIN[:1], "no", *EXPLAIN[2:], "--method", "mipmap", "--preset", "paper"]).startswith("scene: ")
    assert told([*EXPLAIN[:1], "no", *EXPLAIN[2:], "--method", "mipmap", "--preset", ""]).startswith("preset: ")
