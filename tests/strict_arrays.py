"""Run every method on hostile scenes, interpreted, with arrays in which a negative index is an error.

Kernels are given views of their arrays that refuse what compiled code would read before an array's first element. Ends
in status 1 with one line per fault.
"""

import importlib
import importlib.util
import sys
from functools import wraps
from types import ModuleType

import numpy as np


class Strict(np.ndarray):
    """An array that refuses negative numbers as indices."""

    def __getitem__(self, key):
        refuse_negative(key)
        return super().__getitem__(key)

    def __setitem__(self, key, value):
        refuse_negative(key)
        super().__setitem__(key, value)


def refuse_negative(key):
    for part in key if isinstance(key, tuple) else (key,):
        ends = (part.start, part.stop) if isinstance(part, slice) else (part,)
        for end in ends:
            if isinstance(end, int | np.integer) and end < 0:
                raise IndexError(f"index {end} is negative")


def strict(value):
    if isinstance(value, np.ndarray):
        return value.view(Strict)
    if isinstance(value, tuple) and hasattr(value, "_fields"):
        return type(value)(*map(strict, value))
    return tuple(map(strict, value)) if isinstance(value, tuple) else value


def strictly(decorate):
    """The decorator `decorate`, for a function whose arrays are strict."""

    def decorated(function):
        inner = decorate(function)

        @wraps(function)
        def call(*arguments):
            return inner(*map(strict, arguments))

        return call

    return decorated


def main() -> int:
    # The decorators are wrapped before anything is decorated: `_jit` is imported into an empty package.
    empty = ModuleType("refdof")
    empty.__path__ = list(importlib.util.find_spec("refdof").submodule_search_locations)
    sys.modules["refdof"] = empty
    policy = importlib.import_module("refdof._jit")
    del sys.modules["refdof"]
    policy.kernel, policy.tile_kernel = strictly(policy.kernel), strictly(policy.tile_kernel)

    import refdof
    from tests.hostile import LENSES, PICTURES, SCENES

    faults = []

    def attempt(what, call, *arguments, **words):
        try:
            call(*arguments, **words)
        except refdof.InputError:
            pass
        except Exception as error:
            faults.append(f"{what}: {type(error).__name__}: {error}")

    for name, module in refdof.METHODS.items():
        few = {"samples": 2} if hasattr(module.Params(), "samples") else {}
        shots = [(what, scene, None) for what, scene in SCENES.items()]
        shots += [(str(lens), SCENES["uv 1e25"], lens) for lens in LENSES]
        for what, scene, lens in shots:
            attempt(f"{name}, {what}", refdof.render, name, scene, lens=lens, **few)
        for what, (color, depth, coc) in PICTURES.items() if hasattr(module, "blur") else ():
            attempt(f"{name}, {what}", module.blur, color.astype(np.float32), depth, coc)
    print("\n".join(faults))
    return bool(faults)


if __name__ == "__main__":
    sys.exit(main())
