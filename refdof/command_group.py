"""The group of all commands: those of the oracle, explanations, lenses, focus and the studio are added when called."""

from collections.abc import Callable
from typing import Any

import typer
from typer.core import TyperGroup
from typer.main import get_group

__all__ = ["Commands"]


class Commands(TyperGroup):
    """Commands by name; who asks for the list of all gets all of them."""

    def list_commands(self, context: Any) -> list[str]:
        """The names of all commands, in the order of the help."""
        self._add_oracle()
        self._add_explain()
        self._add_lens()
        self._add_focus()
        self._add_studio()
        return super().list_commands(context)

    def get_command(self, context: Any, name: str) -> Any:
        """The command of a name, or None."""
        if name == "explain":
            self._add_explain()
        elif name == "lens":
            self._add_lens()
        elif name in ("focus", "pick"):
            self._add_focus()
        elif name == "studio":
            self._add_studio()
        elif name not in self.commands:
            self._add_oracle()
        return super().get_command(context, name)

    def _add_oracle(self) -> None:
        from refdof.oracle_cli import add_commands

        self._add(add_commands)

    def _add_explain(self) -> None:
        from refdof.explain_cli import add_explain

        self._add(add_explain)

    def _add_lens(self) -> None:
        from refdof.lens_cli import add_lens

        self._add(add_lens)

    def _add_focus(self) -> None:
        from refdof.focus_cli import add_focus

        self._add(add_focus)

    def _add_studio(self) -> None:
        from refdof.studio_cli import add_studio

        self._add(add_studio)

    def _add(self, add: Callable[[typer.Typer], None]) -> None:
        more = typer.Typer()
        add(more)
        self.commands = {**self.commands, **get_group(more).commands}
