"""The names that a cell assigns and those that it uses, read from its source."""

import ast
import builtins
import symtable
from collections.abc import Iterator
from functools import lru_cache
from threading import Lock

from labsid.checks.permitted import without_magic
from labsid.checks.syntax_trees import in_order, stored_name

_PARSING = Lock()
_NAMED = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
_CLOSED = (ast.Lambda, ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)


def parse_python(source: str | bytes) -> ast.Module:
    """Parse Python in one thread at a time, because Python 3.11 counts the recursion depth of all threads together.

    Code that is nested too deeply for Python is a `SyntaxError` like others; Python's parser then lacks memory.
    """
    with _PARSING:
        try:
            return ast.parse(source)
        except (MemoryError, RecursionError):
            raise SyntaxError("the code is nested too deeply") from None


def assigned_names(source: str) -> frozenset[str]:
    """The variables of the notebook that a cell assigns or changes in place by an assignment, such as ``y[3] = 0``."""
    tree = _parse(source)
    return frozenset() if tree is None else frozenset(_assigned(tree))


def made_by_calls(source: str) -> frozenset[str]:
    """The names that functions of a cell bind which a statement only calls, such as ``main()``: it may keep them.

    In a cell that uses ``globals()``, these are all of its functions.
    """
    tree = _parse(source)
    if tree is None:
        return frozenset()
    callers = (statement for statement in tree.body if isinstance(statement, ast.Expr | ast.If))
    called = {node.id for caller in callers for node in ast.walk(caller) if isinstance(node, ast.Name)}
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)]
    kept = (
        functions
        if "globals" in read_names(source)
        else [function for function in functions if function.name in called]
    )
    return frozenset(name for function in kept for statement in function.body for name in _assigned(statement))


def used_names(source: str) -> frozenset[str]:
    """The variables of the notebook that a cell uses, also inside its functions, and does not assign itself."""
    top = _symbols(source)
    return frozenset() if top is None else frozenset(_globals_of(top)) - _bound(top) - set(dir(builtins))


@lru_cache(maxsize=1024)
def read_names(source: str) -> frozenset[str]:
    """The names whose value some code of a cell reads, also inside its functions; comments and texts do not count."""
    tree = _parse(source)
    if tree is None:
        return frozenset()
    names = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and not isinstance(node.ctx, ast.Store)}
    changed = (node.target for node in ast.walk(tree) if isinstance(node, ast.AugAssign))
    return frozenset(names | {target.id for target in changed if isinstance(target, ast.Name)})


def bound_names(source: str) -> frozenset[str]:
    """The variables, functions, classes and modules that a cell gives a name, outside its functions."""
    top = _symbols(source)
    return frozenset() if top is None else _bound(top)


def _parse(source: str) -> ast.Module | None:
    try:
        return parse_python(without_magic(source))
    except (SyntaxError, ValueError, RecursionError):
        return None


def _symbols(source: str) -> symtable.SymbolTable | None:
    try:
        with _PARSING:
            return symtable.symtable(without_magic(source), "cell", "exec")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None


def _bound(top: symtable.SymbolTable) -> frozenset[str]:
    return frozenset(one.get_name() for one in top.get_symbols() if one.is_assigned() or one.is_imported())


def _globals_of(top: symtable.SymbolTable) -> Iterator[str]:
    waiting = [top]
    while waiting:
        table = waiting.pop()
        for symbol in table.get_symbols():
            if symbol.is_referenced() and (table.get_type() == "module" or symbol.is_global()):
                yield symbol.get_name()
        waiting += table.get_children()


def _assigned(root: ast.AST) -> Iterator[str]:
    """Names that are assigned outside functions, classes and comprehensions."""
    for node in in_order(root, (*_NAMED, *_CLOSED)):
        if isinstance(node, _NAMED):
            yield node.name
        elif isinstance(node, ast.Import | ast.ImportFrom):
            yield from (alias.asname or alias.name.partition(".")[0] for alias in node.names)
        elif (name := stored_name(node)) is not None:
            yield name
