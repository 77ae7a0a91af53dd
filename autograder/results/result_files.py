"""Stored results: one JSON file for each submission, the source of all pages, tables and exports.

``OUT/results/<student>/<assignment>.json`` contains fingerprints of everything the result depends on, so that a second
run grades only new and changed submissions.
"""

import hashlib
import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field
from decimal import Decimal
from pathlib import Path
from typing import Any

from autograder.course.layout import to_json
from autograder.intake.submission import UNTOUCHED
from autograder.judge.outcome import QuestionResult, SubmissionResult
from autograder.results.copied import Copied
from labsid._files import write_text
from labsid.checks.timetable import in_course_order

SCHEMA = "labsid.result/3"

NOT_HANDED_IN = "not handed in"
AS_RELEASED = "handed in as it was released, without an answer"
COULD_NOT_BE_GRADED = "handed in, but could not be graded"
"""Why a submission was not graded."""


@dataclass(frozen=True, slots=True)
class StoredResult:
    """The stored result of one submission.

    Attributes
    ----------
    student, assignment, title : str
    questions : tuple of QuestionResult
    headings : mapping
        The notebook heading above each question.
    notes : tuple of str
        What was repaired in the submission, or why it was not graded.
    isolation : str
    fingerprint : mapping
        Of each part the result depends on: ``submission, release, check, data, environment``.
    flags : tuple of str
        Remarks for the instructor only.
    review : tuple of str
        Manually graded questions to review, because the submission or its automatic scores have changed since.
    submitted : str or None
        Submission time in ISO format and UTC; None if unknown.
    penalty : Decimal
        Late penalty in marks.
    late : str
        Explanation of the penalty; empty if the submission was on time.
    extension : str
        The student's own due date, as text; empty without an extension.
    work : mapping
        Fingerprint and size of the student's normalised code, by question.
    copied : Copied
        Code of labsid, and code that is carried as text.
    second_record : {"", "run", "off"}
        Whether the answers were tried on another record; empty if nothing follows from the record.
    """

    student: str
    assignment: str
    title: str
    questions: tuple[QuestionResult, ...]
    headings: Mapping[str, str]
    notes: tuple[str, ...]
    isolation: str
    fingerprint: Mapping[str, str]
    flags: tuple[str, ...] = ()
    review: tuple[str, ...] = ()
    submitted: str | None = None
    penalty: Decimal = Decimal(0)
    late: str = ""
    work: Mapping[str, tuple[str, int]] = field(default_factory=dict)
    copied: Copied = field(default_factory=Copied)
    second_record: str = ""
    extension: str = ""

    @property
    def is_refused(self) -> bool:
        """Whether the submission was not graded: missing or quarantined."""
        return all(question.status in ("missing", "quarantined") for question in self.questions)

    @property
    def refusal(self) -> str:
        """Why the submission was not graded, in a few words; empty if it was."""
        if not self.is_refused:
            return ""
        if all(question.status == "missing" for question in self.questions):
            return AS_RELEASED if UNTOUCHED in self.notes else NOT_HANDED_IN
        return COULD_NOT_BE_GRADED


def to_stored(
    result: SubmissionResult, title: str, headings: Mapping[str, str], fingerprint: Mapping[str, str]
) -> StoredResult:
    """Convert a result into its stored form."""
    return StoredResult(
        result.student,
        result.assignment,
        title,
        result.results,
        headings,
        result.notes,
        result.isolation,
        fingerprint,
        result.flags,
        second_record=result.second_record,
    )


def store(out: Path, stored: StoredResult) -> None:
    """Write a result."""
    questions = []
    for question in stored.questions:
        fields = asdict(question)
        fields["score"] = None if question.score is None else str(question.score)
        fields["max_score"] = str(question.max_score)
        questions.append(fields)
    document = {
        "schema": SCHEMA,
        "student": stored.student,
        "assignment": stored.assignment,
        "title": stored.title,
        "fingerprint": dict(stored.fingerprint),
        "isolation": stored.isolation,
        "notes": list(stored.notes),
        "flags": list(stored.flags),
        "review": list(stored.review),
        "submitted": stored.submitted,
        "penalty": str(stored.penalty),
        "late": stored.late,
        **({"extension": stored.extension} if stored.extension else {}),
        "work": {question: list(work) for question, work in stored.work.items()},
        "same_as": dict(stored.copied.same_as),
        "code_as_text": list(stored.copied.code_as_text),
        "second_record": stored.second_record,
        "headings": dict(stored.headings),
        "questions": questions,
    }
    write_text(result_path(out, stored.student, stored.assignment), to_json(document))


def entry_digest(stored: StoredResult) -> str:
    """Fingerprint of everything in a result that is entered into the gradebook."""
    lines = [f"{q.question} {q.score} {q.max_score} {q.status}" for q in stored.questions]
    lines += [stored.submitted or "", str(stored.penalty), *stored.review, *stored.fingerprint.values()]
    return hashlib.sha256("\n".join(lines).encode(errors="surrogatepass")).hexdigest()


def load(path: Path) -> StoredResult:
    """Read a result; `ValueError` if the file is not valid."""
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
            fingerprint=dict(document["fingerprint"]),
            flags=tuple(document["flags"]),
            review=tuple(document["review"]),
            submitted=document["submitted"],
            penalty=Decimal(document["penalty"]),
            late=document["late"],
            work={question: (str(digest), int(size)) for question, (digest, size) in document["work"].items()},
            copied=Copied(dict(document["same_as"]), tuple(document["code_as_text"])),
            second_record=str(document["second_record"]),
            extension=str(document.get("extension", "")),
        )
    except (KeyError, TypeError, ValueError, AttributeError, ArithmeticError) as error:
        raise ValueError(
            f"{path} is not a result of 'labsid course grade' ({error}). Delete it and grade again."
        ) from None


def load_all(out: Path) -> list[StoredResult]:
    """All results in OUT, by student and in course order; `ValueError` if there are none."""
    paths = sorted((out / "results").glob("*/*.json"))
    if not paths:
        raise ValueError(f"{out} holds no results. Run: labsid course grade --submitted DIR --out {out}")
    return sorted((load(path) for path in paths), key=lambda one: (one.student, in_course_order(one.assignment)))


def load_valid(out: Path) -> Iterator[StoredResult]:
    """All valid results in OUT, in any order; invalid files are ignored."""
    for path in (out / "results").glob("*/*.json"):
        try:
            result = load(path)
        except ValueError:
            continue
        if result_path(out, result.student, result.assignment) == path:
            yield result


def result_path(out: Path, student: str, assignment: str) -> Path:
    """Path of the result of one submission."""
    return out / "results" / student / f"{assignment}.json"


def _question(fields: dict[str, Any]) -> QuestionResult:
    score = None if fields["score"] is None else Decimal(fields["score"])
    rest = {**fields, "score": score, "max_score": Decimal(fields["max_score"]), "figures": tuple(fields["figures"])}
    return QuestionResult(**rest)
