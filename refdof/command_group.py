"""The group of all commands: each is imported when it is called; the help lists them without any import."""

from importlib import import_module
from typing import Any, NamedTuple

import typer
from typer.core import TyperCommand, TyperGroup
from typer.main import get_group

from refdof.progress import say_at_once

__all__ = ["COMMANDS", "Commands"]


class Home(NamedTuple):
    """Where a command is made, by a function of a module of refdof, and the first line of its help."""

    module: str
    adder: str
    help: str


COMMANDS: dict[str, Home] = {
    "scenes": Home("listing_cli", "add_listing", "List the built-in scenes and what each one shows."),
    "methods": Home(
        "listing_cli",
        "add_listing",
        "List the methods: sources, inputs, texture reads, parameters.",
    ),
    "render": Home("main_cli", "add_main", "Render a scene with one method."),
    "export": Home(
        "main_cli",
        "add_main",
        "Write what a port starts from, and is compared with.",
    ),
    "compare": Home(
        "compare_cli",
        "add_compare",
        "Compare methods with a reference: table, images and report.",
    ),
    "filter": Home(
        "frame_cli",
        "add_frames",
        "Blur a frame made elsewhere: a picture with its depth.",
    ),
    "score": Home("frame_cli", "add_frames", "Score pictures made elsewhere with all metrics."),
    "sweep": Home("sweep_cli", "add_sweep", "Measure methods with many settings: speed against accuracy."),
    "claims": Home("claims_cli", "add_claims", "Hold what the papers claim against what is measured."),
    "stability": Home(
        "stability_cli",
        "add_stability",
        "Run every method at the numerical extremes.",
    ),
    "warm": Home(
        "main_cli",
        "add_main",
        "Compile everything now, so that later runs start at once.",
    ),
    "explain": Home(
        "explain_cli",
        "add_explain",
        "Explain a pixel: every tap, ray, layer and weight that made it.",
    ),
    "golden": Home(
        "oracle_cli",
        "add_commands",
        "Write a pack of cases to check another implementation with.",
    ),
    "check": Home(
        "oracle_cli",
        "add_commands",
        "Check another implementation against a pack.",
    ),
    "diagnose": Home(
        "oracle_cli",
        "add_commands",
        "Say what is wrong with a port of singlepass.",
    ),
    "lens": Home(
        "lens_cli",
        "add_lens",
        "Measure a lens, and draw it with --out.",
    ),
    "pick": Home("focus_cli", "add_focus", "Print the focus point under a pixel, ready for a focus.toml."),
    "focus": Home("focus_cli", "add_focus", "Render frames with a lens that follows focus points."),
    "studio": Home(
        "studio_cli",
        "add_studio",
        "Open a scene in the browser: click to focus.",
    ),
}


class Commands(TyperGroup):
    """Commands by name."""

    def list_commands(self, context: Any) -> list[str]:
        """The names of all commands, in the order of the help."""
        return list(COMMANDS)

    def get_command(self, context: Any, name: str) -> Any:
        """The command of a name, or None; one that was not called yet is its name and help only."""
        if name in self.commands or name not in COMMANDS:
            return self.commands.get(name)
        return TyperCommand(name, help=COMMANDS[name].help, rich_markup_mode=None)

    def resolve_command(self, context: Any, args: list[str]) -> Any:
        """The command that is called, and its arguments."""
        home = COMMANDS.get(args[0]) if args else None
        if home is not None and args[0] not in self.commands:
            more = typer.Typer(rich_markup_mode=None)
            with say_at_once("refdof: starting"):
                module = import_module(f"refdof.{home.module}")
            getattr(module, home.adder)(more)
            self.commands = {**self.commands, **get_group(more).commands}
        return super().resolve_command(context, args)
