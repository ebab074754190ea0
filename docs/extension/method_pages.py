"""Method pages: what a method's docstring, its `Params` and its record say, and a picture made for the page.

1. Render one scene with the reference and every method, stages recorded    `_pictures`
2. Write a page for each method, and a table of all                         `_page`, `_table`
3. Measure what each makes of a small light                                 `_kernels`

Nothing on these pages is written by hand, so nothing on them can grow old.
"""

import re
import sys
from dataclasses import fields
from importlib import import_module
from inspect import isclass, isroutine
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
from PIL import Image

import refdof
from extension.docstrings import entries, escape, first_sentence, take_apart
from refdof.kernel_shape import kernel_shape
from refdof.methods._contract import BASES

__all__ = ["SCENE", "SIZE", "modules", "write"]

SCENE, SIZE, SAMPLES = "fence", (320, 240), 256
_GAP = 6  # px of white between the pictures
_GAIN = 4.0  # of the error
_LIGHTS = (1, 2, 4, 8)  # px


class Shown(NamedTuple):
    """What the rendering of a method gave: scores, and the shape and type of each stage."""

    psnr: float
    flip: float
    stages: dict[str, str]


def modules() -> list[str]:
    """The modules whose docstrings make the pages."""
    return [_source(module).__name__ for module in refdof.METHODS.values()]


def write(source: Path, render: bool = True) -> None:
    """Write `methods/` under the folder of the sources; without `render`, no pictures, scores and stages."""
    folder = source / "methods"
    folder.mkdir(exist_ok=True)
    shown, floor = _pictures(folder) if render else ({}, np.inf)
    for name, module in refdof.METHODS.items():
        (folder / f"{name}.rst").write_text(_page(name, module, shown.get(name)))
    (folder / "table.inc").write_text(_table(shown, floor))
    (folder / "kernels.inc").write_text(_kernels() if render else "")


def _source(module: ModuleType) -> ModuleType:
    """The module that holds the docstring: the one where `render` is written."""
    return sys.modules[module.render.__module__]


def _pictures(folder: Path) -> tuple[dict[str, Shown], float]:
    """Render every method; save reference, picture and error side by side. Returns scores, and the floor [dB]."""
    scene = refdof.load_scene(SCENE)
    camera = scene.camera.with_size(SIZE)
    truth = refdof.reference(scene, camera, samples=SAMPLES)
    shown = {}
    for name in refdof.METHODS:
        result = refdof.render(name, scene, camera, stages=True)
        error = _GAIN * np.abs(_encode(result.image) - _encode(truth.image))
        white = np.ones((SIZE[1], _GAP, 3))
        row = [_encode(truth.image), white, _encode(result.image), white, np.minimum(error, 1.0)]
        Image.fromarray(np.rint(255.0 * np.concatenate(row, axis=1)).astype(np.uint8)).save(folder / f"{name}.png")
        stages = {key: f"{_shape(np.asarray(value))} {np.asarray(value).dtype}" for key, value in result.stages.items()}
        psnr, flip = (score(truth.image, result.image) for score in (refdof.metrics.psnr, refdof.metrics.flip))
        shown[name] = Shown(psnr, flip, stages)
    return shown, truth.noise_floor_psnr


def _encode(linear: Any) -> Any:
    """The display image: clipped, with the sRGB curve."""
    light = np.clip(linear, 0.0, 1.0)
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1.0 / 2.4) - 0.055)


def _shape(value: Any) -> str:
    return "(" + ", ".join(str(size) for size in value.shape) + ("," if value.ndim == 1 else "") + ")"


def _page(name: str, module: ModuleType, shown: Shown | None) -> str:
    """The page of one method."""
    parts = take_apart(_source(module).__doc__ or "")
    record = module.METHOD
    what = parts.title.partition(": ")[2]
    steps = [p for p in parts.paragraphs if p.startswith("1. ")]
    stages = [p for p in parts.paragraphs if p.startswith("Stages")]
    others = [p for p in parts.paragraphs if p not in steps + stages]
    lines = [name, "=" * len(name), "", escape(what[:1].upper() + what[1:]), ""]
    if shown is not None:
        lines += [
            f".. figure:: {name}.png",
            f"   :alt: The scene {SCENE}: reference, {name}, error",
            "",
            f"   The scene ``{SCENE}``: reference, ``{name}``, and {_GAIN:g} times the error.",
            f"   PSNR {shown.psnr:.2f} dB, FLIP {shown.flip:.4f}, at {SIZE[0]} x {SIZE[1]} px.",
            "",
        ]
    lines += _facts(record)
    lines += [*_section("Steps"), *(escape(text) + "\n" for text in [*steps, *others])]
    lines += _section("Known defects")
    lines += [f"- {escape(text)}" for text in record.known_defects] or ["None beyond the departures below."]
    lines += ["", *_section("Parameters"), *_parameters(module)]
    lines += _section("Stages")
    lines += [f"Recorded by ``refdof.render({name!r}, scene, stages=True).stages``.", ""]
    lines += [escape(text) + "\n" for text in stages]
    if shown is not None and shown.stages:
        lines += [f"As recorded for the picture above, {SIZE[0]} x {SIZE[1]} px:", ""]
        lines += _list_table(["stage", "shape and type"], [[f"``{k}``", f"``{v}``"] for k, v in shown.stages.items()])
    lines += [*_section("Promises"), *_promises(record)]
    for heading, text in parts.sections.items():
        if heading != "References":
            lines += [*_section(heading), escape(text), ""]
    lines += _doors(name, module)
    if "References" in parts.sections:
        lines += [*_section("References"), escape(parts.sections["References"]), ""]
    return "\n".join(lines)


def _facts(record: Any) -> list[str]:
    reads = record.texture_reads
    width, height = refdof.load_scene(SCENE).camera.size
    count = None if reads is None else reads(record.params(), width, height)
    rows = [
        ["Source", f"{record.source} ({record.basis}: {BASES[record.basis]})"],
        ["Kind", f"{record.kind}: {_registry('KINDS', record)[record.kind]}"],
        ["Needs", ", ".join(record.inputs)],
        [
            "Texture reads",
            "depend on the scene" if count is None else f"{count:.4g} per pixel at {width} x {height} px",
        ],
    ]
    return [".. list-table::", "   :class: method-facts", "", *_rows(rows), ""]


def _registry(name: str, record: Any) -> dict[str, str]:
    """A dict of the module that defines records: what kinds and promises mean."""
    found: dict[str, str] = getattr(sys.modules[type(record).__module__], name)
    return found


def _parameters(module: ModuleType) -> list[str]:
    """Every field of `Params`: default, the paper's value where it differs, meaning."""
    params, paper = module.METHOD.params(), module.METHOD.paper
    names = [field.name for field in fields(params)]
    if not names:
        return ["None.", ""]
    told = {name: entry for entry in entries(type(params).__doc__ or "") for name in entry.names}
    lines = ["Each with its default, the preset ``best``. Where the preset ``paper`` differs, its value follows.", ""]
    for name in names:
        entry = told[name]
        value = f", paper: ``{paper[name]!r}``" if name in paper else ""
        kind = re.sub(r"one of `([\w.]+)`", lambda found: _choices(found[1], _source(module)), entry.kind)
        text = f"{kind}. {entry.text}".strip()
        lines += [f"``{name}`` = ``{getattr(params, name)!r}``{value}", f"   {escape(text)}", ""]
    return lines


def _choices(name: str, module: ModuleType) -> str:
    """The words that a parameter may have, from the constant `name` of the method's or another module."""
    where, _, constant = name.rpartition(".")
    words = getattr(import_module(where) if where else module, constant)
    return "one of " + ", ".join(f'"{word}"' for word in words)


def _promises(record: Any) -> list[str]:
    """What holds for the method, and what does not."""
    rows = [
        [f"**{name}**", "yes" if name in record.promises else "no", escape(meaning)]
        for name, meaning in _registry("PROMISES", record).items()
    ]
    text = 'Properties that the tests check in one scene that has everything at once. "No" means: not claimed.'
    return [text, "", *_list_table(["promise", "given", "meaning"], rows, "15 10 75")]


def _doors(name: str, module: ModuleType) -> list[str]:
    """How to call it, and the functions and classes of its module."""
    lines = [
        *_section("Use"),
        ".. code-block:: bash",
        "",
        f"   refdof compare fence --methods {name}",
        f"   refdof render fence --method {name} -o {name}.png",
        "",
        f".. currentmodule:: {_source(module).__name__}",
        "",
    ]
    for public in _source(module).__all__:
        value = getattr(_source(module), public)
        value = getattr(value, "py_func", value)
        if public != "render" and (isroutine(value) or isclass(value)) and first_sentence(value.__doc__):
            lines += [f".. auto{'class' if isclass(value) else 'function'}:: {public}", ""]
    return lines


def _table(shown: dict[str, Shown], floor: float) -> str:
    """All methods, as an RST table to be included."""
    head = ["method", "source", "kind", *(["PSNR [dB]", "FLIP"] if shown else [])]
    rows = []
    for name, module in refdof.METHODS.items():
        record = module.METHOD
        scores = [f"{shown[name].psnr:.2f}", f"{shown[name].flip:.4f}"] if shown else []
        source = record.origin
        rows.append([f":doc:`{name} </methods/{name}>`", source, record.kind, *scores])
    text = (
        f"Scores: the scene ``{SCENE}`` at {SIZE[0]} x {SIZE[1]} px, default parameters, against a reference with "
        f"{SAMPLES} samples per pixel and a noise floor of {floor:.2f} dB."
    )
    return "\n".join([*_list_table(head, rows), *([text] if shown else []), ""])


def _kernels() -> str:
    """Kernel radius over the disc's, behind and in front of focus, and the energy of lights, as an RST table."""
    rows = []
    for name in refdof.METHODS:
        radii = [kernel_shape(name, in_front=in_front).radius for in_front in (False, True)]
        energies = [kernel_shape(name, light=light).energy for light in _LIGHTS]
        rows.append([f"``{name}``", *(f"{value:.3f}" for value in (*radii, *energies))])
    head = ["method", "radius, behind", "radius, in front", *(f"light of {light} px" for light in _LIGHTS)]
    return "\n".join(_list_table(head, rows))


def _section(heading: str) -> list[str]:
    return ["", heading, "-" * len(heading), ""]


def _list_table(head: list[str], rows: list[list[str]], widths: str = "auto") -> list[str]:
    return [".. list-table::", "   :header-rows: 1", f"   :widths: {widths}", "", *_rows([head, *rows]), ""]


def _rows(rows: list[list[str]]) -> list[str]:
    lines = []
    for row in rows:
        lines += [f"   {'* -' if k == 0 else '  -'} {cell}" for k, cell in enumerate(row)]
    return lines
