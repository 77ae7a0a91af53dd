"""Results on disk: one JSON file a submission, written whole or not at all; everything else is made from these.

``OUT/results/<student>/<assignment>.json`` carries fingerprints of all that went into it, so that a second run
grades only what is missing or has changed, and can say which.
"""

import hashlib
import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field
from decimal import Decimal
from pathlib import Path
from typing import Any

from autograder.course.layout import in_course_order, to_json
from autograder.judge.outcome import QuestionResult, SubmissionResult
from labsid._files import write_text

SCHEMA = "labsid.result/2"


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
    fingerprint : mapping
        Of each part that went into it: ``submission, release, check, data, environment``.
    flags : tuple of str
        What the teacher alone should know.
    review : tuple of str
        Questions graded by hand whose automatic part, or that of another question, has changed since.
    submitted : str or None
        When it was handed in, in ISO format and UTC; None where that is not known.
    penalty : Decimal
        Marks taken off for lateness.
    late : str
        Why, in words; empty where it was not late.
    work : mapping
        For each question the fingerprint of the student's code in a normal form, and its size.
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

    @property
    def is_refused(self) -> bool:
        """Whether there was nothing to grade: missing or quarantined."""
        return all(question.status in ("missing", "quarantined") for question in self.questions)


def to_stored(
    result: SubmissionResult, title: str, headings: Mapping[str, str], fingerprint: Mapping[str, str]
) -> StoredResult:
    """A submission's results as they are kept."""
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
    )


def store(out: Path, stored: StoredResult) -> None:
    """Write a submission's results."""
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
        "work": {question: list(work) for question, work in stored.work.items()},
        "headings": dict(stored.headings),
        "questions": questions,
    }
    write_text(result_path(out, stored.student, stored.assignment), to_json(document))


def entry_digest(stored: StoredResult) -> str:
    """Fingerprint of all that the gradebook takes from a result."""
    lines = [f"{q.question} {q.score} {q.max_score} {q.status}" for q in stored.questions]
    lines += [stored.submitted or "", str(stored.penalty), *stored.review, *stored.fingerprint.values()]
    said = "\n".join(lines)
    return hashlib.sha256(said.encode(errors="surrogatepass")).hexdigest()


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
            fingerprint=dict(document["fingerprint"]),
            flags=tuple(document["flags"]),
            review=tuple(document["review"]),
            submitted=document["submitted"],
            penalty=Decimal(document["penalty"]),
            late=document["late"],
            work={question: (str(digest), int(size)) for question, (digest, size) in document["work"].items()},
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


def load_valid(out: Path) -> Iterator[StoredResult]:
    """Every result in OUT that can be read, in no order; the others are as good as not there."""
    for path in (out / "results").glob("*/*.json"):
        try:
            result = load(path)
        except ValueError:
            continue
        if result_path(out, result.student, result.assignment) == path:
            yield result


def result_path(out: Path, student: str, assignment: str) -> Path:
    """Where the results of one submission are."""
    return out / "results" / student / f"{assignment}.json"


def _question(fields: dict[str, Any]) -> QuestionResult:
    score = None if fields["score"] is None else Decimal(fields["score"])
    rest = {**fields, "score": score, "max_score": Decimal(fields["max_score"]), "figures": tuple(fields["figures"])}
    return QuestionResult(**rest)
