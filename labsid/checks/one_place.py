"""The one place that makes a student's function wrong: the place where another expression makes the answer right.

Each change is tried by the question's own check. A place is named only where the answer passes with the change.
"""

import ast
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from time import process_time
from types import CodeType, FunctionType
from typing import Any

from labsid.checks.cell_names import parse_python
from labsid.checks.function_reads import function_text
from labsid.checks.mended_functions import MOST_LEVELS, rebound
from labsid.checks.other_expressions import expressions_for, statements_for
from labsid.checks.syntax_trees import is_deep

MOST_CHANGES, CPU_SECONDS = 200, 0.2
"""Changes that are tried at one answer, and the processor time that they may take together."""
_LONGEST = 100  # characters of a line or an expression in a message

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
    why : str
        What the expression does that the other does not, in a sentence; empty if that is not known.
    """

    line: str
    part: str
    repair: str
    why: str = ""

    @property
    def said(self) -> str:
        """Where the mistake is, in a sentence."""
        where = "" if self.part == self.line else f", in `{self.line}`"
        said = f"The mistake is in one place, `{self.part}`{where}: with another expression there the answer is right."
        return f"{said} {self.why}".rstrip()

    @property
    def mend(self) -> str:
        """What to do, in a sentence."""
        return f"It is right with `{self.repair}`."


@dataclass(frozen=True, slots=True)
class _Change:
    """One expression in the place of another: ``setattr(parent, field, new)``, or an item of the list there.

    `rank` is lower for mistakes that are more frequent; `shown` is the expression that a message writes out. `why` is
    that of a `Place`.
    """

    rank: int
    parent: ast.AST
    field: str
    index: int | None
    new: ast.AST
    shown: ast.AST
    why: str = ""

    def swap(self, expression: ast.AST) -> ast.AST:
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
                    return Place(_cut(lines[number - 1].strip()), before, after, change.why)
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
                slot = _Slot(parent, field, index)
                if isinstance(node, ast.AugAssign):
                    yield from (
                        _Change(one.rank, parent, field, index, one.new, slot, one.why) for one in statements_for(node)
                    )
                if isinstance(node, ast.expr) and isinstance(getattr(node, "ctx", ast.Load()), ast.Load):
                    for other in expressions_for(node, parent, names):
                        shown = node if other.is_whole else _enclosing(node, (*above, parent))
                        shown = slot if shown is node else shown
                        yield _Change(other.rank, parent, field, index, other.new, shown, other.why)


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
