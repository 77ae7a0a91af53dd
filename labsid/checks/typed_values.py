"""Values that were typed in: which they are, and whether they are right on another record.

Grading runs a notebook on records that nobody has seen. In the notebook a public one takes their place. No code of the
student runs there: a typed-in value is the same on every record, and all others are taken to be right.
"""

import ast
import tempfile
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from labsid.checks.cell_names import parse_python
from labsid.checks.other_records import another_record, can_be_drawn
from labsid.checks.permitted import without_magic
from labsid.checks.question import Assignment, FollowsFrom, Question
from labsid.checks.reference_values import ReferenceAsk, find_reference_values
from labsid.checks.values import Value, plain
from labsid.checks.verdict import NoAnswer, Verdict
from labsid.records.record import Record, load_record

PUBLIC_ENTROPY = 2018
"""Seed of the record that takes the place of the hidden ones in a notebook."""

_MAKERS = frozenset(
    ("array", "asarray", "column_stack", "reshape", "float", "int", "float64", "list", "tuple", "matrix", "c_", "r_")
)
"""What makes a value of literals alone."""


def typed_names(source: str, names: Iterable[str]) -> frozenset[str]:
    """The names to which a cell gives a value that is written in it, and that no code computes.

    Parameters
    ----------
    source : str
        Text of a code cell.
    names : iterable of str
        The names to look for.

    Returns
    -------
    frozenset of str
    """
    try:
        body = parse_python(without_magic(source)).body
    except (SyntaxError, ValueError, RecursionError):
        return frozenset()
    is_typed: dict[str, bool] = {}
    for statement in body:
        for name, value in _assignments(statement):
            is_typed[name] = value is not None and _is_written(value)
    return frozenset(name for name in names if is_typed.get(name, False))


def _assignments(statement: ast.stmt) -> Iterable[tuple[str, ast.expr | None]]:
    """The names that a statement assigns, each with the expression of its value; None where that is not known."""
    if isinstance(statement, ast.Assign):
        for target in statement.targets:
            yield from _pairs(target, statement.value)
    elif isinstance(statement, ast.AnnAssign):
        yield from _pairs(statement.target, statement.value)
    else:
        stored = (node for node in ast.walk(statement) if isinstance(node, ast.Name))
        yield from ((node.id, None) for node in stored if isinstance(node.ctx, ast.Store))


def _pairs(target: ast.expr, value: ast.expr | None) -> Iterable[tuple[str, ast.expr | None]]:
    if isinstance(target, ast.Name):
        yield target.id, value
    elif isinstance(target, ast.Tuple | ast.List):  # brackets: Python nests them 200 deep at most
        parts = value.elts if isinstance(value, ast.Tuple | ast.List) else []
        single = parts if len(parts) == len(target.elts) else [value] * len(target.elts)
        for one, part in zip(target.elts, single, strict=True):
            yield from _pairs(one, part)
    else:  # an element or an attribute is changed
        yield from ((node.id, None) for node in ast.walk(target) if isinstance(node, ast.Name))


def _is_written(value: ast.expr) -> bool:
    """Whether an expression is made of numbers and texts, and of what puts them into arrays, alone."""
    waiting = [value]
    while waiting:
        parts = _parts_written(waiting.pop())
        if parts is None:
            return False
        waiting += parts
    return True


def _parts_written(value: ast.expr) -> list[ast.expr] | None:
    """The parts of an expression that must be written for it to be; None if it is computed in any case."""
    if isinstance(value, ast.Constant):
        return []
    if isinstance(value, ast.Tuple | ast.List | ast.Set):
        return value.elts
    if isinstance(value, ast.UnaryOp):
        return [value.operand]
    if isinstance(value, ast.BinOp):
        return [value.left, value.right]
    if isinstance(value, ast.Starred):
        return [value.value]
    if isinstance(value, ast.Subscript):  # np.r_[1, 2]
        return [value.slice] if isinstance(value.value, ast.Attribute) and value.value.attr in _MAKERS else None
    if isinstance(value, ast.Call):
        function = value.func
        named = function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")
        owner = function.value if isinstance(function, ast.Attribute) else None
        owners = [] if owner is None or isinstance(owner, ast.Name) else [owner]
        keywords = [one.value for one in value.keywords if one.arg not in ("dtype", "ndmin", "copy")]
        return [*owners, *keywords, *value.args] if named in _MAKERS else None
    return None


def wrong_elsewhere(
    question: Question,
    assignment: Assignment,
    record: Record | None,
    typed: Iterable[str],
    variables: Mapping[str, Any],
    call: Callable[..., Value],
) -> bool:
    """Whether an answer with these typed-in values is wrong on another record, where it is right with right values.

    Parameters
    ----------
    question : Question
    assignment : Assignment
    record : Record or None
        The student's own.
    typed : iterable of str
        Names of the typed-in values.
    variables : mapping
        The notebook's variables.
    call : callable
        Calls a function of the student's: ``call(name, *arguments)``.

    Returns
    -------
    bool
        False, too, where it cannot be told: without another record, or a right value of another variable.
    """
    name, typed = assignment.record_file, frozenset(typed)
    is_asked = question.follows_from is FollowsFrom.DATA and bool(typed)
    if not is_asked or record is None or name is None or not can_be_drawn(name):
        return False
    try:
        other = _public_record(name, record)
    except ValueError:
        return False
    right = find_reference_values(assignment, other)
    values = right.get(question.id, {})
    earlier = [one.id for one in assignment.questions[: assignment.questions.index(question)]]
    known = {key: value for one in earlier for key, value in right.get(one, {}).items()}
    mixed = {**known, **values} | {key: plain(variables[key]) for key in typed if key in variables}
    judged = [question.verdict(_AskWith(other, known, one, call)) for one in ({**known, **values}, mixed)]
    return judged[0].passed and not judged[1].passed


class _AskWith(ReferenceAsk):
    """Answers with these values, and with the student's functions."""

    def __init__(
        self, record: Record, known: Mapping[str, Value], values: Mapping[str, Value], call: Callable[..., Value]
    ) -> None:
        super().__init__(record, None, known)
        self._values = values
        self._call = call

    def value(self, name: str) -> Value:
        if name not in self._values:
            raise NoAnswer(f"there is no right value of `{name}`")
        return self._values[name]

    def call(self, name: str, *arguments: Value) -> Value:
        return self._call(name, *arguments)


def _public_record(name: str, own: Record) -> Record:
    with tempfile.TemporaryDirectory(prefix="labsid-") as folder:
        path = Path(folder) / name
        path.write_bytes(another_record(name, own, PUBLIC_ENTROPY))
        return load_record(path)


def told(typed: Iterable[str]) -> Verdict:
    """What a check says of typed-in values that are wrong on another record."""
    names = " and ".join(f"`{name}`" for name in sorted(typed))
    are = "are" if names.count("`") > 2 else "is"
    return Verdict(
        False,
        f"{names} {are} right on your record, but typed in, and wrong on another one. Grading also runs your notebook "
        "on another record, so this would earn nothing: compute it from the record.",
        "typed in",
    )
