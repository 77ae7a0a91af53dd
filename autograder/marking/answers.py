"""The answers to open questions that wait for a mark, with what the instructor needs beside them."""

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path

from autograder.course.layout import Course, read_cell
from autograder.results import gradebook, result_files

STEPS = (Decimal(0), Decimal("0.25"), Decimal("0.5"), Decimal("0.75"), Decimal(1))
"""Shares of the points that the number keys from 0 give."""


@dataclass(frozen=True, slots=True)
class OpenAnswer:
    """One student's answer to an open question.

    Attributes
    ----------
    student, name : str
        ID, and the name if it is known.
    text : str
        Markdown.
    score : Decimal or None
        None until it is marked.
    comment : str
        The comment for the student.
    marked_by : str
        Who marked it and when, if that is known.
    needs_review : bool
        Whether the submission changed after it was marked.
    """

    student: str
    name: str
    text: str
    score: Decimal | None
    comment: str
    marked_by: str
    needs_review: bool


@dataclass(frozen=True, slots=True)
class OpenQuestion:
    """An open question with all its answers; unanswered ones have 0 marks and are left out.

    Attributes
    ----------
    assignment, title, question, heading : str
    max_score : Decimal
    task : str
        The text of the notebook above the answer, in Markdown.
    rubric : str
        The model answer, in Markdown; empty if there is none.
    answers : tuple of OpenAnswer
    """

    assignment: str
    title: str
    question: str
    heading: str
    max_score: Decimal
    task: str
    rubric: str
    answers: tuple[OpenAnswer, ...]

    @property
    def waiting(self) -> int:
        """Number of answers without a mark, or to review."""
        return sum(answer.score is None or answer.needs_review for answer in self.answers)

    @property
    def steps(self) -> tuple[Decimal, ...]:
        """The points that the number keys give."""
        return tuple(step * self.max_score for step in STEPS)


def open_questions(
    out: Path, course: Course | None, assignment: str | None = None, question: str | None = None
) -> list[OpenQuestion]:
    """All open questions with an answer, in the order of the course.

    Parameters
    ----------
    out : Path
        A folder that ``labsid course grade`` wrote.
    course : Course or None
        For task and model answer.
    assignment, question : str, optional
        Only these.

    Raises
    ------
    ValueError
        If OUT holds no results, or no answer to such a question.
    """
    stored = [one for one in result_files.load_all(out) if assignment in (None, one.assignment)]
    manual, names = gradebook.read_manual_grades(out), gradebook.read_names(out)
    found: dict[tuple[str, str], list[OpenAnswer]] = {}
    about: dict[tuple[str, str], tuple[str, str, Decimal]] = {}
    for one in stored:
        for result in one.questions:
            if result.status != "manual" or result.score is not None or question not in (None, result.question):
                continue
            key = one.student, one.assignment, result.question
            mark = manual.marks.get(key)
            by = "" if mark is None else f"marked by {mark.marker} on {mark.when:%Y-%m-%d}"
            found.setdefault(key[1:], []).append(
                OpenAnswer(
                    one.student,
                    names.get(one.student, ""),
                    result.answer,
                    manual.scores.get(key),
                    manual.comments.get(key, ""),
                    by,
                    key in manual.needs_review,
                )
            )
            about[key[1:]] = one.title, one.headings.get(result.question, result.question), result.max_score
    if not found:
        wanted = " ".join(filter(None, (question, assignment and f"in {assignment}")))
        raise ValueError(f"{out} holds no answer to an open question{wanted and f' {wanted}'}.")
    texts = {name: dict(_texts(course, name)) for name in {name for name, _ in found}}
    order = {(one.assignment, result.question): None for one in stored for result in one.questions}
    questions = []
    for name, asked in (which for which in order if which in found):
        title, heading, points = about[name, asked]
        task, rubric = texts[name].get(asked, ("", ""))
        answers = tuple(found[name, asked])
        questions.append(OpenQuestion(name, title, asked, heading, points, task, rubric, answers))
    return questions


def _texts(course: Course | None, assignment: str) -> Iterator[tuple[str, tuple[str, str]]]:
    """Task and model answer of each open question, from the built notebook with solutions."""
    path = None if course is None else course.source / assignment / f"{assignment}.ipynb"
    if path is None or not path.is_file():
        return
    task = ""
    for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
        source = cell["source"] if isinstance(cell["source"], str) else "".join(cell["source"])
        known = read_cell({**cell, "source": source})
        if known is not None and known.kind == "manual":
            yield known.id, (task, source)
        task = _last_section(source) if cell["cell_type"] == "markdown" else ""


def _last_section(text: str) -> str:
    """Markdown from below its last heading."""
    *_, last = re.split(r"^#{1,6}\s.*$", text, flags=re.MULTILINE)
    return last.strip()


def find_question(questions: Sequence[OpenQuestion], assignment: str, question: str) -> OpenQuestion | None:
    """The question of that name; None if there is none."""
    return next((one for one in questions if (one.assignment, one.question) == (assignment, question)), None)
