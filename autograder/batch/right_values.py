"""The right values of a student's own record, as text for the pages with model answers."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from autograder.batch.grading_inputs import DataStore, inputs_for
from autograder.course.layout import Course, read_template
from labsid.checks.reference_values import find_reference_values
from labsid.checks.values import Value


def find_right_values(
    course: Course, out: Path, secret: bytes | None, student: str, assignment: str
) -> Mapping[str, Mapping[str, str]]:
    """The right values that are numbers or texts, by question and name.

    Parameters
    ----------
    course : Course
        Built.
    out : Path
        A folder that ``labsid course grade`` wrote, with its cache of records.
    secret : bytes or None
        The secret of individual records.
    student, assignment : str

    Returns
    -------
    dict
        Empty if the assignment has no record, or the student's record is not known here.
    """
    if secret is None and (out / ".secret").is_file():
        return {}
    try:
        assets = inputs_for(
            DataStore(course, secret, out / "records"), read_template(course, assignment), student
        ).assets
    except ValueError:  # the course is not built here, or there is no record for this ID
        return {}
    if assets.record is None:
        return {}
    right_values = find_reference_values(assets.assignment, assets.record, assets.origin)
    return {question: _as_text(values) for question, values in right_values.items()}


def _as_text(values: Mapping[str, Value]) -> dict[str, str]:
    texts = {}
    for name, value in values.items():
        if isinstance(value, str):
            texts[name] = value
        elif isinstance(value, int | float | np.ndarray) and np.ndim(value) == 0:
            texts[name] = f"{float(value):.4g}"
    return texts
