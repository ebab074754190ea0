"""Sphinx extension: pages of methods and of the API, written from docstrings before the build reads its sources.

1. Write `methods/` and `api/`                                     `method_pages`, `api_pages`
2. Show compiled functions as the Python that they were made of     `_show_python`
3. Mend docstrings where plain text means something to RST          `docstrings.escape`
"""

from importlib import import_module
from pathlib import Path
from typing import Any

from extension import api_pages, docstrings, method_pages

__all__ = ["setup"]


def setup(app: Any) -> dict[str, bool]:
    """Connect the steps to Sphinx."""
    app.add_config_value("render_methods", True, "env")  # False: text only, for a quick look
    app.connect("builder-inited", _write_pages)
    app.connect("env-before-read-docs", _show_python)
    app.connect("autodoc-process-docstring", _mend, priority=100)
    app.connect("autodoc-skip-member", _skip)
    return {"parallel_read_safe": True}


def _write_pages(app: Any) -> None:
    source = Path(app.srcdir)
    api_pages.write(source)
    method_pages.write(source, bool(app.config.render_methods))


def _show_python(_app: Any, _env: Any, _names: list[str]) -> None:
    """Replace Numba's dispatchers, which autodoc takes for data. The gallery and the pictures are made by now."""
    for name in [*api_pages.modules(), *method_pages.modules()]:
        module = import_module(name)
        for public in getattr(module, "__all__", ()):
            python = getattr(getattr(module, public), "py_func", None)
            if python is not None:
                setattr(module, public, python)


def _mend(_app: Any, _what: str, _name: str, _object: Any, _options: Any, lines: list[str]) -> None:
    lines[:] = docstrings.escape("\n".join(lines)).split("\n")


def _skip(_app: Any, _what: str, _name: str, value: Any, _skipped: bool, _options: Any) -> bool | None:
    """Leave out the fields of named tuples: the class says what they are."""
    return True if type(value).__name__ == "_tuplegetter" else None
