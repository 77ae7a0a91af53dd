"""Export of grades and feedback to Moodle.

The offline grading worksheet is written as it was downloaded, with the columns Grade and Feedback comments filled in.
"Last modified (grade)" is not changed, because Moodle rejects grades that were modified after the download. The
feedback is a zip file with a folder ``Full Name_123456_assignsubmission_file_`` for each participant.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import ROUND_HALF_UP, Decimal, InvalidOperation
from pathlib import Path

from autograder.course.plain_text import one_line, plain_decimal
from autograder.intake.worksheet import (
    CHANGEABLE,
    FEEDBACK,
    FULL_NAME,
    GRADE,
    MAXIMUM,
    Worksheet,
    participant_number,
    possible_ids,
    worksheet_text,
)
from autograder.results import gradebook, grades, result_files
from autograder.results.feedback import write_feedback
from autograder.results.grades import Totals, write_grades
from autograder.results.result_files import StoredResult
from labsid._files import write_file, zip_bytes

_CENT = Decimal("0.01")


@dataclass(frozen=True, slots=True)
class MoodleExport:
    """The files written, and remarks for the instructor.

    Attributes
    ----------
    worksheet, feedback : Path
    filled : int
        Number of rows with a grade.
    remarks : tuple of str
    """

    worksheet: Path
    feedback: Path
    filled: int
    remarks: tuple[str, ...]


def export_moodle(out: Path, sheet: Worksheet, assignment: str | None = None) -> MoodleExport:
    """Write ``OUT/moodle/worksheet.csv`` and ``OUT/moodle/feedback.zip``.

    Parameters
    ----------
    out : Path
        A folder that ``labsid course grade`` wrote.
    sheet : Worksheet
        As downloaded.
    assignment : str, optional
        The assignment of the worksheet; default all graded assignments, added up.

    Returns
    -------
    Exported

    Raises
    ------
    ValueError
        If OUT has no results of that assignment, or the worksheet lacks the columns to fill in.
    """
    missing = [column for column in (GRADE, FEEDBACK) if column not in sheet.columns]
    if missing:
        raise ValueError(
            f"the worksheet has no column {' and no column '.join(missing)}. In Moodle, enable the feedback types "
            "'Feedback comments' and 'Offline grading worksheet', and download it again."
        )
    stored = [one for one in result_files.load_all(out) if assignment in (None, one.assignment)]
    if not stored:
        raise ValueError(f"{out} holds no results of {assignment!r}.")
    manual = gradebook.read_manual_grades(out).scores
    by_student: dict[str, list[StoredResult]] = {}
    for one in stored:
        by_student.setdefault(one.student, []).append(one)
    names = {student.casefold(): student for student in by_student}
    pages = {(path.parent.name, path.stem): path.read_bytes() for path in write_feedback(out)}
    rows: list[dict[str, str]] = []
    files: dict[str, bytes] = {}
    found: set[str] = set()
    remarks: list[str] = []
    for row in sheet.rows:
        student = next((names[one.casefold()] for one in possible_ids(row) if one.casefold() in names), None)
        if student is None:
            rows.append(row)
            continue
        found.add(student)
        marks = _sum_totals([grades.totals(one, manual) for one in by_student[student]])
        filled, remark = _fill_in(row, marks, by_student[student])
        rows.append(filled)
        remarks += [f"{student}: {remark}"] if remark else []
        folder = _participant_folder(row)
        mine = [one.assignment for one in by_student[student]]
        for name in mine:
            page = "feedback.html" if len(mine) == 1 else f"feedback-{name}.html"
            files[f"{folder}/{page}"] = pages[student, name]
    remarks += [f"{student}: not in the worksheet" for student in by_student if student not in found]
    target = out / "moodle"
    target.mkdir(parents=True, exist_ok=True)
    write_file(target / "worksheet.csv", worksheet_text(sheet, rows).encode(errors="backslashreplace"))
    write_file(target / "feedback.zip", zip_bytes(files))
    write_grades(out)
    return MoodleExport(target / "worksheet.csv", target / "feedback.zip", len(found), tuple(map(one_line, remarks)))


def _sum_totals(totals: Sequence[Totals]) -> Totals:
    parts = ((one.score, one.max_score, one.waiting, one.penalty) for one in totals)
    return Totals(*(sum(column, Decimal(0)) for column in zip(*parts, strict=True)))


def _fill_in(row: Mapping[str, str], marks: Totals, stored: Sequence[StoredResult]) -> tuple[dict[str, str], str]:
    """A row with its grade on the worksheet's scale, and a remark."""
    if row.get(CHANGEABLE, "Yes").strip().casefold() == "no":
        return dict(row), "the grade is locked in Moodle and was not changed"
    maximum = _maximum_grade(row.get(MAXIMUM, ""))
    score, remark = marks.score, ""
    total = f"{plain_decimal(marks.score)} of {plain_decimal(marks.max_score)}"
    if maximum is not None and maximum != marks.max_score and marks.max_score:
        score = (marks.score * maximum / marks.max_score).quantize(_CENT, ROUND_HALF_UP)
        remark = f"{total} is {plain_decimal(score)} of {maximum}"
    if marks.waiting:
        waiting = f"{plain_decimal(marks.waiting)} marks not yet graded by hand"
        remark = f"{remark}; {waiting}" if remark else waiting
    return {**row, GRADE: plain_decimal(score), FEEDBACK: _comment(marks, stored)}, remark


def _comment(marks: Totals, stored: Sequence[StoredResult]) -> str:
    parts = [f"{plain_decimal(marks.score)} of {plain_decimal(marks.max_score)} marks."]
    if marks.waiting:
        parts.append(f"{plain_decimal(marks.waiting)} marks not yet graded by hand.")
    parts += [one.late for one in stored if one.late]
    parts += [f"{one.assignment}: {one.questions[0].status}." for one in stored if one.is_refused]
    slips = dict.fromkeys(question.slip for one in stored for question in one.questions if question.slip)
    if slips:
        parts.append(f"Common mistakes: {'; '.join(filter(None, slips))}.")
    parts.append("See the feedback file for details.")
    return one_line(" ".join(parts))


def _maximum_grade(text: str) -> Decimal | None:
    try:
        value = Decimal(text.strip())
    except InvalidOperation:
        return None
    return value if value.is_finite() and value > 0 else None


def _participant_folder(row: Mapping[str, str]) -> str:
    """The participant's folder, as Moodle names it."""
    name = re.sub(r"[\x00-\x1f/\\:*?\"<>|]", "", row.get(FULL_NAME, "")).strip(". ") or "Participant"
    return f"{name}_{participant_number(row)}_assignsubmission_file_"
