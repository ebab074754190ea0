"""Plugin: with pytest, one test for each promise of a filter.

A test that takes the fixture `check_promise` runs once for each promise. The marker `refdof_promises` names them;
without it, all of `refdof.testing.PROMISES` are meant::

    @pytest.mark.refdof_promises("constant", "energy", "symmetry")
    def test_my_filter(check_promise):
        check_promise(my_filter, inputs=("color", "depth", "coc"))

pytest loads this module in every run. So it imports nothing that takes time.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from refdof.testing.report import Report

__all__ = ["check_promise", "pytest_configure", "pytest_generate_tests"]

_MARKER = "refdof_promises"


def pytest_configure(config: pytest.Config) -> None:
    """Make the marker known."""
    config.addinivalue_line("markers", f"{_MARKER}(*names): the promises that the fixture check_promise checks")


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Run a test that takes `check_promise` once for each promise."""
    if "check_promise" not in metafunc.fixturenames:
        return
    from refdof._check import InputError
    from refdof.testing.promises import chosen

    marker = metafunc.definition.get_closest_marker(_MARKER)
    try:
        names = chosen(None if marker is None else marker.args)
    except InputError as error:
        raise pytest.UsageError(f"{metafunc.definition.nodeid}: {error}") from None
    metafunc.parametrize("check_promise", names, indirect=True)


@pytest.fixture
def check_promise(request: pytest.FixtureRequest) -> "Callable[..., Report]":
    """`refdof.testing.check_properties` with one promise; it takes the function and the same words."""

    def check(function: Callable[..., Any], **words: Any) -> "Report":
        __tracebackhide__ = True
        from refdof.testing.check import check_properties

        return check_properties(function, (request.param,), **words)

    return check
