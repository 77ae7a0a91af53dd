"""Lines that the release gives within a cell for answers, and that a student deleted: they are put back."""

import ast

from autograder.course.sources import parse_python
from labsid.checks.cells import is_stub

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
        The cell with these lines, each before or after the answer as in the release.
    lines : tuple of str
        The lines that were put back; empty also if one of the cells cannot be parsed.
    """
    if is_stub(handed_in) or len(handed_in) > MAX_CHARACTERS:
        return handed_in, ()
    try:
        given, own = parse_python(released).body, _names(parse_python(handed_in))
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return handed_in, ()
    answer = next((place for place, node in enumerate(given) if _is_for_answer(node)), len(given))
    missing = {
        place: ast.unparse(node)
        for place, node in enumerate(given)
        if isinstance(node, ast.Assign) and own.isdisjoint(_targets(node))
    }
    before = [line for place, line in missing.items() if place < answer]
    after = [line for place, line in missing.items() if place > answer]
    return "\n".join([*before, handed_in, *after]), tuple(before + after)


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
