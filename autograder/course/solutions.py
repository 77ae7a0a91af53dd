"""What grading reads from the notebooks with solutions: the right functions, and nbgrader's hidden tests.

The functions of the model solution replace a student's wrong ones where later steps call them.
"""

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path

import nbformat

from autograder.course.definitions import defined_functions, definitions_in
from autograder.course.layout import Course
from labsid.checks.cells import HIDDEN_DELIMITERS, Template, read_cell


def right_functions(course: Course, template: Template) -> Mapping[str, str]:
    """Source of the functions that the model solution defines, by the question that asks for them.

    Parameters
    ----------
    course : Course
    template : Template

    Returns
    -------
    mapping
        Without the questions whose solution defines no function; empty if the course is here without its solutions.
    """
    name = template.assignment
    path = course.source / name / f"{name}.ipynb"
    return _read_functions(path, path.stat().st_mtime_ns) if path.is_file() else {}


def hidden_tests(course: Course, template: Template) -> Mapping[str, str]:
    """Source of the test cells of nbgrader with hidden tests, by their question; empty without the solutions."""
    name = template.assignment
    path = course.source / name / f"{name}.ipynb"
    return _read_hidden_tests(path, path.stat().st_mtime_ns) if path.is_file() else {}


@lru_cache(maxsize=64)
def _read_hidden_tests(path: Path, changed_ns: int) -> Mapping[str, str]:
    """The hidden tests in a notebook with solutions, cached until it changes."""
    cells = map(read_cell, nbformat.reads(path.read_text(encoding="utf-8"), as_version=4).cells)
    tests = (cell for cell in cells if cell is not None and cell.kind == "tests")
    return {cell.id: cell.source for cell in tests if HIDDEN_DELIMITERS[0] in cell.source}


@lru_cache(maxsize=64)
def _read_functions(path: Path, changed_ns: int) -> Mapping[str, str]:
    """The functions in a notebook with solutions, cached until it changes."""
    found: dict[str, str] = {}
    answers: list[str] = []
    for cell in map(read_cell, nbformat.reads(path.read_text(encoding="utf-8"), as_version=4).cells):
        if cell is None or not cell.code:
            continue
        if cell.kind == "answer":
            answers.append(cell.source)
        elif cell.kind in ("question", "tests"):
            source = "\n\n".join(definitions_in(answer) for answer in answers if defined_functions(answer))
            if source:
                found[cell.id] = source
            answers = []
    return found
