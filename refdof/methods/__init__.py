"""Methods: every module or folder in this folder is one published algorithm, with the same door.

A folder holds everything that only its method uses: `method` is its module, whose names the folder gives on.

A method module has

- a docstring: title sentence, numbered steps, *Departures from the paper*, *References*;
- `Params`, a frozen dataclass that validates itself and holds what the paper leaves open;
- `METHOD`, its record: source, kind, inputs, promises, texture reads, known defects
  (`refdof.methods._contract.Method`);
- `render(view, params, recorder) -> (H, W, 3) float32`, which asks the view for what it needs and nothing else;
- if it filters one image, `blur(color, depth, coc, params) -> (H, W, 3)` on plain arrays.

The command line, the report, the tests and the README's table read the records; there is no other list.
`make new-method NAME=...` writes a module that does all this.
"""

from importlib import import_module
from pkgutil import iter_modules
from types import ModuleType

__all__ = ["METHODS"]

METHODS: dict[str, ModuleType] = {
    found.name: import_module(f"{__name__}.{found.name}")
    for found in iter_modules(__path__)
    if not found.name.startswith("_")
}
