"""The definitions in a code cell: what it provides for later cells, without what it computes and draws."""

import ast
from collections import Counter
from functools import lru_cache

from labsid.checks.cell_names import parse_python


@lru_cache(maxsize=1024)
def definitions_in(source: str) -> str:
    """The imports, functions, classes and constants of a cell of the course, as source.

    Parameters
    ----------
    source : str
        Text of a code cell; lines with a magic command are left out.

    Returns
    -------
    str
        Its definitions, in their order; empty if there are none. A constant is a name that the cell assigns only once,
        to a number, a text or an existing object: ``inv = np.linalg.inv``.
    """
    tree = _parse(source)
    bound = Counter(
        node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
    )
    return "\n\n".join(ast.unparse(node) for node in tree.body if _is_definition(node, bound))


@lru_cache(maxsize=1024)
def defined_functions(source: str) -> tuple[str, ...]:
    """Names of the functions that a cell defines."""
    return tuple(node.name for node in _parse(source).body if isinstance(node, ast.FunctionDef))


def _parse(source: str) -> ast.Module:
    lines = source.splitlines()
    return parse_python("\n".join("" if line.startswith(("%", "!")) else line for line in lines))


def _is_definition(node: ast.stmt, bound: Counter[str]) -> bool:
    if isinstance(node, ast.Assign):
        names = [name for target in node.targets for name in getattr(target, "elts", [target])]
        once = all(isinstance(name, ast.Name) and bound[name.id] == 1 for name in names)
        return once and _is_constant(node.value)
    return isinstance(node, (ast.Import, ast.ImportFrom, ast.FunctionDef, ast.ClassDef))


def _is_constant(node: ast.expr) -> bool:
    if isinstance(node, ast.Tuple):
        return all(map(_is_constant, node.elts))
    if isinstance(node, ast.UnaryOp):
        return _is_constant(node.operand)
    if isinstance(node, ast.Attribute):
        return isinstance(node.value, ast.Name) or _is_constant(node.value)
    return isinstance(node, ast.Constant)
