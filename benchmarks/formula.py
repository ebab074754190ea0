"""Formula: one that loses digits, as it is printed and as refdof writes it, with inputs that show where.

Both forms are plain Python over numbers of any type: NumPy's float32, where they are judged, and mpmath's with 50
digits, where the naive one is the truth. Functions here take either.
"""

import inspect
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import mpmath
import numpy as np

__all__ = [
    "Formula",
    "acos",
    "beside",
    "exactly",
    "exp",
    "expm1",
    "log",
    "log1p",
    "log2",
    "near_one",
    "product_plus",
    "source_of",
    "spread_over",
    "sqrt",
    "wide",
]

Array = Any
_DIGITS = 50


class Formula(NamedTuple):
    """What the table and the page show of a formula.

    Attributes
    ----------
    name, title : str
    legend : str
        What the arguments are.
    fails : str
        Where the naive form loses its digits; a sentence.
    naive, ours : callable
        Of the same arguments.
    glsl : str
        The function of `ours`, with its name; helpers of `GLSL_HELPERS` may be called.
    draw : callable
        (random, count) -> arguments, float32 arrays (count,).
    bound : float
        What `ours` may err by in float32 [2^-23 of the value], from its roundings.
    shader_bound : float
        The same for a shader: divisions and roots of 2.5 units each, as Vulkan allows, and no better exp and log than
        `exp2` and `log2` of 3 units.
    used : str
        Where refdof has it.
    code : callable or None
        What refdof's own function gives for the same arguments.
    unit : callable or None
        Errors are shares of this, a function of the arguments, instead of the value.
    """

    name: str
    title: str
    legend: str
    fails: str
    naive: Callable[..., Any]
    ours: Callable[..., Any]
    glsl: str
    draw: Callable[[np.random.Generator, int], tuple[Array, ...]]
    bound: float
    shader_bound: float
    used: str
    code: Callable[..., Any] | None = None
    unit: Callable[..., Any] | None = None

    @property
    def arguments(self) -> list[str]:
        """Names of the arguments."""
        return list(inspect.signature(self.naive).parameters)


def exactly(function: Callable[..., Any], arguments: Sequence[Array]) -> Array:
    """Values (N,) float64 of a function of float32 arrays (N,), taken in 50 digits."""
    with mpmath.workdps(_DIGITS):
        rows = zip(*(array.tolist() for array in arguments), strict=True)
        return np.array([float(function(*map(mpmath.mpf, row))) for row in rows])


def source_of(function: Callable[..., Any], name: str) -> str:
    """The source of a function, under another name."""
    head, body = inspect.getsource(function).strip().split("\n", 1)
    return f"def {name}({head.partition('(')[2]}\n{body}"


def _either(ours: Any, theirs: Any) -> Callable[[Any], Any]:
    def call(value: Any) -> Any:
        return theirs(value) if isinstance(value, mpmath.mpf) else ours(value)

    return call


sqrt, exp, log = _either(np.sqrt, mpmath.sqrt), _either(np.exp, mpmath.exp), _either(np.log, mpmath.log)
expm1, log1p = _either(np.expm1, mpmath.expm1), _either(np.log1p, mpmath.log1p)
acos = _either(np.arccos, mpmath.acos)
log2 = _either(np.log2, lambda value: mpmath.log(value, 2))


def product_plus(a: Any, b: Any, c: Any) -> Any:
    """A b + c, rounded once."""
    if isinstance(a, mpmath.mpf):
        return a * b + c
    return (np.asarray(a, dtype=np.float64) * b + c).astype(np.float32)  # 24 + 24 bits fit into 53


def wide(values: Any) -> Array:
    """`values` as float64."""
    return np.asarray(values, dtype=np.float64)


def spread_over(random: np.random.Generator, low: float, high: float, count: int) -> Array:
    """float32 numbers that are even over the logarithm."""
    return np.exp(random.uniform(np.log(low), np.log(high), count)).astype(np.float32)


def near_one(random: np.random.Generator, count: int, least: float = 1e-7, most: float = 1.0) -> Array:
    """1 + d with d even over the logarithm, float64."""
    return 1.0 + np.exp(random.uniform(np.log(least), np.log(most), count))


def beside(random: np.random.Generator, middle: Array, least: float = 1e-7) -> Array:
    """float32 numbers on both sides of `middle`, each 1e-7 to 1 of it away."""
    ratio = near_one(random, len(middle), least)
    return (middle * np.where(random.random(len(middle)) < 0.5, ratio, 1.0 / ratio)).astype(np.float32)
