"""Demonstrations that an answer needs: cells that grading leaves out, and whose values the answer uses."""

from collections.abc import Iterable, Sequence
from dataclasses import replace

from autograder.course.definitions import definitions_in
from autograder.intake.submission import NotebookCell
from labsid.checks.cell_names import bound_names, used_names

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
    kept_cells = list(cells)
    for k in reversed(range(len(cells))):
        cell = cells[k]
        if cell.kind == "demonstration" and cell.code and not used.isdisjoint(_computed(cell.source)):
            kept_cells[k] = replace(cell, kind="given")
            used |= used_names(cell.source)  # it may itself go on from another one
    return tuple(kept_cells)


def _used_elsewhere(cells: Iterable[NotebookCell]) -> set[str]:
    """Names that students' cells read and no cell that is run gives a value."""
    code = [cell for cell in cells if cell.code]
    if sum(len(cell.source) for cell in code) > MAX_CHARACTERS:
        return set()
    own = [cell.source for cell in code if cell.kind in ("answer", "extra")]
    run = own + [cell.source for cell in code if cell.kind == "given"]
    run += [definitions_in(cell.source) for cell in code if cell.kind == "demonstration"]
    return set().union(*map(used_names, own)).difference(*map(bound_names, run))


def _computed(source: str) -> frozenset[str]:
    """Names to which a demonstration gives a value, without those of its definitions."""
    return bound_names(source) - bound_names(definitions_in(source))
