"""The answers to open questions that wait for a mark, with what the instructor needs beside them."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from pathlib import Path

from autograder.course.layout import Course
from autograder.course.questions import QuestionText, read_questions
from autograder.results import gradebook, result_files
from labsid.checks.timetable import in_course_order

STEPS = (Decimal(0), Decimal("0.25"), Decimal("0.5"), Decimal("0.75"), Decimal(1))
"""Shares of the points that the number keys from 0 give."""


@dataclass(frozen=True, slots=True)
class OpenAnswer:
    """One student's answer to an open question.

    Attributes
    ----------
    student : str
        ID.
    text : str
        Markdown.
    name : str
        Empty if it is unknown.
    score : Decimal or None
        None until it is marked.
    comment : str
        The comment for the student.
    marked_by : str
        Who marked it and when, if that is known.
    needs_review : bool
        Whether the submission changed after it was marked.
    ticked : tuple of int
        The lines of the rubric that were ticked, from 0.
    """

    student: str
    text: str
    name: str = ""
    score: Decimal | None = None
    comment: str = ""
    marked_by: str = ""
    needs_review: bool = False
    ticked: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class OpenQuestion:
    """An open question with all its answers; unanswered ones have 0 marks and are left out.

    Attributes
    ----------
    assignment, title, question, heading : str
    max_score : Decimal
    text : QuestionText
        Its task, model answer and rubric; all empty where the notebook with solutions is not here.
    answers : tuple of OpenAnswer
    """

    assignment: str
    title: str
    question: str
    heading: str
    max_score: Decimal
    text: QuestionText
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
    """All open questions with an answer, in the order of the course, with the marks so far.

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
    stored = [graded for graded in result_files.load_all(out) if assignment in (None, graded.assignment)]
    texts = {name: read_questions(course, name) for name in {graded.assignment for graded in stored}}
    questions: dict[tuple[str, str], OpenQuestion] = {}
    for graded in stored:
        for result in graded.questions:
            if result.status != "manual" or result.score is not None or question not in (None, result.question):
                continue
            key = graded.assignment, result.question
            heading = graded.headings.get(result.question, result.question)
            text = texts[graded.assignment].get(result.question, QuestionText("", ""))
            first = OpenQuestion(graded.assignment, graded.title, result.question, heading, result.max_score, text, ())
            known = questions.get(key, first)
            questions[key] = replace(known, answers=(*known.answers, OpenAnswer(graded.student, result.answer)))
    if not questions:
        wanted = " ".join(filter(None, (question, assignment and f"in {assignment}")))
        raise ValueError(f"{out} holds no answer to an open question{wanted and f' {wanted}'}.")
    order = {(graded.assignment, result.question): None for graded in stored for result in graded.questions}
    names = sorted({name for name, _ in questions}, key=in_course_order)
    in_order = [key for name in names for key in order if key[0] == name and key in questions]
    return with_marks(out, [questions[key] for key in in_order])


def with_marks(out: Path, questions: Iterable[OpenQuestion]) -> list[OpenQuestion]:
    """The questions with the names and marks that are in the gradebook now."""
    manual, names = gradebook.read_manual_grades(out), gradebook.read_names(out)

    def marked(answer: OpenAnswer, about: OpenQuestion) -> OpenAnswer:
        key = answer.student, about.assignment, about.question
        mark = manual.marks.get(key)
        return replace(
            answer,
            name=names.get(answer.student, ""),
            score=manual.scores.get(key),
            comment=manual.comments.get(key, ""),
            marked_by="" if mark is None else mark.text,
            needs_review=key in manual.needs_review,
            ticked=() if mark is None else mark.ticked,
        )

    return [
        replace(question, answers=tuple(marked(answer, question) for answer in question.answers))
        for question in questions
    ]


def find_question(questions: Sequence[OpenQuestion], assignment: str, question: str) -> OpenQuestion | None:
    """The question of that name; None if there is none."""
    return next((one for one in questions if (one.assignment, one.question) == (assignment, question)), None)
