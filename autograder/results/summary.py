"""The graded class as a table for the terminal."""

import io
from decimal import Decimal
from pathlib import Path

from autograder.course.plain_text import one_line, plain_decimal
from autograder.results import gradebook, grades, result_files
from labsid.checks.timetable import in_course_order

_LONGEST_REASON, _WIDEST = 100, 240
"""Characters of the reason for which a submission was not graded, and of the table beside its marks."""


def class_table(out: Path) -> str:
    """One row for each student: marks so far in every assignment, and what to review.

    Parameters
    ----------
    out : Path
        A folder that ``labsid course grade`` wrote.

    Returns
    -------
    str
    """
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    stored = result_files.load_all(out)
    manual = gradebook.read_manual_grades(out)
    assignments = sorted({result.assignment for result in stored}, key=in_course_order)
    table = Table(box=None, pad_edge=False)
    table.add_column("student")
    for name in assignments:
        table.add_column(name, justify="right")
    table.add_column("to review")
    cells = {(result.student, result.assignment): result for result in stored}
    for student in dict.fromkeys(result.student for result in stored):
        row: list[str] = []
        remarks: list[str] = []
        waiting = Decimal(0)
        for name in assignments:
            result = cells.get((student, name))
            if result is None:
                row.append("")
                continue
            marks = grades.totals(result, manual.scores)
            status = {question.status for question in result.questions}
            row.append(f"{plain_decimal(marks.score)} of {plain_decimal(marks.max_score)}")
            remarks += [one_line(flag.partition(":")[0]) for flag in result.flags]
            remarks += [f"{plain_decimal(marks.penalty)} late penalty"] if marks.penalty else []
            if any((student, name) == key[:2] for key in manual.needs_review):
                remarks.append("review manual grades")
            failed = status & {"crashed", "timeout", "limit", "missing", "quarantined"}
            remarks += ["as released"] if result.refusal == result_files.AS_RELEASED else sorted(failed)
            if result.refusal == result_files.COULD_NOT_BE_GRADED and result.notes:
                remarks[-1] += f" ({_few_words('; '.join(result.notes))})"
            waiting += marks.waiting
        if waiting:
            remarks.append(f"{plain_decimal(waiting)} to grade by hand")
        table.add_row(Text(one_line(student)), *row, Text(", ".join(dict.fromkeys(remarks))))
    text = io.StringIO()
    Console(file=text, width=_WIDEST + 22 * len(assignments), color_system=None).print(table)
    return "\n".join(line.rstrip() for line in text.getvalue().splitlines())


def _few_words(reason: str) -> str:
    """The reason of the report on one line, and its beginning alone if it is long."""
    text = one_line(reason)
    return text if len(text) <= _LONGEST_REASON else f"{text[:_LONGEST_REASON].rstrip()} ..."
