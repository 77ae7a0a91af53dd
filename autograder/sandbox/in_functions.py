"""Inside the functions of a cell: where a statement makes a local value, the value passes through a hook.

A student who puts the whole notebook into one function loses no more by a wrong step than one who does not.
"""

import ast
import builtins
from collections.abc import Collection, Iterable, Iterator
from typing import Any

HOOK = "_labsid_made"
RESCUE = "_labsid_missing"


class ThroughHooks(ast.NodeTransformer):
    """Passes what statements of functions make through two hooks, ``made(name, value, locals)`` and ``missing(name)``.

    Parameters
    ----------
    left : collection of str
        Functions that stay as they are: those that a question asks for, and given ones.
    replaced : collection of str
        Names for which there is a right value. A statement that makes nothing else, and fails, does not stop it.
    """

    def __init__(self, left: Collection[str], replaced: Collection[str]) -> None:
        self._left = left
        self._replaced = replaced

    def visit_Module(self, node: ast.Module) -> ast.Module:
        """Change the functions and methods that are defined in a cell."""
        for statement in node.body:
            for one in statement.body if isinstance(statement, ast.ClassDef) else [statement]:
                if isinstance(one, ast.FunctionDef) and one.name not in self._left:
                    one.body = list(self._changed(one.body, _Own(one)))
        return ast.fix_missing_locations(node)

    def _changed(self, body: Iterable[ast.stmt], own: "_Own") -> Iterator[ast.stmt]:
        for statement in body:
            for part in ("body", "orelse", "finalbody") if isinstance(statement, ast.If | ast.With | ast.Try) else ():
                if getattr(statement, part, None):
                    setattr(statement, part, list(self._changed(getattr(statement, part), own)))
            names = sorted(made_by(statement))
            hooked = [ast.copy_location(one, statement) for name in names for one in own.hook(name)]
            if names and isinstance(statement, ast.Assign | ast.AnnAssign) and own.bound.issuperset(names):
                yield self._rescued(statement, names)
            else:
                yield statement
            yield from hooked

    def _rescued(self, statement: ast.stmt, names: Collection[str]) -> ast.stmt:
        if not set(names) <= set(self._replaced):
            return statement
        handler = ast.parse("\n".join(f"{name} = {RESCUE}({name!r})" for name in names)).body
        caught = ast.ExceptHandler(ast.Name("Exception", ast.Load()), None, handler)
        return ast.copy_location(ast.Try([statement], [caught], [], []), statement)


def set_hooks(made: Any, missing: Any) -> None:
    """Set what is done with a value, and where none was made."""
    setattr(builtins, HOOK, made)
    setattr(builtins, RESCUE, missing)


class _Own:
    """The names that a function binds itself, as a local or as a global one."""

    def __init__(self, function: ast.FunctionDef) -> None:
        nodes = [node for statement in function.body for node in ast.walk(statement)]
        self.bound = {node.id for node in nodes if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
        arguments = function.args
        self.bound |= {one.arg for one in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)}
        self.bound -= {name for node in nodes if isinstance(node, ast.Nonlocal) for name in node.names}

    def hook(self, name: str) -> list[ast.stmt]:
        """The call of the hook for a name, which a statement may have left unbound."""
        value = f"{HOOK}({name!r}, {name}, locals())"
        text = f"try:\n    {name} = {value}\nexcept NameError:\n    pass" if name in self.bound else value
        return ast.parse(text).body


def made_by(node: ast.AST) -> frozenset[str]:
    """The names that a statement assigns or changes by an assignment, outside the functions in it."""
    return frozenset(_made_by(node))


def _made_by(node: ast.AST) -> Iterator[str]:
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef | ast.Lambda):
        return
    if isinstance(node, ast.ListComp | ast.SetComp | ast.DictComp | ast.GeneratorExp):
        return
    if isinstance(node, ast.Name | ast.Attribute | ast.Subscript) and isinstance(node.ctx, ast.Store):
        while isinstance(node, ast.Attribute | ast.Subscript):
            node = node.value
        if isinstance(node, ast.Name):
            yield node.id
        return
    for inner in ast.iter_child_nodes(node):
        yield from _made_by(inner)
