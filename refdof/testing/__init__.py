"""Testing: the properties of a blur through a lens, for any Python function that filters a picture by its depth.

`check_properties` runs them. With pytest, the fixture `check_promise` of `refdof.testing.plugin` makes a test of each.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from refdof.testing.check import check_properties
    from refdof.testing.promises import PROMISES
    from refdof.testing.report import Failure, PropertyError, Report

__all__ = ["PROMISES", "Failure", "PropertyError", "Report", "check_properties"]

# pytest loads the plugin in every run, also of people who do not use it: all else waits until somebody asks.
_HOMES = {
    "PROMISES": "promises",
    "Failure": "report",
    "PropertyError": "report",
    "Report": "report",
    "check_properties": "check",
}


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module 'refdof.testing' has no attribute {name!r}")
    globals()[name] = value = getattr(import_module(f"refdof.testing.{_HOMES[name]}"), name)
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
