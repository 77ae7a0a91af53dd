"""Export of grades and feedback to Moodle.

The offline grading worksheet is written as it was downloaded, with the columns Grade and Feedback comments filled in.
"Last modified (grade)" is not changed, because Moodle rejects grades that were modified after the download. The
feedback is a zip file with a folder ``Full Name_123456_assignsubmission_file_`` for each participant.
"""

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal, InvalidOperation
from pathlib import Path

from autograder.course.plain_text import one_line, plain_decimal
from autograder.course.students import known_students
from autograder.export.sums import factors_of, rounded, sum_totals
from autograder.intake.identity import identify
from autograder.intake.worksheet import (
    CHANGEABLE,
    FEEDBACK,
    GRADE,
    MAXIMUM,
    Worksheet,
    participant_folder,
    participant_number,
    worksheet_text,
)
from autograder.results import gradebook, grades, result_files
from autograder.results.feedback import FeedbackTexts, write_feedback
from autograder.results.grades import Totals, write_grades
from autograder.results.result_files import StoredResult
from labsid._files import write_file, zip_bytes

_NOTHING = "Nothing was handed in."


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


def export_moodle(
    out: Path,
    sheet: Worksheet,
    *assignments: str,
    weights: Mapping[str, Decimal] | None = None,
    scale: bool = False,
    zero: bool = False,
    texts: FeedbackTexts | None = None,
) -> MoodleExport:
    """Write ``OUT/moodle/worksheet.csv`` and ``OUT/moodle/feedback.zip``.

    Parameters
    ----------
    out : Path
        A folder that ``labsid course grade`` wrote.
    sheet : Worksheet
        As downloaded.
    *assignments : str
        The assignments of the worksheet, added up; default all graded ones.
    weights : mapping, optional
        Marks in the sum, by assignment; default those of the notebook. One assignment alone has no weight.
    scale : bool
        Whether to convert the marks to the worksheet's maximum.
    zero : bool
        Whether rows without a hand-in and without a grade get 0 marks; otherwise they are not changed.
    texts : FeedbackTexts, optional
        For the feedback pages.

    Returns
    -------
    MoodleExport

    Raises
    ------
    ValueError
        If OUT has no results of an assignment, the worksheet lacks the columns to fill in, or its maximum is not the
        sum of the marks and they are not to be scaled, or it is not clear who is who.
    """
    missing = [column for column in (GRADE, FEEDBACK) if column not in sheet.columns]
    if missing:
        raise ValueError(
            f"the worksheet has no column {' and no column '.join(missing)}. In Moodle, enable the feedback types "
            "'Feedback comments' and 'Offline grading worksheet', and download it again."
        )
    everything = result_files.load_all(out)
    graded = {result.assignment for result in everything}
    absent = [name for name in assignments if name not in graded]
    if absent:
        raise ValueError(f"{out} holds no results of {absent[0]!r}.")
    stored = [result for result in everything if not assignments or result.assignment in assignments]
    factors = factors_of(stored, weights or {})
    maximum = sum((most * factor for most, factor in factors.values()), Decimal(0))
    who = identify(sheet, known_students(out, {result.student for result in everything}))
    if not scale:
        _require_maximum(out, sheet, assignments, factors, maximum)
    manual = gradebook.read_manual_grades(out).scores
    by_student: dict[str, list[StoredResult]] = {}
    for result in stored:
        by_student.setdefault(result.student, []).append(result)
    pages = {(path.parent.name, path.stem): path.read_bytes() for path in write_feedback(out, texts)}
    rows: list[dict[str, str]] = []
    files: dict[str, bytes] = {}
    in_worksheet: set[str] = set()
    without_hand_in: list[str] = []
    remarks: list[str] = []
    for row in sheet.rows:
        participant = who.students.get(participant_number(row) or "")
        student = None if participant is None else participant.id
        if student not in by_student:
            is_empty = participant is not None and not row[GRADE].strip(" -") and not _is_locked(row)
            without_hand_in += [str(student)] if is_empty else []
            rows.append({**row, GRADE: "0", FEEDBACK: _NOTHING} if zero and is_empty else row)
            continue
        in_worksheet.add(student)
        marks = sum_totals(
            [(grades.totals(result, manual), factors[result.assignment][1]) for result in by_student[student]]
        )
        filled, remark = _fill_in(row, replace(marks, max_score=maximum), by_student[student])
        rows.append(filled)
        remarks += [f"{student}: {remark}"] if remark else []
        folder = participant_folder(row)
        mine = [result.assignment for result in by_student[student]]
        for name in mine:
            page = "feedback.html" if len(mine) == 1 else f"feedback-{name}.html"
            files[f"{folder}/{page}"] = pages[student, name]
    remarks += [f"{student}: not in the worksheet" for student in by_student if student not in in_worksheet]
    if without_hand_in:
        given = "0 marks were given" if zero else "the grade is left empty; --zero gives 0 marks"
        remarks.append(f"nothing handed in ({given}): {', '.join(without_hand_in)}")
    target = out / "moodle"
    target.mkdir(parents=True, exist_ok=True)
    write_file(target / "worksheet.csv", worksheet_text(sheet, rows).encode(errors="backslashreplace"))
    write_file(target / "feedback.zip", zip_bytes(files))
    write_grades(out)
    return MoodleExport(
        target / "worksheet.csv", target / "feedback.zip", len(in_worksheet), tuple(map(one_line, remarks))
    )


def _require_maximum(
    out: Path,
    sheet: Worksheet,
    assignments: Sequence[str],
    factors: Mapping[str, tuple[Decimal, Decimal]],
    maximum: Decimal,
) -> None:
    """Refuse a worksheet with another maximum, and say what to type."""
    asked = {value for row in sheet.rows if (value := _maximum_grade(row.get(MAXIMUM, ""))) is not None}
    other_maxima = sorted(asked - {maximum})
    if not other_maxima:
        return
    command = ["labsid", "course", "export", "--format", "moodle", "--worksheet", str(sheet.path), "--out", str(out)]
    fitting = [name for name, (marks, _) in factors.items() if len(factors) > 1 and asked == {marks}]
    ways = [(f"for {name} alone", [*command, "--assignment", name]) for name in fitting]
    named = [word for name in assignments for word in ("--assignment", name)]
    ways.append((f"to convert the marks to {other_maxima[0]}", [*command, *named, "--scale"]))
    parts = ", ".join(f"{name} {plain_decimal(marks * factor)}" for name, (marks, factor) in factors.items())
    raise ValueError(
        f"the worksheet's maximum is {plain_decimal(other_maxima[0])}, but the marks are out of "
        f"{plain_decimal(maximum)} ({parts}); nothing was written. Type, "
        + "; ".join(f"{what}: {shlex.join(line)}" for what, line in ways)
    )


def _fill_in(row: Mapping[str, str], marks: Totals, stored: Sequence[StoredResult]) -> tuple[dict[str, str], str]:
    """A row with its grade on the worksheet's scale, and a remark."""
    if _is_locked(row):
        return dict(row), "the grade is locked in Moodle and was not changed"
    maximum = _maximum_grade(row.get(MAXIMUM, ""))
    score, remark = marks.score, ""
    total = f"{plain_decimal(marks.score)} of {plain_decimal(marks.max_score)}"
    if maximum is not None and maximum != marks.max_score and marks.max_score:
        score = rounded(marks.score * maximum / marks.max_score)
        remark = f"{total} is {plain_decimal(score)} of {maximum}"
    if marks.waiting:
        waiting = f"{plain_decimal(marks.waiting)} marks not yet graded by hand"
        remark = f"{remark}; {waiting}" if remark else waiting
    return {**row, GRADE: plain_decimal(score), FEEDBACK: _comment(marks, stored)}, remark


def _is_locked(row: Mapping[str, str]) -> bool:
    return row.get(CHANGEABLE, "Yes").strip().casefold() == "no"


def _comment(marks: Totals, stored: Sequence[StoredResult]) -> str:
    """The comment in the worksheet; it names the assignments that it is about."""
    names = [result.assignment for result in stored]
    parts = [f"{', '.join(names)}: {plain_decimal(marks.score)} of {plain_decimal(marks.max_score)} marks."]
    if marks.waiting:
        parts.append(f"{plain_decimal(marks.waiting)} marks not yet graded by hand.")
    for result in stored:
        about = f"{result.assignment}: " if len(stored) > 1 else ""
        parts += [f"{about}Extension until {result.extension}."] if result.extension else []
        parts += [f"{about}{result.late}"] if result.late else []
        parts += [f"{about}{_refusal_text(result)}"] if result.is_refused else []
    slips = dict.fromkeys(question.slip for result in stored for question in result.questions if question.slip)
    if slips:
        parts.append(f"Common mistakes: {'; '.join(filter(None, slips))}.")
    parts.append("See the feedback file for details.")
    return one_line(" ".join(parts))


def _refusal_text(result: StoredResult) -> str:
    """Why a submission was not graded, as a sentence; with the reason, if something was handed in."""
    is_known = result.refusal == result_files.COULD_NOT_BE_GRADED and result.notes
    why = f": {'; '.join(result.notes)}" if is_known else ""
    return f"{result.refusal.capitalize()}{why}."


def _maximum_grade(text: str) -> Decimal | None:
    try:
        value = Decimal(text.strip())
    except InvalidOperation:
        return None
    return value if value.is_finite() and value > 0 else None
