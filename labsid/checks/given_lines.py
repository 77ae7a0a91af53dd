"""Lines that the release gives within a cell for answers, and that a student deleted: they are put back."""

import ast

from labsid.checks.cell_names import parse_python
from labsid.checks.cells import is_stub
from labsid.checks.syntax_trees import flat_text

MAX_CHARACTERS = 20_000
"""Longest cell that is looked at; the longest model solution has about 4,000."""


def put_back(released: str, handed_in: str) -> tuple[str, tuple[str, ...]]:
    """Put back the given assignments of a cell for answers whose names the answer does not define.

    A line that the student replaced by another one that defines its names stays replaced.

    Parameters
    ----------
    released : str
        The cell as released.
    handed_in : str
        The cell with the student's answer.

    Returns
    -------
    source : str
        The cell with these lines, each before what follows it in the release.
    lines : tuple of str
        The lines that were put back; empty also if one of the cells cannot be parsed.
    """
    if is_stub(handed_in) or len(handed_in) > MAX_CHARACTERS:
        return handed_in, ()
    try:
        given, own = parse_python(released).body, parse_python(handed_in)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return handed_in, ()
    names, here = _names(own), {_identity(node): node for node in reversed(own.body)}
    lines = handed_in.split("\n")
    put: list[tuple[int, str]] = []
    for place, node in enumerate(given):
        if isinstance(node, ast.Assign) and names.isdisjoint(_targets(node)):
            before, after = (
                [here.get(_identity(given_line)) for given_line in part] for part in (given[:place], given[place:])
            )
            at = next((kept.lineno - 1 for kept in after if kept is not None), len(lines))
            if at == len(lines) and any(map(_is_for_answer, given[place:])):  # the answer goes on after this line
                at = next((kept.end_lineno or 0 for kept in reversed(before) if kept is not None), 0)
            put.append((at, ast.get_source_segment(released, node) or ast.unparse(node)))
    put.sort(key=lambda line: line[0])
    for at, line in reversed(put):
        lines.insert(at, line)
    return "\n".join(lines), tuple(line for _, line in put)


def _identity(node: ast.stmt) -> str:
    """By which a statement is found again: a function by its name, others by what is written."""
    return node.name if isinstance(node, ast.FunctionDef) else flat_text(node)


def _is_for_answer(node: ast.stmt) -> bool:
    """Whether a statement of the release is a place for the answer: a function to complete, `pass` or `...`."""
    is_shown = isinstance(node, ast.Expr) and isinstance(node.value, ast.Call | ast.Name)
    return not isinstance(node, ast.Assign) and not is_shown


def _targets(node: ast.Assign) -> set[str]:
    """Names that an assignment sets or changes, as ``theta`` in ``theta[1] = 0``."""
    return {part.id for target in node.targets for part in ast.walk(target) if isinstance(part, ast.Name)}


def _names(tree: ast.AST) -> set[str]:
    """Names that a piece of code defines anywhere in it."""
    found = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
    return found | {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.ClassDef)}
