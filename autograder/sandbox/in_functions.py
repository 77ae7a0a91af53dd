"""Inside the functions, blocks and loops of a cell: where a statement makes a value, the value passes through a hook.

A student who puts the whole notebook into one function, class, block or loop loses no more by a wrong step than one who
does not.
"""

import ast
import builtins
import itertools
from collections.abc import Collection, Iterable, Iterator
from typing import Any

from labsid.checks.syntax_trees import in_order, stored_name

HOOK = "_labsid_made"
RESCUE = "_labsid_missing"
SEEN = "_labsid_seen"

_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)
_BLOCKS = (ast.If, ast.With, ast.AsyncWith, ast.Try, ast.ExceptHandler, ast.Match, ast.match_case)
_LOOPS = (ast.For, ast.AsyncFor, ast.While)
_INNER = (*_FUNCTIONS, ast.ClassDef, ast.Lambda, ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)
_KEYS = itertools.count()  # of statements in loops


_MOST_NESTED = 10
"""Blocks in blocks that are changed. Python nests 20 loops and ``try`` at most, and any number of ``elif``."""


class ThroughHooks:
    """Passes what statements make through two hooks, ``made(name, value, locals)`` and ``missing(name)``.

    In a loop, only what a statement makes the first time passes: a later pass may go on from a value that was replaced,
    as an iteration does. Each statement that is alone in what is run is one.

    Parameters
    ----------
    left : collection of str
        Functions that stay as they are: those that a question asks for, and given ones.
    replaced : collection of str
        Names for which there is a right value. A statement that makes nothing else, and fails, does not stop the rest.
    """

    def __init__(self, left: Collection[str], replaced: Collection[str]) -> None:
        self._left = left
        self._replaced = replaced

    def change(self, tree: ast.Module) -> None:
        """Change the functions, methods and blocks of a cell; what is added has the places of what it follows."""
        if len(tree.body) == 1:
            self._change_inner(tree.body[0], None)
        else:
            tree.body = list(self._changed(tree.body, None))

    def _changed(
        self, body: Iterable[ast.stmt], bound: Collection[str] | None, in_loop: bool = False, nested: int = 0
    ) -> Iterator[ast.stmt]:
        """Statements with hooks; `bound` are the names of their function, or None outside of functions."""
        for statement in body:
            names = sorted(made_by(statement))
            self._change_inner(statement, bound, in_loop, nested)
            is_bound = bound is None or set(names) <= set(bound)
            if names and isinstance(statement, ast.Assign | ast.AnnAssign) and is_bound and not in_loop:
                yield self._rescued(statement, names)
            else:
                yield statement
            hooks = [hook for name in names for hook in _hook(name, bound is None or name in bound)]
            if hooks and in_loop:
                key = next(_KEYS)
                once = ast.parse(f"if {key} not in {SEEN}:\n    {SEEN}.add({key})").body
                once[0].body += hooks  # type: ignore[attr-defined]
                hooks = once
            for hook in hooks:
                yield _placed(hook, statement)

    def _change_inner(
        self, node: ast.AST, bound: Collection[str] | None, in_loop: bool = False, nested: int = 0
    ) -> None:
        """Change the bodies within a statement."""
        nested += 1
        if nested > _MOST_NESTED:
            return
        if isinstance(node, _FUNCTIONS):
            if node.name not in self._left:
                node.body = list(self._changed(node.body, _bound(node), nested=nested))
        elif isinstance(node, ast.ClassDef):
            for child in node.body:
                if isinstance(child, _FUNCTIONS):
                    self._change_inner(child, None, nested=nested)
        elif isinstance(node, (*_BLOCKS, *_LOOPS)):
            in_loop |= isinstance(node, _LOOPS)
            for part in ("body", "orelse", "finalbody"):
                if getattr(node, part, None):
                    setattr(node, part, list(self._changed(getattr(node, part), bound, in_loop, nested)))
            for part in ("handlers", "cases"):
                for child in getattr(node, part, ()):
                    self._change_inner(child, bound, in_loop, nested)

    def _rescued(self, statement: ast.stmt, names: Collection[str]) -> ast.stmt:
        if not set(names) <= set(self._replaced):
            return statement
        handler = ast.parse("\n".join(f"{name} = {RESCUE}({name!r})" for name in names)).body
        caught = ast.ExceptHandler(ast.Name("Exception", ast.Load()), None, handler)
        return ast.copy_location(ast.Try([statement], [_placed(caught, statement)], [], []), statement)


def _placed(added: ast.AST, statement: ast.stmt) -> Any:
    """What is added to a cell, at the place of a statement of it."""
    for node in ast.walk(added):
        ast.copy_location(node, statement)
    return added


def set_hooks(made: Any, missing: Any) -> None:
    """Set what is done with a value, and where none was made."""
    setattr(builtins, HOOK, made)
    setattr(builtins, RESCUE, missing)
    setattr(builtins, SEEN, set())


def made_by(node: ast.AST) -> frozenset[str]:
    """The names that a statement assigns or changes by an assignment, outside the functions in it."""
    return frozenset(_stored(node, with_changed=True))


def _hook(name: str, is_bound: bool) -> list[ast.stmt]:
    """The call of the hook for a name, which a statement may have left unbound."""
    value = f"{HOOK}({name!r}, {name}, locals())"
    return ast.parse(f"try:\n    {name} = {value}\nexcept NameError:\n    pass" if is_bound else value).body


def _bound(function: ast.FunctionDef | ast.AsyncFunctionDef) -> frozenset[str]:
    """The names that a function may assign: it does so itself, or they are its arguments."""
    arguments = function.args
    given = (one.arg for one in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs))
    return frozenset((*given, *(name for one in function.body for name in _stored(one, with_changed=False))))


def _stored(node: ast.AST, with_changed: bool) -> Iterator[str]:
    for one in in_order(node, _INNER):
        name = stored_name(one, with_changed)
        if name is not None:
            yield name
