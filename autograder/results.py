"""Results on disk: one JSON file a submission, written whole or not at all; everything else is made from these.

``OUT/results/<student>/<assignment>.json`` carries the fingerprint of all that went into it, so that a second run
grades only what is missing or has changed.
"""

import csv
import io
import json
import re
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from decimal import Decimal
from pathlib import Path
from typing import Any

from autograder.course import in_course_order, to_json
from autograder.judge import QuestionResult, SubmissionResult
from labsid.console import write_file

SCHEMA = "labsid.result/1"
GRADE_COLUMNS = (
    "student", "assignment", "question", "score", "max_score", "status", "reason", "isolation", "seconds",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class StoredResult:
    """A submission's results as they are on disk.

    Attributes
    ----------
    student, assignment, title : str
    questions : tuple of QuestionResult
    headings : mapping
        The heading of the notebook under which each question stands.
    notes : tuple of str
        What the intake mended, or why it was refused.
    isolation : str
    fingerprint : str
        Of the submission, the release, the checks and the record.
    """

    student: str
    assignment: str
    title: str
    questions: tuple[QuestionResult, ...]
    headings: Mapping[str, str]
    notes: tuple[str, ...]
    isolation: str
    fingerprint: str


def store(out: Path, result: SubmissionResult, title: str, headings: Mapping[str, str], fingerprint: str) -> None:
    """Write a submission's results."""
    questions = []
    for question in result.results:
        fields = asdict(question)
        fields["score"] = None if question.score is None else str(question.score)
        fields["max_score"] = str(question.max_score)
        questions.append(fields)
    document = {
        "schema": SCHEMA,
        "student": result.student,
        "assignment": result.assignment,
        "title": title,
        "fingerprint": fingerprint,
        "isolation": result.isolation,
        "notes": list(result.notes),
        "headings": dict(headings),
        "questions": questions,
    }
    write_text(result_path(out, result.student, result.assignment), to_json(document))


def load(path: Path) -> StoredResult:
    """Read a submission's results; `ValueError` where the file is not one."""
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
        if document["schema"] != SCHEMA:
            raise KeyError("schema")
        return StoredResult(
            student=document["student"],
            assignment=document["assignment"],
            title=document["title"],
            questions=tuple(_question(fields) for fields in document["questions"]),
            headings=document["headings"],
            notes=tuple(document["notes"]),
            isolation=document["isolation"],
            fingerprint=document["fingerprint"],
        )
    except (KeyError, TypeError, ValueError, AttributeError, ArithmeticError) as error:
        raise ValueError(
            f"{path} is not a result of 'labsid course grade' ({error}). Delete it and grade again."
        ) from None


def load_all(out: Path) -> list[StoredResult]:
    """Every result in OUT, by student and in the order of the course; `ValueError` where there is none."""
    paths = sorted((out / "results").glob("*/*.json"))
    if not paths:
        raise ValueError(f"{out} holds no results. Run: labsid course grade --submitted DIR --out {out}")
    return sorted((load(path) for path in paths), key=lambda one: (one.student, in_course_order(one.assignment)))


def result_path(out: Path, student: str, assignment: str) -> Path:
    """Where the results of one submission are."""
    return out / "results" / student / f"{assignment}.json"


@dataclass(frozen=True, slots=True)
class Totals:
    """Marks of one submission: what it has, what there is, and what still waits to be graded by hand."""

    score: Decimal
    max_score: Decimal
    waiting: Decimal


def totals(result: StoredResult, manual: Mapping[tuple[str, str, str], Decimal]) -> Totals:
    """Add up a submission's marks; scores given by hand, by (student, assignment, question), take precedence."""
    score = most = waiting = Decimal(0)
    for question in result.questions:
        given = manual.get((result.student, result.assignment, question.question), question.score)
        most += question.max_score
        score += given or Decimal(0)
        waiting += question.max_score if given is None else Decimal(0)
    return Totals(score, most, waiting)


def grade_rows(results: Iterable[StoredResult], manual: Mapping[tuple[str, str, str], Decimal]) -> list[dict[str, str]]:
    """The lines of grades.csv, in the order of students, assignments and questions.

    Parameters
    ----------
    results : iterable of StoredResult
    manual : mapping
        Scores given by hand, by (student, assignment, question); they take precedence.

    Returns
    -------
    list of dict
        One a question, with the columns of `GRADE_COLUMNS`.
    """
    rows = []
    for result in results:
        for question in result.questions:
            by_hand = manual.get((result.student, result.assignment, question.question))
            score = question.score if by_hand is None else by_hand
            rows.append(
                {
                    "student": result.student,
                    "assignment": result.assignment,
                    "question": question.question,
                    "score": "" if score is None else plain_decimal(score),
                    "max_score": plain_decimal(question.max_score),
                    "status": question.status,
                    "reason": one_line(question.reason),
                    "isolation": result.isolation,
                    "seconds": f"{question.seconds:.3f}",
                }
            )
    return rows


def write_csv(path: Path, columns: Iterable[str], rows: Iterable[Mapping[str, str]]) -> None:
    """Write a table, whole or not at all; text that a spreadsheet would run as a formula gets an apostrophe."""
    text = io.StringIO(newline="")
    writer = csv.DictWriter(text, list(columns), lineterminator="\n")
    writer.writeheader()
    for row in rows:
        writer.writerow({key: f"'{value}" if _is_formula(value) else value for key, value in row.items()})
    write_text(path, text.getvalue())


def _is_formula(text: str) -> bool:
    return text.lstrip()[:1] in ("=", "@", "+", "-") and not re.fullmatch(r"-?\d+(\.\d+)?", text)


def plain_decimal(value: Decimal) -> str:
    """A decimal without exponent and trailing zeros: ``0.60`` is ``0.6``, ``2.0`` is ``2``."""
    text = format(value.normalize(), "f")
    return "0" if text in ("-0", "") else text


def one_line(text: str) -> str:
    """Text without line breaks and control characters."""
    return " ".join("".join(c if c.isprintable() or c.isspace() else " " for c in text).split())


def write_text(path: Path, text: str) -> None:
    """Write a file whole or not at all, in a folder that is made where it is not there.

    Half characters, which student text can hold and no file can, are written as their escapes.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    write_file(path, text.encode(errors="backslashreplace"))


def _question(fields: dict[str, Any]) -> QuestionResult:
    score = None if fields["score"] is None else Decimal(fields["score"])
    rest = {**fields, "score": score, "max_score": Decimal(fields["max_score"]), "figures": tuple(fields["figures"])}
    return QuestionResult(**rest)
