"""The section of docs/stability.md about formulas: one table, then each formula with its two forms."""

import textwrap
from collections.abc import Iterable, Mapping
from typing import Any

from formula import Formula, source_of

__all__ = ["section"]

_UNIT = 2.0**-23
_INTRODUCTION = """Some formulas of depth of field take the difference of two numbers that are nearly the same. In
float32, in which shaders work, little is left of it. Each is here in the form in which papers and engines have it, with
what that loses, and in a form that keeps its digits, in Python and in GLSL. Take the second one. Inputs are
finite. At infinity take the limit beforehand, since `inf / inf` is no number: the circle is `scale / focus` for an
infinite depth, and `-scale / depth` for an infinite focus.

Errors are counted in units of 2^-23 of the true value: the last place of float32, or half of it. At 8e6 nothing is
right. Both forms were taken in float32 for {count} inputs that are even over the logarithm, and compared with the
naive form in 50 digits. The last column is the error of refdof's own function as a share of the value: most work in
float64. `python benchmarks/cancellation.py` makes this section; its inputs have one seed."""
_HELPERS = """`product_plus(a, b, c)` is a b + c without the rounding of the product: right where the sum cancels,
else within a unit. In NumPy it is `(a.astype(float64) * b + c).astype(float32)` for float32; other
functions are NumPy's. Where `fma` is a true one it does as well. It need not be: Mesa's software
renderer rounds twice. The helper needs `precise`, GLSL version 400. Shaders may divide and take roots
with errors of 2.5 units, and some have a `log`, an `exp` and an `asin` of few digits. The others keep
digits where these lose them:"""


def section(formulas: Iterable[Formula], figures: Mapping[str, Any], helpers: str, count: int) -> str:
    """Markdown of all formulas from their figures, as `cancellation.measure` gives them."""
    formulas = list(formulas)
    table = [
        "| formula | naive: worst | median | below: worst | median | refdof itself |",
        "|---|---:|---:|---:|---:|---:|",
        *(_row(formula, figures[formula.name]) for formula in formulas),
    ]
    parts = ["## Formulas", *map(_wrapped, _INTRODUCTION.format(count=count).split("\n\n")), "\n".join(table)]
    parts += [_wrapped(_HELPERS), f"```glsl\n{helpers}\n```"]
    return "\n\n".join([*parts, *(_formula(formula, figures[formula.name]) for formula in formulas)])


def _row(formula: Formula, figures: Mapping[str, Any]) -> str:
    naive, ours, code = (figures.get(name) for name in ("naive", "ours", "code"))
    link = formula.title.lower().replace(" ", "-").replace("'", "")
    numbers = [_units(part[which]) for part in (naive, ours) for which in ("worst", "median")]  # type: ignore[index]
    return f"| [{formula.title}](#{link}) | {' | '.join(numbers)} | {_share(code['worst']) if code else '-'} |"


def _formula(formula: Formula, figures: Mapping[str, Any]) -> str:
    naive, ours = figures["naive"], figures["ours"]
    place = ", ".join(f"{name} {value:.9g}" for name, value in zip(formula.arguments, naive["at"], strict=True))
    lost = f" {naive['not finite']} results are no finite number." if naive["not finite"] else ""
    median = _units(naive["median"])
    allowed = f"Its roundings allow {formula.bound:g}, and {formula.shader_bound:g} in a shader."
    return f"""### {formula.title}

{formula.legend}

```python
{source_of(formula.naive, formula.name + "_naive")}
```

{_wrapped(f"{formula.fails} Measured: up to {_units(naive['worst'])} units, at {place}; the median is {median}.{lost}")}

```python
{source_of(formula.ours, formula.name)}
```

```glsl
{formula.glsl}
```

{_wrapped(f"Measured: up to {_units(ours['worst'])} units. {allowed} In refdof: {formula.used}.")}"""


def _wrapped(words: str) -> str:
    return textwrap.fill(" ".join(words.split()), 120, break_on_hyphens=False, break_long_words=False)


def _units(error: float) -> str:
    """An error in units, with two digits or three."""
    units = error / _UNIT
    return f"{units:.1e}".replace("e+0", "e").replace("e+", "e") if units >= 1000 else f"{units:.{2 + (units > 100)}g}"


def _share(error: float) -> str:
    return f"{error:.1e}" if error > 2.0**-53 else "1e-16"
