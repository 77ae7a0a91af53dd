"""Detect submissions made on another student's record.

The evidence is another student's data file beside the notebook, or a wrong answer that is right on another student's
record to six digits. Only numbers that contain measurement noise count: levels, times and counts are the same on many
records.
"""

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from autograder.batch.grading_inputs import DataStore, GradingInputs, record_path
from autograder.course.own_secret import shared_file
from autograder.intake.submission import is_plain_file
from autograder.judge.outcome import SubmissionResult
from labsid.checks.question import Assignment, Origin
from labsid.checks.reference_values import find_reference_values
from labsid.checks.values import Value
from labsid.records.record import load_record

STUDENT_MESSAGE = "The value is right for another record than the one you were given."
MAX_DATA_BYTES = 16 * 1024 * 1024


def flag_wrong_record(
    result: SubmissionResult, inputs: GradingInputs, data_store: DataStore, folder: Path, members: Iterable[str]
) -> SubmissionResult:
    """Add flags for the instructor and notes for the student to a result made on another student's record.

    Parameters
    ----------
    result : SubmissionResult
    inputs : GradingInputs
        The student's.
    data_store : DataStore
    folder : Path
        The submission.
    members : iterable of str
        IDs of all students.
    """
    name = inputs.assets.assignment.record_file
    if data_store.secret is None or name is None:
        return result
    has_evidence = any(
        _noisy_numbers(value).size for values in result.wrong_values.values() for value in values.values()
    )
    submitted = (path for path in folder.glob(f"*{Path(name).suffix}") if is_plain_file(path, MAX_DATA_BYTES))
    handed_in = {_hash(path) for path in submitted}
    handed_in -= {_hash(inputs.files[name])}
    if not has_evidence and not handed_in:
        return result
    files: set[str] = set()
    answers: dict[str, list[str]] = {}
    others = [member for member in members if member != result.student]
    for owner, path, origin in _other_records(data_store, name, data_store.secret, others):
        if _hash(path) in handed_in:
            files.add(owner)
        right = _right_values(inputs.assets.assignment, path, origin) if has_evidence else {}
        matching = [q for q, values in result.wrong_values.items() if _any_equal(values, right.get(q, {}))]
        if matching:
            answers[owner] = matching
    flags = [f"handed in with the data file of {owner}" for owner in sorted(files)]
    flags += [f"made on the record of {owner}: {', '.join(questions)}" for owner, questions in sorted(answers.items())]
    if handed_in and not files:
        flags.append("handed in with an unknown data file")
    flagged = {question for questions in answers.values() for question in questions}
    notes: tuple[str, ...] = (f"some answers are made on another record than yours ({name})",) if flagged else ()
    if files:
        notes += (f"{name} is not the one that you were given",)
    results = tuple(
        replace(question_result, reason=f"{question_result.reason} {STUDENT_MESSAGE}")
        if question_result.question in flagged
        else question_result
        for question_result in result.results
    )
    return replace(result, results=results, notes=result.notes + notes, flags=result.flags + tuple(flags))


def _other_records(
    data_store: DataStore, name: str, secret: bytes, members: Iterable[str]
) -> Iterable[tuple[str, Path, Origin]]:
    yield "the course's own record", shared_file(data_store.course, name), data_store.shared_origin
    for member in members:
        try:
            yield member, record_path(data_store, name, member), Origin(member, secret)
        except ValueError:  # an ID without a record
            continue


@lru_cache(maxsize=4096)
def _right_values(assignment: Assignment, path: Path, origin: Origin) -> dict[str, dict[str, Value]]:
    return find_reference_values(assignment, load_record(path), origin)


def _any_equal(values: Mapping[str, Value], right: Mapping[str, Value]) -> bool:
    """Whether any value with measurement noise equals the right value of that record."""
    for name, value in values.items():
        expected = right.get(name)
        if not _noisy_numbers(value).size or not isinstance(expected, int | float | np.ndarray):
            continue
        got, other = (np.asarray(numbers, dtype=np.float64).reshape(-1) for numbers in (value, expected))
        if got.size == other.size and np.allclose(got, other, rtol=1e-6, atol=1e-12):
            return True
    return False


def _noisy_numbers(value: Value) -> NDArray[np.float64]:
    """The numbers in a value with more than three decimals: the others are levels, times and counts."""
    if isinstance(value, bool) or not isinstance(value, int | float | np.ndarray):
        return np.empty(0)
    array = np.asarray(value)
    # an array without elements may have dimensions that no array of floats can have
    if array.size == 0 or array.dtype.kind not in "iuf" or not np.all(np.isfinite(array)):
        return np.empty(0)
    numbers = array.astype(np.float64).reshape(-1)
    return numbers[np.abs(numbers * 1e3 - np.round(numbers * 1e3)) > 1e-5]


@lru_cache(maxsize=4096)
def _hash_at(path: Path, modified_ns: int) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _hash(path: Path) -> str:
    return _hash_at(path, path.stat().st_mtime_ns)
