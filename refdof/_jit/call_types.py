"""Call types: what a call of a built-in function gives is worked out once for each kind of arguments.

To type `a + b` Numba tries every meaning that the operator has anywhere, those of text and lists, too, for each place
in each function anew: a tenth of the time that compiling takes. Here the answer is kept for as long as the process
runs. It depends on the function with all its meanings, on the types and on the flags of compilation, which are the key.

Numba has no public door for this. Where its insides are not as expected, `remembered` does nothing.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from numba.core import types
from numba.core.targetconfig import ConfigStack

__all__ = ["remembered"]

_Base: Any = getattr(types, "BaseFunction", None)
_plain: Any = vars(_Base).get("get_call_type") if _Base is not None else None
_known: dict[Any, list[tuple[Any, Any, Any]]] = {}  # flags, signature and the function that knows how to lower it


def _call_type(function: Any, context: Any, args: Any, kws: Any) -> Any:
    top = ConfigStack.top_or_none()
    flags = None if top is None else top._values
    answers = _known.setdefault((function, context, tuple(args), tuple(kws.items())), [])
    for with_flags, signature, first in answers:
        if with_flags == flags:
            function._impl_keys[signature.args] = first._impl_keys[signature.args]
            return signature
    signature = _plain(function, context, args, kws)
    answers.append((None if flags is None else dict(flags), signature, function))
    return signature


@contextmanager
def remembered() -> Iterator[None]:
    """In this block calls are typed once. Call with Numba's compiler lock held, as compiling does."""
    if _plain is None or _Base.get_call_type is not _plain:  # within another such block; or another Numba
        yield
        return
    _Base.get_call_type = _call_type
    try:
        yield
    finally:
        _Base.get_call_type = _plain
