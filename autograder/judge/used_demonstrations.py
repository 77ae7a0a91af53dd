"""Demonstrations that an answer needs: cells that grading leaves out, and whose values the answer uses."""

import ast
from collections.abc import Iterable, Sequence
from dataclasses import replace

from autograder.course.definitions import definitions_in
from autograder.intake.submission import NotebookCell
from labsid.checks.cell_names import parse_python

MAX_CHARACTERS = 200_000
"""Longest code of all cells that is looked at."""


def with_used_demonstrations(cells: Sequence[NotebookCell]) -> tuple[NotebookCell, ...]:
    """The cells, those demonstrations as given cells whose computed values a student's cell uses.

    Parameters
    ----------
    cells : sequence of NotebookCell
        All cells of a submission.

    Returns
    -------
    tuple of NotebookCell
        As they are if no demonstration is used, or a cell cannot be parsed: then its author has no value of it either.
    """
    used = _used_elsewhere(cells)
    found = list(cells)
    for k in reversed(range(len(cells))):
        cell = cells[k]
        if cell.kind == "demonstration" and cell.code and not used.isdisjoint(_computed(cell.source)):
            found[k] = replace(cell, kind="given")
            # it may itself go on from another one
            used |= _names((cell.source,), ast.Load) - _names((cell.source,), ast.Store)
    return tuple(found)


def _used_elsewhere(cells: Iterable[NotebookCell]) -> set[str]:
    """Names that students' cells read and no cell that is run sets."""
    code = [cell for cell in cells if cell.code]
    if sum(len(cell.source) for cell in code) > MAX_CHARACTERS:
        return set()
    own = [cell.source for cell in code if cell.kind in ("answer", "extra")]
    run = own + [cell.source for cell in code if cell.kind == "given"]
    run += [definitions_in(cell.source) for cell in code if cell.kind == "demonstration"]
    return _names(own, ast.Load) - _names(run, ast.Store)


def _computed(source: str) -> set[str]:
    """Names that a demonstration sets, without those that its definitions set."""
    return _names((source,), ast.Store) - _names((definitions_in(source),), ast.Store)


def _names(sources: Iterable[str], context: type[ast.expr_context]) -> set[str]:
    """Names that pieces of code set or read; of one that cannot be parsed, none."""
    found: set[str] = set()
    for source in sources:
        try:
            tree = parse_python(source)
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            continue
        for node in ast.walk(tree):
            if isinstance(node, ast.Name) and isinstance(node.ctx, context):
                found.add(node.id)
            elif context is ast.Store and isinstance(node, ast.arg):
                found.add(node.arg)
            elif context is ast.Store and isinstance(node, ast.FunctionDef | ast.ClassDef):
                found.add(node.name)
            elif context is ast.Store and isinstance(node, ast.alias):
                found.add((node.asname or node.name).partition(".")[0])
    return found
