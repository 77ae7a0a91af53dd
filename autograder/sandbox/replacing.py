"""In the student process: run a cell statement by statement, and replace wrong values where they are made.

What replaces them was sent by the judge, which has judged their question for good: whatever student code does to this
module changes what later cells start from, and no mark of that question.
"""

import ast
import asyncio
import contextlib
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np

from autograder.sandbox.in_functions import ThroughHooks, set_hooks
from labsid.checks.cell_names import assigned_names, parse_python
from labsid.checks.permitted import without_magic
from labsid.checks.values import Value, as_student_object, plain

_MAX_HOOKED = 20  # values of one name in functions: a function that is called more often is no whole notebook
_MAX_ENTRIES = 100  # of a dict, a list or a table
_SIMPLE_DIGITS = 6  # a number with more digits is a computed one, which another variable does not equal by chance


@dataclass(frozen=True, slots=True, eq=False)
class Replacement:
    """What takes the place of a wrong answer.

    Attributes
    ----------
    right : mapping
        Right values, by name.
    wrong : mapping
        The values that the cells give these names; without those that they do not make.
    functions : tuple of str
        Functions that the judge serves from now on.
    kept : frozenset of str
        Names of other questions and of given cells, which keep their values. A wrong value that none of them has is
        replaced under other names, too.
    """

    right: Mapping[str, Value]
    wrong: Mapping[str, Value]
    functions: tuple[str, ...] = ()
    kept: frozenset[str] = frozenset()

    @property
    def names(self) -> frozenset[str]:
        """All names that are replaced."""
        return frozenset((*self.right, *self.functions))


def run_replacing(
    shell: Any, source: str, replacements: Iterable[Replacement], serve: Callable[[str], Callable[..., Any]]
) -> Any:
    """Run a cell; after each statement, replace what it has made.

    A statement that fails to make what is replaced does not stop the cell.

    Parameters
    ----------
    shell : InteractiveShell
    source : str
    replacements : iterable of Replacement
    serve : callable
        Makes the function of a name that asks the judge.

    Returns
    -------
    ExecutionResult
        IPython's, of the statement that stopped the cell, or of the last one.
    """
    replacements = tuple(replacements)
    if not replacements:
        return _run_cell(shell, source)
    result = None
    replaced = frozenset().union(*(replacement.names for replacement in replacements))
    with _in_functions(shell, replacements, replaced, serve):
        for piece in _statements(source):
            result = _run_cell(shell, piece)
            error = result.error_before_exec or result.error_in_exec
            if isinstance(error, NameError) and _set_missing(shell.user_ns, str(error.name), replacements, serve):
                result = _run_cell(shell, piece)
                error = result.error_before_exec or result.error_in_exec
            made = assigned_names(piece)
            if error is None:  # a call alone may make anything
                for name in (made or replaced) & shell.user_ns.keys():
                    _replace_made(shell.user_ns, name, replacements, serve)
            elif made and made <= replaced:
                for name in made:
                    _set_missing(shell.user_ns, name, replacements, serve)
                result.error_before_exec = result.error_in_exec = None
            else:
                break
    return result


def in_event_loop(call: Callable[[], Any]) -> Any:
    """Call a function while an event loop runs, as Jupyter does: it can make tasks, and not start another loop.

    There is none before the first cell that mentions one.
    """
    if not _LOOPS or _LOOPS[0].is_running():  # it runs where a function that is served calls one back
        return call()

    async def called() -> tuple[Any, BaseException | None]:
        try:
            return call(), None
        except BaseException as error:  # a coroutine does not pass on each kind
            return None, error

    value, error = _LOOPS[0].run_until_complete(called())
    if error is not None:
        raise error
    return value


_LOOPS: list[asyncio.AbstractEventLoop] = []


def _run_cell(shell: Any, source: str) -> Any:
    run, is_async = partial(shell.run_cell, source, store_history=False), False
    if "async" in source or "await" in source:
        if not _LOOPS:
            _LOOPS.append(asyncio.new_event_loop())
        shell.loop_runner = _LOOPS[0].run_until_complete
        with contextlib.suppress(Exception):  # the run says what is wrong with it
            is_async = shell.should_run_async(source, transformed_cell=shell.transform_cell(source))
    return run() if is_async else in_event_loop(run)


@contextlib.contextmanager
def _in_functions(
    shell: Any,
    replacements: tuple[Replacement, ...],
    replaced: frozenset[str],
    serve: Callable[[str], Callable[..., Any]],
) -> Iterator[None]:
    """While a cell runs, replace what its functions make, too; when the judge calls them, they are as written."""

    calls: Counter[str] = Counter()

    def made(name: str, value: Any, others: Mapping[str, Any]) -> Any:
        calls[name] += 1
        if calls[name] > _MAX_HOOKED:
            return value
        variables = {**shell.user_ns, **others, name: value}
        _replace_made(variables, name, replacements, serve)
        return variables[name]

    def missing(name: str) -> Any:
        variables: dict[str, Any] = {}
        if not _set_missing(variables, name, replacements, serve):
            raise  # what the statement has raised
        return variables[name]

    kept_names = frozenset().union(*(replacement.kept | set(replacement.functions) for replacement in replacements))
    set_hooks(made, missing)
    # not among `shell.ast_transformers`, for which IPython walks through the tree with a stack frame for each level
    hooks, usual = ThroughHooks(kept_names, replaced), shell.transform_ast

    def transform(tree: ast.Module) -> ast.Module:
        changed: ast.Module = usual(tree)
        if isinstance(changed, ast.Module):
            hooks.change(changed)
        return changed

    shell.transform_ast = transform
    try:
        yield
    finally:
        shell.transform_ast = usual
        set_hooks(lambda name, value, others: value, _none_missing)


def _none_missing(name: str) -> Any:
    raise  # what the statement has raised


def set_right(variables: dict[str, Any], replacement: Replacement, serve: Callable[[str], Callable[..., Any]]) -> None:
    """Set the right values and functions, whether the cells have made them or not."""
    for name, value in replacement.right.items():
        variables[name] = as_object(value)
    for name in replacement.functions:
        _serve_as(variables, name, serve)


def as_object(value: Value) -> Any:
    """The object that a student would use for a value, also inside a tuple."""
    return tuple(map(as_object, value)) if isinstance(value, (tuple, list)) else as_student_object(value)


def _statements(source: str) -> Iterator[str]:
    """The statements of a cell on their own lines; the whole cell if it is a magic command or cannot be parsed."""
    lines = source.splitlines(keepends=True)
    try:
        body = [] if source.lstrip().startswith("%%") else parse_python(without_magic(source)).body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        body = []
    starts = sorted({min([node.lineno, *(one.lineno for one in getattr(node, "decorator_list", ()))]) for node in body})
    ends = {number for node in body for number in range(node.lineno + 1, (node.end_lineno or node.lineno) + 1)}
    starts = [start for start in starts if start not in ends]  # it begins on the last line of the one before
    for first, last in pairwise([1, *starts[1:], len(lines) + 1]):
        yield "\n" * (first - 1) + "".join(lines[first - 1 : last - 1])


def _set_missing(
    variables: dict[str, Any],
    name: str,
    replacements: Iterable[Replacement],
    serve: Callable[[str], Callable[..., Any]],
) -> bool:
    """Set what replaces a name that the cells did not make; returns whether there is anything."""
    for replacement in replacements:
        if name in replacement.functions:
            _serve_as(variables, name, serve)
            return True
        if name in replacement.right:
            variables[name] = as_object(replacement.right[name])
            return True
    return False


def _replace_made(
    variables: dict[str, Any],
    name: str,
    replacements: Iterable[Replacement],
    serve: Callable[[str], Callable[..., Any]],
) -> None:
    """Replace the value of a name that a statement has just made, or an entry of it, if that is a wrong one."""
    for replacement in replacements:
        if name in replacement.functions:
            _serve_as(variables, name, serve)
            return
        for value_name, wrong in replacement.wrong.items():
            is_named = name == value_name
            if not is_named and name in replacement.kept | replacement.names:
                continue
            holder, keys = (variables, [name]) if is_named else _entries(variables, name)
            for key in keys:
                has_name = is_named or (isinstance(key, str) and key == value_name)
                fitted = _fit(replacement.right[value_name], holder[key], wrong, is_named, has_name)
                if fitted is not None and (has_name or not _has_kept(variables, replacement, wrong)):
                    holder[key] = fitted


def _entries(variables: dict[str, Any], name: str) -> tuple[Any, list[Any]]:
    """A place of values, and their keys: columns of a table, items of a dict or list, attributes, or the name."""
    value = variables[name]
    if type(value).__module__ == "__main__" or type(value) is SimpleNamespace:
        inner = getattr(value, "__dict__", {})
        return inner, list(inner)[:_MAX_ENTRIES]
    if isinstance(value, list):
        return value, list(range(min(len(value), _MAX_ENTRIES)))
    if hasattr(value, "keys") and hasattr(value, "__setitem__"):
        return value, list(value.keys())[:_MAX_ENTRIES]
    return variables, [name]


def _has_kept(variables: Mapping[str, Any], one: Replacement, wrong: Value) -> bool:
    """Whether a name that keeps its value has the wrong one, such as a signal of the record with its offset."""
    return any(_fit(wrong, variables[name], wrong, True) is not None for name in one.kept & variables.keys())


def _serve_as(variables: dict[str, Any], name: str, serve: Callable[[str], Callable[..., Any]]) -> None:
    """Set a served function, also under other names for the function that it replaces."""
    old = variables.get(name)
    names = [other for other, value in variables.items() if value is old] if callable(old) else []
    variables.update(dict.fromkeys((name, *names), serve(name)))


def _fit(right: Value, own: object, wrong: Value, is_named: bool, has_name: bool | None = None) -> Any:
    """The right value, if the student's own is the wrong one; None if it is another one.

    In any place but the variable that is asked for, it has the shape of the student's own. What does not have its name
    must not equal it by chance.
    """
    has_name = is_named if has_name is None else has_name
    value = plain(own.to_numpy() if hasattr(own, "to_numpy") else own)
    if not (_is_numeric(value) and _is_numeric(wrong)):
        return as_object(right) if is_named and type(value) is type(wrong) and not _is_numeric(wrong) else None
    a, b = np.asarray(value), np.asarray(wrong)
    if a.size != b.size or not np.array_equal(a.ravel(), b.ravel(), equal_nan=True):
        return None
    if not has_name and (np.ptp(a) == 0 if a.size > 1 else a.size == 0 or _is_simple(a.ravel()[0])):
        return None
    if not is_named and isinstance(right, np.ndarray) and right.size == a.size:
        return np.array(right).reshape(a.shape)
    return as_object(right)


def _is_simple(number: Any) -> bool:
    return abs(number) < 10.0**_SIMPLE_DIGITS and bool(np.round(number, _SIMPLE_DIGITS) == number)


def _is_numeric(value: Value) -> bool:
    return isinstance(value, (bool, int, float, complex, np.ndarray))
