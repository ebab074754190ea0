"""The files of the studio's page. Its view is one module, in parts: a page and a notebook show the same."""

from importlib.resources import files

__all__ = ["page_file", "view_module"]


def page_file(name: str) -> str:
    """The text of a file of the page."""
    return (files(__name__) / name).read_text(encoding="utf-8")


def view_module() -> str:
    """The ES module of the view: its parts, in the order of their names."""
    parts = sorted((part for part in files(__name__).iterdir() if part.name.startswith("view_")), key=lambda p: p.name)
    return "\n".join(part.read_text(encoding="utf-8") for part in parts)
