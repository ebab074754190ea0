"""Faults: every single-line change of a module that a slip of the hand could make, and a sample of them by seed.

1. find what can be changed, kind by kind           `faults_of`
2. draw some by seed, spread over functions and kinds  `sample`
3. make the changed text                             `planted`

Text is changed, not a tree: lines keep their numbers, and a fault can be read in a listing.
"""

import ast
import random
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

__all__ = ["Fault", "faults_of", "planted", "sample"]

_SWAPPED = {
    ast.Add: ("+", "-"),
    ast.Sub: ("-", "+"),
    ast.Mult: ("*", "/"),
    ast.Div: ("/", "*"),
    ast.FloorDiv: ("//", "*"),
    ast.Pow: ("**", "*"),
    ast.LShift: ("<<", ">>"),
    ast.RShift: (">>", "<<"),
    ast.BitAnd: ("&", "|"),
    ast.BitXor: ("^", "|"),
    ast.Lt: ("<", "<="),
    ast.LtE: ("<=", "<"),
    ast.Gt: (">", ">="),
    ast.GtE: (">=", ">"),
    ast.Eq: ("==", "!="),
    ast.NotEq: ("!=", "=="),
    ast.And: ("and", "or"),
    ast.Or: ("or", "and"),
}
_OTHER_FUNCTION = {
    "min": "max",
    "max": "min",
    "minimum": "maximum",
    "maximum": "minimum",
    "floor": "ceil",
    "ceil": "floor",
    "sin": "cos",
    "cos": "sin",
    "any": "all",
    "all": "any",
}
_DROPPED = {"abs", "sqrt", "fabs", "absolute"}
# Order means nothing to these, or both orders fail alike.
_UNORDERED = {"min", "max", "minimum", "maximum", "hypot", "isinstance", "zip", "print", "gcd", "array_equal"}
# Lines on which only speed or memory depends: sizes of blocks and caches, numbers of threads.
_SPEED = re.compile(r"BLOCK\b|_CHUNK\b|maxsize|thread_count|threads=|_TREE\b|\bborrow\(|workers|_BATCH\b|progress")
_A_KIND = 6  # of a sample, the part that one kind may have at most is one in ...


@dataclass(frozen=True)
class Fault:
    """One change of one line: bytes `start` to `end` of line `line` become `new`."""

    path: str
    function: str
    line: int
    start: int
    end: int
    kind: str
    old: str
    new: str

    @property
    def name(self) -> str:
        """What stands in lists."""
        return f"{self.path}:{self.line}:{self.start} {self.old} -> {self.new}"


def faults_of(path: str, text: str) -> list[Fault]:
    """All faults that can be planted in a module; `path` is only its name."""
    return sorted(_Finder(path, text).found, key=lambda fault: (fault.line, fault.start, fault.kind, fault.new))


def planted(text: str, fault: Fault) -> str:
    """The module's text with the fault in it; its lines keep their numbers."""
    lines = text.encode().split(b"\n")
    line = lines[fault.line - 1]
    assert line[fault.start : fault.end] == fault.old.encode(), fault
    lines[fault.line - 1] = line[: fault.start] + fault.new.encode() + line[fault.end :]
    return b"\n".join(lines).decode()


def sample(root: Path, folder: str, count: int, seed: int) -> list[Fault]:
    """Draw faults of all modules below a folder: at most one a function, and no kind too often."""
    every: list[Fault] = []
    for path in sorted((root / folder).rglob("*.py")):
        every += faults_of(path.relative_to(root).as_posix(), path.read_text(encoding="utf-8"))
    random.Random(f"{folder} {seed}").shuffle(every)
    chosen: list[Fault] = []
    functions: set[tuple[str, str]] = set()
    kinds: Counter[str] = Counter()
    for fault in every:
        place = (fault.path, fault.function)
        if place in functions or kinds[fault.kind] > count // _A_KIND:
            continue
        functions.add(place)
        kinds[fault.kind] += 1
        chosen.append(fault)
        if len(chosen) == count:
            break
    return chosen


class _Finder(ast.NodeVisitor):
    """Walks a module; leaves out words, types, messages of errors and what only speed depends on."""

    def __init__(self, path: str, text: str) -> None:
        self.path, self.lines = path, text.encode().split(b"\n")
        self.names: list[str] = []  # as in `__qualname__`
        self.in_function: list[bool] = []
        self.found: list[Fault] = []
        self.visit(ast.parse(text))

    def _add(self, kind: str, line: int, start: int, end: int, new: str) -> None:
        whole = self.lines[line - 1]
        if not _SPEED.search(whole.decode()):
            old = whole[start:end].decode()
            self.found.append(Fault(self.path, ".".join(self.names), line, start, end, kind, old, new))

    def _replace(self, kind: str, node: ast.expr | ast.stmt, new: str) -> None:
        if node.lineno == node.end_lineno:
            self._add(kind, node.lineno, node.col_offset, node.end_col_offset or 0, new)

    def _text(self, node: ast.expr) -> str | None:
        if node.lineno != node.end_lineno:
            return None
        return self.lines[node.lineno - 1][node.col_offset : node.end_col_offset].decode()

    def _operator(self, left: ast.expr, operator: ast.AST, right: ast.expr) -> None:
        """Swap the operator between two expressions, on whichever line it stands."""
        if type(operator) not in _SWAPPED or _is_word(left) or _is_word(right):
            return
        old, new = _SWAPPED[type(operator)]
        for line in range(left.end_lineno or 0, right.lineno + 1):
            begin = left.end_col_offset or 0 if line == left.end_lineno else 0
            end = right.col_offset if line == right.lineno else len(self.lines[line - 1])
            between = self.lines[line - 1][begin:end].split(b"#")[0].decode()
            if old in between:
                start = begin + between.index(old)
                self._add(f"{old} to {new}", line, start, start + len(old), new)
                return

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        if self.names and self.in_function[-1]:
            self.names.append("<locals>")
        self.names.append(node.name)
        self.in_function.append(True)
        for child in (*node.args.defaults, *(value for value in node.args.kw_defaults if value), *node.body):
            self.visit(child)
        self._leave()

    def visit_ClassDef(self, node: ast.ClassDef) -> None:
        self.names.append(node.name)
        self.in_function.append(False)
        for child in node.body:
            self.visit(child)
        self._leave()

    def _leave(self) -> None:
        self.names.pop()
        self.in_function.pop()
        if self.names and self.names[-1] == "<locals>":
            self.names.pop()

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        if node.value:
            self.visit(node.value)

    def visit_Assign(self, node: ast.Assign) -> None:
        if not any(isinstance(target, ast.Name) and target.id == "__all__" for target in node.targets):
            if isinstance(node.targets[0], ast.Subscript | ast.Attribute):
                self._replace("statement removed", node, "pass")
            self.generic_visit(node)

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        self._replace("statement removed", node, "pass")
        self._operator(node.target, node.op, node.value)
        self.generic_visit(node)

    def visit_Expr(self, node: ast.Expr) -> None:
        if isinstance(node.value, ast.Call):
            self._replace("statement removed", node, "pass")
        if not isinstance(node.value, ast.Constant):
            self.generic_visit(node)

    def visit_Continue(self, node: ast.Continue) -> None:
        self._replace("statement removed", node, "pass")

    def visit_Break(self, node: ast.Break) -> None:
        self._replace("statement removed", node, "pass")

    def visit_Raise(self, node: ast.Raise) -> None:
        """Leave out what an error says."""

    def visit_JoinedStr(self, node: ast.JoinedStr) -> None:
        """Leave out words."""

    def visit_BinOp(self, node: ast.BinOp) -> None:
        self._operator(node.left, node.op, node.right)
        self.generic_visit(node)

    def visit_Compare(self, node: ast.Compare) -> None:
        for left, operator, right in _pairs([node.left, *node.comparators], node.ops):
            self._operator(left, operator, right)
        self.generic_visit(node)

    def visit_BoolOp(self, node: ast.BoolOp) -> None:
        self._operator(node.values[0], node.op, node.values[1])
        self.generic_visit(node)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> None:
        text = self._text(node.operand)
        if text is not None and isinstance(node.op, ast.USub | ast.Not):
            self._replace("minus dropped" if isinstance(node.op, ast.USub) else "not dropped", node, text)
        self.generic_visit(node)

    def visit_Constant(self, node: ast.Constant) -> None:
        value = node.value
        if isinstance(value, bool):
            self._replace("truth value", node, str(not value))
        elif isinstance(value, int):
            self._replace("integer", node, str(value + 1))
        elif isinstance(value, float):
            self._replace("number", node, repr(value / 2) if value else "1.0")

    def visit_Subscript(self, node: ast.Subscript) -> None:
        if isinstance(node.slice, ast.Name) and isinstance(node.ctx, ast.Load):
            self._replace("index off by one", node.slice, f"{node.slice.id} - 1")
        self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> None:
        function = node.func
        name = function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")
        if name in _OTHER_FUNCTION and function.lineno == function.end_lineno:
            end = function.end_col_offset or 0
            other = _OTHER_FUNCTION[name]
            self._add(f"{name} to {other}", function.lineno, end - len(name), end, other)
        if name in _DROPPED and len(node.args) == 1 and (text := self._text(node.args[0])) is not None:
            self._replace(f"{name} dropped", node, f"({text})")
        if name in ("range", "prange") and (text := self._text(node.args[-1])) is not None:
            self._replace("range off by one", node.args[-1], f"{text} - 1")
        if name not in _UNORDERED and not name.startswith("as_") and not node.keywords:
            self._swapped_arguments(node)
        self.generic_visit(node)

    def _swapped_arguments(self, node: ast.Call) -> None:
        for first, second in zip(node.args, node.args[1:], strict=False):
            one, other = self._text(first), self._text(second)
            if one is None or other is None or first.lineno != second.lineno or one == other:
                continue
            if any(isinstance(side, ast.Starred | ast.Constant) for side in (first, second)):
                continue
            gap = self.lines[first.lineno - 1][first.end_col_offset : second.col_offset].decode()
            start, end = first.col_offset, second.end_col_offset or 0
            self._add("arguments swapped", first.lineno, start, end, f"{other}{gap}{one}")


def _is_word(node: ast.expr) -> bool:
    return isinstance(node, ast.JoinedStr) or (isinstance(node, ast.Constant) and isinstance(node.value, str))


def _pairs(sides: list[ast.expr], operators: list[ast.cmpop]) -> Iterator[tuple[ast.expr, ast.cmpop, ast.expr]]:
    yield from zip(sides, operators, sides[1:], strict=False)
