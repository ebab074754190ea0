"""The commands `refdof scenes` and `refdof methods`: what there is."""

import json
import textwrap
from collections.abc import Mapping
from typing import Any

import typer

from refdof.methods import METHODS
from refdof.methods._contract import facts_of
from refdof.options import DEFAULT_SCENE, AsJson
from refdof.report.rows import plain
from refdof.scene.builtin import SCENES, shot_of

__all__ = ["add_listing", "in_words"]


def add_listing(app: typer.Typer) -> None:
    """Give `app` the commands."""
    app.command()(scenes)
    app.command()(methods)


def scenes(as_json: AsJson = False) -> None:
    """List the built-in scenes and what each one shows."""
    shots = {name: shot_of(name) for name in SCENES}
    rows = [{"scene": n, "title": s.title, "shows": s.shows, "inspired_by": s.inspired_by} for n, s in shots.items()]
    if as_json:
        print(json.dumps(rows, indent=2))
    else:
        _print_columns([[row["scene"], row["shows"]] for row in rows])


def methods(as_json: AsJson = False) -> None:
    """List the methods: sources, inputs, texture reads, parameters.

    It also tells known defects, where a method's paper sets other parameters, and what a method makes of a small light
    where all is blurred by a circle of 8 px: its RMS radius over the disc's, and its energy over the light's own.

    Texture reads are counted for the image size of the default scene.
    """
    rows, texts = [], []
    size = shot_of(DEFAULT_SCENE).camera.size
    for name, module in METHODS.items():
        method, title = module.METHOD, _title(module)
        rows.append({"method": name, "title": title, **facts_of(method, *size)})
        reads = method.reads_in_words(*size)
        about = [
            f"{title} {method.source} ({method.basis}).",
            f"Needs {', '.join(method.inputs)}; {reads}.",
            in_words(method.defaults()),
        ]
        if method.kernel:
            radius, energy = method.kernel
            about.append(f"A light of 1 px, circles of 8: radius {radius:.2f} of the disc's, energy {energy:.2f}.")
        if method.paper:
            about.append(f"paper: {in_words(method.paper)}")
        about += [f"- {defect}" for defect in method.known_defects]
        texts.append((name, about))
    if as_json:
        print(json.dumps(plain(rows), indent=2))
        return
    for name, about in texts:
        print(name)
        for line in about:
            width = 130 if line.startswith("- ") else 100  # a known defect is a line
            print(textwrap.fill(line, width, initial_indent="    ", subsequent_indent="        "))


def _title(module: Any) -> str:
    return str(module.__doc__).split("\n", 1)[0]


def in_words(values: Mapping[str, Any]) -> str:
    """Names and values in a line."""
    return ", ".join(f"{key}={value}" for key, value in values.items())


def _print_columns(rows: list[list[str]]) -> None:
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    for row in rows:
        print("  ".join(text.ljust(width) for text, width in zip(row, widths, strict=True)).rstrip())
