"""The cells of a notebook that a hidden run needs, so that it takes less time than the first run.

Both functions err on the safe side: an answer that is wrong after a shortened run is judged again after a whole one.
"""

import ast
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from functools import lru_cache

from autograder.intake.submission import NotebookCell
from labsid.checks.cell_names import assigned_names, bound_names, parse_python, used_names
from labsid.checks.permitted import without_magic

MAX_CONSTANTS = 40
"""Constants in a statement that may draw curves from computed values: fewer than a record has samples by far."""

MAX_TEXT = 120  # characters
_TYPED_NUMBER = re.compile(r"\d[.,]\d\d|\d{3}|\de[+-−]?\d", re.IGNORECASE)
_PACKAGES = frozenset(("numpy", "matplotlib", "scipy", "control", "labsid", "math"))
_OPAQUE = frozenset(
    ("eval", "exec", "compile", "open", "globals", "locals", "vars", "getattr", "__import__", "get_ipython")
)


def cells_needed(
    cells: Sequence[NotebookCell], asked: Collection[str], names: Mapping[str, Iterable[str]]
) -> tuple[NotebookCell, ...]:
    """The cells up to the last question that is asked for, without those on which none of these questions depends.

    Parameters
    ----------
    cells : sequence of NotebookCell
    asked : collection of str
        Ids of the questions.
    names : mapping
        The variables that each question's check reads, by question.

    Returns
    -------
    tuple of NotebookCell
        A cell is kept if it is part of an answer that is asked for, or if it gives a value to a name that a later kept
        cell uses. A value that is changed in place elsewhere is not seen.
    """
    kept: list[NotebookCell] = []
    needed: set[str] = set()
    is_answer = False
    for cell in reversed(cells):
        if cell.kind in ("question", "tests", "manual"):
            is_answer = cell.kind == "question" and cell.id in asked
            if is_answer:
                kept.append(cell)
                needed |= set(names.get(cell.id or "", ()))
            continue
        is_own = is_answer and cell.kind in ("answer", "extra")
        if cell.code and (is_own or not needed.isdisjoint(_given_names(cell.source))):
            kept.append(cell)
            needed |= used_names(cell.source)
    return tuple(reversed(kept))


def draws_known_values(cells: Sequence[NotebookCell], question: str, known: Collection[str]) -> bool:
    """Whether the answer to a question is drawn by code from known values alone, with nothing typed in.

    Parameters
    ----------
    cells : sequence of NotebookCell
    question : str
    known : collection of str
        Names whose values are judged by other questions.

    Returns
    -------
    bool
        Whatever such code draws of the right values of one record, it draws of those of another.
    """
    at = next((k for k, cell in enumerate(cells) if cell.id == question), 0)
    first = next((k for k in range(at - 1, -1, -1) if cells[k].kind in ("question", "tests", "manual")), -1) + 1
    own = [statement for cell in cells[first:at] if cell.code for statement in _statements(cell.source)]
    bindings: dict[str, list[ast.stmt]] = {}
    for cell in cells[:at]:
        for statement in _statements(cell.source) if cell.code else ():
            for name in _bound(statement):
                bindings.setdefault(name, []).append(statement)
    seen = set(known)
    waiting = list(own)
    while waiting:
        statement = waiting.pop()
        if not _is_plain(statement):
            return False
        for name in _read(statement) - seen:
            seen.add(name)
            waiting += bindings.get(name, [])
    return bool(own)


def _given_names(source: str) -> frozenset[str]:
    return assigned_names(source) | bound_names(source)


@lru_cache(maxsize=512)
def _statements(source: str) -> tuple[ast.stmt, ...]:
    """The statements of a cell; one that cannot be a plain one if it cannot be parsed."""
    try:
        return tuple(parse_python(without_magic(source)).body)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return (ast.Global(names=[]),)


def _bound(statement: ast.stmt) -> Iterator[str]:
    for node in ast.walk(statement):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.id
        elif isinstance(node, ast.FunctionDef | ast.ClassDef):
            yield node.name
        elif isinstance(node, ast.Import | ast.ImportFrom):
            yield from (alias.asname or alias.name.partition(".")[0] for alias in node.names)


def _read(statement: ast.stmt) -> set[str]:
    return {node.id for node in ast.walk(statement) if isinstance(node, ast.Name)}


def _is_plain(statement: ast.stmt) -> bool:
    """Whether a statement has no long literal, no number in a text, and nothing that hides what it does."""
    constants = 0
    specs = {id(part) for node in ast.walk(statement) if isinstance(node, ast.FormattedValue) and node.format_spec
             for part in ast.walk(node.format_spec)}  # fmt: skip
    for node in ast.walk(statement):
        if isinstance(node, ast.Global | ast.Nonlocal | ast.ClassDef):
            return False
        if isinstance(node, ast.Import | ast.ImportFrom):
            modules = [node.module or ""] if isinstance(node, ast.ImportFrom) else [alias.name for alias in node.names]
            if not {module.partition(".")[0] for module in modules} <= _PACKAGES:
                return False
        elif isinstance(node, ast.Name) and node.id in _OPAQUE:
            return False
        elif isinstance(node, ast.Constant):
            constants += 1
            if isinstance(node.value, bytes) or constants > MAX_CONSTANTS:
                return False
            if isinstance(node.value, int) and abs(node.value) > 1e6:
                return False
            if isinstance(node.value, str) and id(node) not in specs and _holds_numbers(node.value):
                return False
    return True


def _holds_numbers(text: str) -> bool:
    return len(text) > MAX_TEXT or _TYPED_NUMBER.search(text) is not None
