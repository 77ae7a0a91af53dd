"""A student's code with one expression of a line replaced, so that a repair is tried before it is proposed."""

import ast
import linecache
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from inspect import getblock
from textwrap import dedent
from types import CodeType, FunctionType
from typing import Any, cast

from labsid.checks.cell_names import parse_python
from labsid.checks.syntax_trees import flat_text, is_deep

MEND_SECONDS = 0.25
"""Longest call of a mended function; that of a trial usually takes a few milliseconds."""
_LONGEST_LINE = 300  # characters, as `stops` keeps of a line
MOST_LEVELS = 60
"""Levels of the syntax tree of a function; deeper ones are not mended."""


@dataclass(frozen=True, slots=True)
class Mend:
    """A repair: in a line, the expression `part` is replaced by `repair`.

    Attributes
    ----------
    line : str
        The line as a `Stop` has it, or one of those that made what stands in it.
    part, repair : str
        Code of two expressions.
    """

    line: str
    part: str
    repair: str


def mended(name: str, mend: Mend, variables: Mapping[str, Any]) -> Callable[..., Any] | None:
    """The function of that name, as it is when one line of it, or of a function of the notebook's, is mended.

    The functions of the notebook are made anew with variables of their own: what they assign is not the notebook's.

    Parameters
    ----------
    name : str
    mend : Mend
    variables : mapping
        The notebook's variables.

    Returns
    -------
    callable or None
        None where the line is not found, stands in several places or cannot be told apart, and where Python keeps no
        text of the function.
    """
    own = _functions_of(variables)
    if name not in own:
        return None
    try:
        found = [(key, tree) for key, thing in own.items() for tree in _with(thing, mend)]
        if len(found) != 1:
            return None
    except Exception:
        return None
    functions = rebound(*found[0], variables)
    return None if functions is None else functions.get(name)


def rebound(changed: str, tree: ast.Module, variables: Mapping[str, Any]) -> Mapping[str, Callable[..., Any]] | None:
    """The functions of a notebook, made anew with variables of their own, one of them from another definition.

    Parameters
    ----------
    changed : str
        The name of that one.
    tree : ast.Module
        Its definition.
    variables : mapping
        The notebook's variables.

    Returns
    -------
    mapping or None
        By name; None where the definition does not run.
    """
    own = _functions_of(variables)
    names: dict[str, Any] = dict(variables)
    try:
        exec(compile(tree, "<mended>", "exec"), names)
    except Exception:  # the student's defaults are computed anew, and may fail
        return None
    made = names.get(own[changed].__name__)
    for key, thing in own.items():
        again = FunctionType(thing.__code__, names, thing.__name__, thing.__defaults__, thing.__closure__)
        again.__kwdefaults__ = thing.__kwdefaults__
        names[key] = made if thing is own[changed] else again
    return {key: names[key] for key in own if callable(names[key])}


def _functions_of(variables: Mapping[str, Any]) -> dict[str, FunctionType]:
    """The functions of the notebook itself, by name."""
    return {
        key: thing
        for key, thing in variables.items()
        if isinstance(thing, FunctionType) and thing.__globals__ is variables
    }


def assigned_by(mend: Mend) -> str:
    """The variable to which the line of a mend assigns a value, and nothing else; empty if it does not."""
    assignment = _assignment(mend)
    return "" if assignment is None else assignment[0]


def mended_value(mend: Mend, variables: Mapping[str, Any]) -> Any:
    """What the mended line assigns, computed in the notebook's variables; raises what the line raises.

    The line must be an assignment to one variable (`assigned_by`), which is not carried out.
    """
    assignment = _assignment(mend)
    if assignment is None:
        raise ValueError(f"{mend.line!r} assigns no variable; a line such as `x = f(y)` is asked for.")
    name, value = assignment
    replacing = _Replacing(flat_text(_expression(mend.part)), _expression(mend.repair))
    code = ast.fix_missing_locations(ast.Expression(cast(ast.expr, replacing.visit(value))))
    if not replacing.count:
        raise ValueError(f"`{mend.part}` is not in the value of `{name}`.")
    return eval(compile(code, "<mended>", "eval"), dict(variables))


def made_by_function(name: str, source: str, functions: Mapping[str, Callable[..., Any]]) -> CodeType | None:
    """The code of what the last line of an answer that assigns a variable makes it of, with a function of its own.

    Parameters
    ----------
    name : str
        Of the variable.
    source : str
        The code of the answer cell.
    functions : mapping
        Those of the notebook, by name.

    Returns
    -------
    code or None
        None where the last assignment at the top level calls none of them.
    """
    try:
        body = parse_python(source).body
    except (SyntaxError, ValueError, RecursionError):
        return None
    made = [
        node.value
        for node in body
        if isinstance(node, ast.Assign) and [one.id for one in node.targets if isinstance(one, ast.Name)] == [name]
    ]
    if not made or is_deep(made[-1], MOST_LEVELS):
        return None
    called = {
        node.func.id for node in ast.walk(made[-1]) if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
    }
    changes = any(isinstance(node, ast.NamedExpr) for node in ast.walk(made[-1]))
    if not called & functions.keys() or changes:
        return None
    return compile(ast.fix_missing_locations(ast.Expression(made[-1])), "<mended>", "eval")


def _assignment(mend: Mend) -> tuple[str, ast.expr] | None:
    try:
        body = parse_python(mend.line).body
    except (SyntaxError, ValueError):
        return None
    only = body[0] if len(body) == 1 else None
    if not isinstance(only, ast.Assign) or len(only.targets) != 1 or is_deep(only, MOST_LEVELS):
        return None
    target = only.targets[0]
    changes = any(isinstance(node, ast.NamedExpr) for node in ast.walk(only))
    return (target.id, only.value) if isinstance(target, ast.Name) and not changes else None


def _expression(code: str) -> ast.expr:
    only = parse_python(code).body[0]
    if not isinstance(only, ast.Expr):
        raise ValueError(f"{code!r} is no expression.")
    return only.value


def _with(function: FunctionType, mend: Mend) -> Iterator[ast.Module]:
    """The definition of a function, with the mend in each place where it fits."""
    lines = linecache.getlines(function.__code__.co_filename)
    written = dedent("".join(getblock(lines[function.__code__.co_firstlineno - 1 :]))) if lines else ""
    if mend.line not in " ".join(one.strip() for one in written.splitlines()):
        return
    tree = parse_python(written)
    if is_deep(tree, MOST_LEVELS):
        return
    definition = tree.body[0]
    if not isinstance(definition, ast.FunctionDef) or definition.decorator_list or function.__closure__:
        return
    numbered = written.splitlines()
    for statement in [node for node in ast.walk(tree) if isinstance(node, ast.stmt) and not hasattr(node, "body")]:
        last = statement.end_lineno or statement.lineno
        text = " ".join(one.strip() for one in numbered[statement.lineno - 1 : last])
        if mend.line not in (text, text[:_LONGEST_LINE]):
            continue
        replacing = _Replacing(flat_text(_expression(mend.part)), _expression(mend.repair))
        replacing.visit(statement)
        if replacing.count:
            yield ast.fix_missing_locations(tree)


class _Replacing(ast.NodeTransformer):
    """Puts one expression in the place of another; `count` is how often."""

    def __init__(self, part: str, repair: ast.expr) -> None:
        self._part, self._repair = part, repair
        self.count = 0

    def visit(self, node: ast.AST) -> ast.AST:
        if isinstance(node, ast.expr) and flat_text(node) == self._part:
            self.count += 1
            return self._repair
        return self.generic_visit(node)
