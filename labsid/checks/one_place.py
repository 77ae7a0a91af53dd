"""The one place that makes a student's function wrong: the place where another expression makes the answer right.

Each change is tried by the question's own check. A place is named only where the answer passes with the change.
"""

import ast
from collections.abc import Callable, Iterator, Mapping
from copy import deepcopy
from dataclasses import dataclass
from time import process_time
from types import CodeType, FunctionType
from typing import Any

from labsid.checks.cell_names import parse_python
from labsid.checks.function_reads import function_text
from labsid.checks.mended_functions import MOST_LEVELS, rebound
from labsid.checks.syntax_trees import is_deep

MOST_CHANGES, CPU_SECONDS = 200, 0.2
"""Changes that are tried at one answer, and the processor time that they may take together."""
_LONGEST = 100  # characters of a line or an expression in a message
_SMALL = 3  # integers up to it are indices, lags and bounds, which are often off by one
_REDUCE = ("sum", "mean", "norm")
"""Functions that make one number of many where each is asked for."""
_KEPT_CALLS = ("range", "len", "enumerate", "zip", "list", "int", "float", "array", "asarray", "copy", "zeros", "ones")
"""Functions without which an expression is another kind of thing, or the same."""

Functions = Mapping[str, Callable[..., Any]]


@dataclass(frozen=True, slots=True)
class Place:
    """A place in a function, and what makes the answer right there.

    Attributes
    ----------
    line : str
        The student's line.
    part, repair : str
        The expression in it, and one with which the answer is right.
    """

    line: str
    part: str
    repair: str

    @property
    def said(self) -> str:
        """Where the mistake is, in a sentence."""
        where = "" if self.part == self.line else f", in `{self.line}`"
        return f"The mistake is in one place, `{self.part}`{where}: with another expression there the answer is right."

    @property
    def mend(self) -> str:
        """What to do, in a sentence."""
        return f"It is right with `{self.repair}`."


@dataclass(frozen=True, slots=True)
class _Change:
    """One expression in the place of another: ``setattr(parent, field, new)``, or an item of the list there.

    `rank` is lower for mistakes that are more frequent; `shown` is the expression that a message writes out.
    """

    rank: int
    parent: ast.AST
    field: str
    index: int | None
    new: ast.expr
    shown: ast.AST

    def swap(self, expression: ast.expr) -> ast.expr:
        """Put an expression there, and return the one that stood there."""
        if self.index is None:
            old = getattr(self.parent, self.field)
            setattr(self.parent, self.field, expression)
        else:
            items = getattr(self.parent, self.field)
            old, items[self.index] = items[self.index], expression
        return old


def find_place(names: list[str], variables: Mapping[str, Any], is_right: Callable[[Functions], bool]) -> Place | None:
    """The place of a function where another expression makes the answer right; None if none is found.

    Parameters
    ----------
    names : list of str
        Names of the functions that the question asks for.
    variables : mapping
        The notebook's variables.
    is_right : callable
        ``is_right(functions)``: whether the answer passes with these functions, by name, in the place of the
        notebook's.
    """
    until = process_time() + CPU_SECONDS
    tried = 0
    for name in _with_called(names, variables):
        text = function_text(variables[name])
        tree = _definition(text)
        if tree is None or variables[name].__closure__:
            continue
        lines = text.splitlines()
        module = ast.Module([tree], [])
        for change in sorted(_changes(tree), key=lambda one: one.rank):
            if tried >= MOST_CHANGES or process_time() > until:
                return None
            tried += 1
            before = _shown(change.shown)
            old = change.swap(change.new)
            try:
                after = _shown(change.shown)
                functions = rebound(name, ast.fix_missing_locations(module), variables)
                if functions is not None and is_right(functions):
                    number = getattr(old, "lineno", tree.lineno)
                    return Place(_cut(lines[number - 1].strip()), before, after)
            finally:
                change.swap(old)
    return None


def _with_called(names: list[str], variables: Mapping[str, Any]) -> Iterator[str]:
    """Functions of the notebook by these names, and those that they call and that stand in the same cell."""
    seen: list[str] = []
    waiting = list(dict.fromkeys(names))
    while waiting:
        name = waiting.pop(0)
        function = variables.get(name)
        if name in seen or not isinstance(function, FunctionType) or function.__globals__ is not variables:
            continue
        seen.append(name)
        yield name
        file = function.__code__.co_filename
        for other in _names_of(function.__code__):
            called = variables.get(other)
            if isinstance(called, FunctionType) and called.__code__.co_filename == file:
                waiting.append(other)


def _names_of(code: CodeType) -> Iterator[str]:
    """The global names in a function, and in the functions and comprehensions within it."""
    yield from code.co_names
    for inner in code.co_consts:
        if isinstance(inner, CodeType):
            yield from _names_of(inner)


def _definition(text: str) -> ast.FunctionDef | None:
    """The tree of a function's text; None if it is no plain function, or nested too deep."""
    try:
        tree = parse_python(text)
    except (SyntaxError, ValueError, RecursionError):
        return None
    body = tree.body
    if is_deep(tree, MOST_LEVELS) or len(body) != 1 or not isinstance(body[0], ast.FunctionDef):
        return None
    return None if body[0].decorator_list else body[0]


def _changes(function: ast.FunctionDef) -> Iterator[_Change]:
    arguments = [one.arg for one in function.args.args]
    stored = [node.id for node in ast.walk(function) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)]
    names = list(dict.fromkeys([*arguments, *stored]))
    waiting: list[tuple[ast.AST, tuple[ast.AST, ...]]] = [(one, ()) for one in function.body]
    while waiting:
        parent, above = waiting.pop(0)
        for field, value in ast.iter_fields(parent):
            if field == "args" and isinstance(value, ast.arguments):
                continue
            for index, node in enumerate(value) if isinstance(value, list) else ((None, value),):
                if not isinstance(node, ast.AST):
                    continue
                waiting.append((node, (*above, parent)))
                if isinstance(node, ast.expr) and isinstance(getattr(node, "ctx", ast.Load()), ast.Load):
                    for rank, new, is_whole in _others(node, parent, names):
                        shown = node if is_whole else _enclosing(node, (*above, parent))
                        shown = _Slot(parent, field, index) if shown is node else shown
                        yield _Change(rank, parent, field, index, new, shown)


class _Slot(ast.AST):
    """A place of a tree; what stands in it is shown."""

    def __init__(self, parent: ast.AST, field: str, index: int | None) -> None:
        self.parent, self.field, self.index = parent, field, index

    @property
    def node(self) -> ast.AST:
        """What stands there now."""
        value = getattr(self.parent, self.field)
        return value if self.index is None else value[self.index]


def _shown(node: ast.AST) -> str:
    return _cut(ast.unparse(node.node if isinstance(node, _Slot) else node))


def _cut(text: str) -> str:
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."


def _enclosing(node: ast.AST, above: tuple[ast.AST, ...]) -> ast.AST:
    """The smallest expression around a number or a name that tells what it is for."""
    kinds = (ast.Call, ast.Subscript, ast.BinOp, ast.Compare, ast.UnaryOp)
    around = [one for one in above if isinstance(one, kinds)]
    if around and isinstance(around[-1], ast.BinOp) and len(around) > 1 and isinstance(around[-2], ast.Subscript):
        return around[-2]  # y[k - 1]
    return around[-1] if around else node


def _others(node: ast.expr, parent: ast.AST, names: list[str]) -> Iterator[tuple[int, ast.expr, bool]]:
    """Expressions that may be meant in the place of one: how frequent the mistake is, and whether to show it whole."""
    match node:
        case ast.Constant(value=int(number)) if not isinstance(number, bool) and abs(number) <= _SMALL:
            for other in (number + 1, number - 1):
                if other >= 0:
                    yield 0, ast.Constant(other), False
        case ast.Attribute(attr="shape") if isinstance(parent, ast.Assign):
            yield 0, _parsed(f"({ast.unparse(node)})[::-1]"), True
        case ast.Attribute(attr="T"):
            yield 1, node.value, True
        case ast.Name():
            rank = 3 if isinstance(parent, ast.Subscript) else 4
            if node.id in names:
                yield from ((rank, ast.Name(other, ast.Load()), False) for other in names if other != node.id)
            if isinstance(parent, ast.BinOp) and isinstance(parent.op, ast.MatMult):
                yield 3, ast.Attribute(deepcopy(node), "T", ast.Load()), False
        case ast.UnaryOp(op=ast.USub()):
            yield 1, node.operand, True
        case ast.BinOp():
            yield from _other_operations(node)
        case ast.Call():
            yield from _other_calls(node)
    in_list = isinstance(parent, ast.List | ast.Tuple) and not isinstance(node, ast.Constant | ast.UnaryOp)
    if in_list and isinstance(node, ast.Subscript | ast.Name):
        yield 3, ast.UnaryOp(ast.USub(), deepcopy(node)), True
    if isinstance(parent, ast.Subscript) and node is parent.slice and isinstance(node, ast.Name):
        for operation in (ast.Sub(), ast.Add()):
            yield 2, ast.BinOp(deepcopy(node), operation, ast.Constant(1)), False


def _other_operations(node: ast.BinOp) -> Iterator[tuple[int, ast.expr, bool]]:
    others: dict[type[ast.operator], ast.operator] = {
        ast.Add: ast.Sub(), ast.Sub: ast.Add(), ast.Mult: ast.Div(), ast.Div: ast.Mult(),
    }  # fmt: skip
    operation = type(node.op)
    if operation in others:
        yield 1, ast.BinOp(node.left, others[operation], node.right), True
    if operation is ast.Pow:
        yield 1, node.left, True
    if operation is ast.Sub:
        yield 2, ast.BinOp(node.right, ast.Sub(), node.left), True
    if operation in (ast.Mult, ast.Div, ast.Add, ast.Sub):
        yield 2, node.left, True  # a factor or a term too many
        if operation in (ast.Mult, ast.Add):
            yield 2, node.right, True
    if operation is ast.MatMult:
        yield 2, ast.BinOp(node.right, ast.MatMult(), node.left), True
        middle = node.left
        if isinstance(middle, ast.BinOp) and isinstance(middle.op, ast.MatMult):  # x A y for y A x
            inner = ast.BinOp(node.right, ast.MatMult(), middle.right)
            yield 2, ast.BinOp(inner, ast.MatMult(), middle.left), True


def _other_calls(node: ast.Call) -> Iterator[tuple[int, ast.expr, bool]]:
    name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
    arguments = node.args
    if name == "range":
        last = 0 if len(arguments) == 1 else 1
        if len(arguments) <= 2 and not isinstance(arguments[last], ast.Constant):
            for operation in (ast.Add(), ast.Sub()):
                bounds = [*arguments[:last], ast.BinOp(arguments[last], operation, ast.Constant(1))]
                yield 0, ast.Call(node.func, bounds, []), True
        if len(arguments) == 1:
            yield 0, ast.Call(node.func, [ast.Constant(1), arguments[0]], []), True
        counted = [one for argument in arguments for one in ast.walk(argument) if _is_length(one)]
        if counted:
            yield 1, deepcopy(counted[0].args[0]), True  # type: ignore[attr-defined]
        return
    if len(arguments) == 1 and not node.keywords and name not in _KEPT_CALLS:
        yield -1 if name in _REDUCE else 1, arguments[0], True
        inner = arguments[0]
        if isinstance(inner, ast.Call) and len(inner.args) == 1 and not inner.keywords:
            yield 2, inner.args[0], True
    if len(arguments) >= 2 and not any(isinstance(one, ast.Starred) for one in arguments):
        yield 1, ast.Call(node.func, [arguments[1], arguments[0], *arguments[2:]], node.keywords), True


def _is_length(node: ast.AST) -> bool:
    return isinstance(node, ast.Call) and getattr(node.func, "id", "") == "len" and len(node.args) == 1


def _parsed(text: str) -> ast.expr:
    only = parse_python(text).body[0]
    assert isinstance(only, ast.Expr)
    return only.value
