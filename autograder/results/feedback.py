"""Feedback pages: one self-contained HTML file for each submission, made from its stored result."""

import re
from collections.abc import Iterator, Mapping
from decimal import Decimal
from pathlib import Path
from typing import Any

import jinja2
import markupsafe

from autograder.course.plain_text import plain_decimal
from autograder.judge.outcome import QuestionResult
from autograder.results import gradebook, grades, result_files
from autograder.results.result_files import StoredResult
from labsid._files import write_text

_MARKS = {"right": "✓", "wrong": "✗", "wait": "…"}


def write_feedback(out: Path) -> Iterator[Path]:
    """Write ``OUT/feedback/<student>/<assignment>.html`` for every result; yields each page's path.

    Includes the scores and comments of manual grading.

    Raises
    ------
    ValueError
        If OUT holds no results.
    """
    manual = gradebook.read_manual_grades(out)
    page_template = load_template("feedback.html.j2")
    for result in result_files.load_all(out):
        path = out / "feedback" / result.student / f"{result.assignment}.html"
        write_text(path, page_template.render(page=feedback_page(result, manual.scores, manual.comments)))
        yield path


def feedback_page(
    result: StoredResult,
    scores: Mapping[tuple[str, str, str], Decimal],
    comments: Mapping[tuple[str, str, str], str],
) -> dict[str, Any]:
    """The content of a feedback page, as plain text.

    Parameters
    ----------
    result : StoredResult
    scores, comments : mapping
        Of manual grading, by (student, assignment, question).

    Returns
    -------
    dict
    """
    questions = []
    marks = grades.totals(result, scores)
    for question in result.questions:
        key = (result.student, result.assignment, question.question)
        score = scores.get(key, question.score)
        questions.append(
            _question_block(question, score, comments.get(key, ""), result.headings.get(question.question, ""))
        )
    automatic = [block for block in questions if not block["by_hand"]]
    wrong = [block for block in questions if block["look"] == "wrong"]
    return {
        "student": result.student,
        "assignment": result.assignment,
        "title": result.title,
        "score": plain_decimal(marks.score),
        "max_score": plain_decimal(marks.max_score),
        "late": result.late,
        "waiting": plain_decimal(marks.waiting),
        "automatic": len(automatic),
        "right": sum(block["look"] == "right" for block in automatic),
        "first_wrong": wrong[0] if wrong else None,
        "notes": [printable(note) for note in result.notes],
        "questions": questions,
        "isolation": result.isolation,
    }


def _question_block(question: QuestionResult, score: Decimal | None, comment: str, heading: str) -> dict[str, Any]:
    full = score is not None and score == question.max_score
    look = "wait" if score is None else "right" if full else "wrong"
    by_hand = question.status == "manual"
    graded_by_hand = by_hand and score is not None
    return {
        "id": question.question,
        "heading": heading or question.question,
        "by_hand": by_hand,
        "look": look,
        "mark": _MARKS[look],
        "score": "–" if score is None else plain_decimal(score),
        "max_score": plain_decimal(question.max_score),
        "status": question.status,
        "reason": "graded by hand" if graded_by_hand else printable(question.reason),
        "slip": question.slip,
        "comment": printable(comment),
        "answer": printable(question.answer),
        "output": printable(question.output),
        "figures": question.figures,
    }


def printable(text: str) -> str:
    """Text without terminal colours and control characters; the template escapes HTML."""
    text = re.sub(r"\x1b\[[0-9;?]*[ -/]*[@-~]", "", text)
    return "".join(c for c in text if c in "\n\t" or c.isprintable())


def with_code(text: str) -> markupsafe.Markup:
    """Escaped HTML of a text, with backticked names as code."""
    parts = str(text).split("`")
    if len(parts) % 2 == 0:  # an unpaired backtick is an ordinary character
        return markupsafe.escape(text)
    marked = (f"<code>{markupsafe.escape(p)}</code>" if i % 2 else markupsafe.escape(p) for i, p in enumerate(parts))
    return markupsafe.Markup("".join(marked))


def load_template(name: str) -> jinja2.Template:
    """Load a page template; it escapes all values."""
    loader = jinja2.FileSystemLoader(Path(__file__).parent / "templates")
    environment = jinja2.Environment(loader=loader, autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True)
    environment.filters["with_code"] = with_code
    return environment.get_template(name)
