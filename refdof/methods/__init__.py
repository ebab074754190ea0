"""Methods: every module in this folder is one published algorithm, with the same door.

A method module has

- a docstring: title sentence, numbered steps, *Departures from the paper*, *References*;
- `CITATION`, a key of papers.bib, and `SOURCE`, its authors and year;
- `INPUTS`, what it needs, and `RECONSTRUCTION`, True where the source was not at hand and steps are pieced together;
- `PAPER`, the fields of `Params` in which the source's text differs from the defaults: the preset "paper";
- `Params`, a frozen dataclass that validates itself and holds what the paper leaves open;
- `PROMISES`, the properties that hold for it, out of `refdof.promises.PROMISES`;
- `render(view, params, trace) -> (H, W, 3) float32`, which asks the view for what it needs and nothing else;
- `fetch_units(params, width, height)`, texture reads per pixel (`refdof.fetches`), unless these depend on the scene;
- if it filters one image, `blur(color, depth, coc, params) -> (H, W, 3)` on plain arrays.

The command line, the report, the tests and the README's table read these modules; there is no other list.
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
