"""Expressions over the numbers and pictures of a case, such as "coc_scale / max_blur_size" or "depth / far"."""

import ast
from collections.abc import Mapping
from typing import Any

import numpy as np

from refdof._check import InputError

__all__ = ["evaluate", "names_in", "parsed"]

_OPERATORS: dict[type, Any] = {
    ast.Add: np.add,
    ast.Sub: np.subtract,
    ast.Mult: np.multiply,
    ast.Div: np.true_divide,
    ast.UAdd: np.positive,
    ast.USub: np.negative,
}
_LONGEST = 200


def parsed(name: str, text: str) -> ast.expr:
    """Read an expression: numbers, names, + - * /, brackets, and commas between parts of a vector.

    Raises
    ------
    InputError
        If it is anything else; `name` is what it is for.
    """
    allowed = "allowed are numbers, names, + - * / ( ) and commas"
    try:
        tree = ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise InputError(f"{name}: got {text[:80]!r}; {allowed}") from None
    nodes = (ast.Constant, ast.Name, ast.BinOp, ast.UnaryOp, ast.Tuple, ast.expr_context, *_OPERATORS)
    for node in ast.walk(tree):
        number = not isinstance(node, ast.Constant) or type(node.value) in (int, float)
        nested = isinstance(node, ast.Tuple) and node is not tree
        if not isinstance(node, nodes) or not number or nested or len(text) > _LONGEST:
            raise InputError(f"{name}: got {text[:80]!r}; {allowed}")
    return tree


def names_in(tree: ast.expr) -> set[str]:
    """The names that an expression reads."""
    return {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}


def evaluate(tree: ast.expr, values: Mapping[str, Any]) -> Any:
    """Its value: a number, an array, or a tuple of them. All its names are among `values`."""
    if isinstance(tree, ast.Tuple):
        return tuple(evaluate(part, values) for part in tree.elts)
    if isinstance(tree, ast.BinOp):
        with np.errstate(all="ignore"):
            return _OPERATORS[type(tree.op)](evaluate(tree.left, values), evaluate(tree.right, values))
    if isinstance(tree, ast.UnaryOp):
        return _OPERATORS[type(tree.op)](evaluate(tree.operand, values))
    if isinstance(tree, ast.Name):
        return values[tree.id]
    assert isinstance(tree, ast.Constant)
    return float(tree.value)  # type: ignore[arg-type]
