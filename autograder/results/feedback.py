"""Feedback pages: one self-contained HTML file for each submission, made from its stored result."""

import re
from collections import Counter
from collections.abc import Iterator
from decimal import Decimal
from pathlib import Path
from typing import Any

import jinja2
import markupsafe

from autograder.course.plain_text import plain_decimal
from autograder.judge.outcome import QuestionResult
from autograder.results import gradebook, grades, result_files
from autograder.results.gradebook import Key, ManualGrades
from autograder.results.prose import prose_html
from autograder.results.result_files import StoredResult
from labsid._files import write_text

TEMPLATES = Path(__file__).parent / "templates"
_MARKS = {"right": "✓", "partial": "◐", "wrong": "✗", "wait": "…", "none": "·"}
_WORDS = {
    "right": "right",
    "partial": "partly right",
    "wrong": "wrong",
    "wait": "not yet graded",
    "none": "without marks",
}


def write_feedback(out: Path, course: str = "") -> Iterator[Path]:
    """Write ``OUT/feedback/<student>/<assignment>.html`` for every result; yields each page's path.

    Includes the scores and comments of manual grading.

    Parameters
    ----------
    out : Path
    course : str
        Title of the course.

    Raises
    ------
    ValueError
        If OUT holds no results.
    """
    manual, names = gradebook.read_manual_grades(out), gradebook.read_names(out)
    page_template = load_template("feedback.html.j2")
    for result in result_files.load_all(out):
        path = out / "feedback" / result.student / f"{result.assignment}.html"
        page = feedback_page(result, manual, names.get(result.student, ""), course)
        write_text(path, page_template.render(page=page))
        yield path


def feedback_page(result: StoredResult, manual: ManualGrades, name: str = "", course: str = "") -> dict[str, Any]:
    """The content of a feedback page, as plain text and safe HTML.

    Parameters
    ----------
    result : StoredResult
    manual : ManualGrades
    name, course : str
        Name of the student and title of the course, if known.

    Returns
    -------
    dict
    """
    questions = []
    headings = unique_headings(result)
    marks = grades.totals(result, manual.scores)
    for question in result.questions:
        key = (result.student, result.assignment, question.question)
        questions.append(_question_block(question, key, manual, headings[question.question]))
    automatic = [block for block in questions if not block["by_hand"]]
    wrong = [block for block in questions if block["look"] == "wrong"]
    return {
        "student": f"{printable(name)} ({result.student})" if name else result.student,
        "course": course,
        "assignment": result.assignment,
        "title": result.title,
        "score": plain_decimal(marks.score),
        "max_score": plain_decimal(marks.max_score),
        "refusal": result.refusal.capitalize(),
        "late": result.late,
        "extension": result.extension,
        "waiting": plain_decimal(marks.waiting),
        "automatic": len(automatic),
        "right": sum(block["look"] == "right" for block in automatic),
        "first_wrong": wrong[0] if wrong else None,
        "notes": [printable(note) for note in result.notes],
        "questions": questions,
        "isolation": result.isolation,
    }


def _question_block(question: QuestionResult, key: Key, manual: ManualGrades, heading: str) -> dict[str, Any]:
    score = manual.scores.get(key, question.score)
    look = look_of(score, question.max_score)
    by_hand = question.status == "manual"
    return {
        "id": question.question,
        "heading": heading,
        "by_hand": by_hand,
        "look": look,
        "mark": _MARKS[look],
        "in_words": _WORDS[look],
        "score": "–" if score is None else plain_decimal(score),
        "max_score": plain_decimal(question.max_score),
        "status": question.status,
        "reason": printable(grades.reason_shown(question, key, manual)),
        "slip": question.slip,
        "comment": printable(manual.comments.get(key, "")),
        "answer": printable(question.answer),
        "prose": prose_html(printable(question.answer)) if by_hand else None,
        "output": printable(question.output),
        "figures": question.figures,
    }


def unique_headings(result: StoredResult) -> dict[str, str]:
    """The heading of each question; those under the same heading of the notebook are numbered."""
    texts = {one.question: result.headings.get(one.question) or one.question for one in result.questions}
    total, seen = Counter(texts.values()), Counter[str]()
    found = {}
    for question, text in texts.items():
        seen[text] += 1
        found[question] = f"{text} ({seen[text]} of {total[text]})" if total[text] > 1 else text
    return found


def look_of(score: Decimal | None, max_score: Decimal) -> str:
    """How a question is shown: ``right``, ``partial``, ``wrong``, ``wait``, or ``none`` if it has no marks."""
    if score is None:
        return "wait"
    if not max_score:
        return "none"
    return "right" if score >= max_score else "partial" if score > 0 else "wrong"


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


def load_template(name: str, folder: Path = TEMPLATES) -> jinja2.Template:
    """Load a page template; it escapes all values."""
    loader = jinja2.FileSystemLoader(folder)
    environment = jinja2.Environment(loader=loader, autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True)
    environment.filters["with_code"] = with_code
    return environment.get_template(name)
