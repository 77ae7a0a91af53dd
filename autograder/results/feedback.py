"""Feedback pages: one self-contained HTML file for each submission, made from its stored result."""

import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from pathlib import Path
from typing import Any

import jinja2
import markupsafe

from autograder.course.plain_text import plain_decimal
from autograder.course.questions import QuestionText
from autograder.judge.outcome import QuestionResult
from autograder.judge.picture import words_of
from autograder.results import gradebook, grades, result_files
from autograder.results.gradebook import Key, ManualGrades, Mark
from autograder.results.prose import keep_slow_texts, prose_html
from autograder.results.result_files import StoredResult
from labsid._files import write_text
from labsid.plots.style import STYLE_SHEETS

TEMPLATES = Path(__file__).parent / "templates"
_MARKS = {"right": "✓", "partial": "◐", "wrong": "✗", "wait": "…", "none": "·"}
_STEPS = r"[\w-]+(?:, [\w-]+)*"
_RIGHT_VALUES = re.compile(
    rf"\(Judged on the right values of (?P<after>{_STEPS})\.\)\Z|\AJudged on the right values of (?P<before>{_STEPS}): "
)
"""The note of `autograder.judge` after the reason of a right answer, or before that of a wrong one."""
_WORDS = {
    "right": "right",
    "partial": "partly right",
    "wrong": "wrong",
    "wait": "not yet graded",
    "none": "without marks",
}


@dataclass(frozen=True, slots=True)
class FeedbackTexts:
    """What the course adds to the feedback pages.

    Attributes
    ----------
    title : str
        Title of the course.
    questions : mapping
        The text of each question and its model answer, by assignment and question.
    with_models : frozenset of str
        Assignments whose pages have the model answers.
    values : callable
        ``values(student, assignment)``: the right values on the student's own record, as text by name, by question.
    """

    title: str = ""
    questions: Mapping[str, Mapping[str, QuestionText]] = field(default_factory=dict)
    with_models: frozenset[str] = frozenset()
    values: Callable[[str, str], Mapping[str, Mapping[str, str]]] = lambda student, assignment: {}


def write_feedback(out: Path, texts: FeedbackTexts | None = None) -> Iterator[Path]:
    """Write ``OUT/feedback/<student>/<assignment>.html`` for every result; yields each page's path.

    Includes the scores and comments of manual grading.

    Parameters
    ----------
    out : Path
    texts : FeedbackTexts, optional

    Raises
    ------
    ValueError
        If OUT holds no results.
    """
    manual, names = gradebook.read_manual_grades(out), gradebook.read_names(out)
    keep_slow_texts(out)
    page_template = load_template("feedback.html.j2")
    for result in result_files.load_all(out):
        path = out / "feedback" / result.student / f"{result.assignment}.html"
        page = feedback_page(result, manual, names.get(result.student, ""), texts)
        write_text(path, page_template.render(page=page))
        yield path


def feedback_page(
    result: StoredResult, manual: ManualGrades, name: str = "", texts: FeedbackTexts | None = None
) -> dict[str, Any]:
    """The content of a feedback page, as plain text and safe HTML.

    Parameters
    ----------
    result : StoredResult
    manual : ManualGrades
    name : str
        Name of the student, if known.
    texts : FeedbackTexts, optional

    Returns
    -------
    dict
    """
    texts = texts or FeedbackTexts()
    asked = texts.questions.get(result.assignment, {})
    has_models = result.assignment in texts.with_models
    values = texts.values(result.student, result.assignment) if has_models else {}
    questions = []
    headings = unique_headings(result)
    marks = grades.totals(result, manual.scores)
    for question in result.questions:
        key = (result.student, result.assignment, question.question)
        block = _question_block(question, key, manual, headings[question.question])
        block["task"] = _task(asked.get(question.question))
        block["model"] = _model(question, asked.get(question.question), values) if has_models else None
        mark = manual.marks.get((result.student, result.assignment, question.question))
        block["rubric"] = _rubric(asked.get(question.question), mark) if has_models else []
        questions.append(block)
    right_values = _take_right_values(questions)
    automatic = [block for block in questions if not block["by_hand"]]
    wrong = [block for block in questions if block["look"] == "wrong"]
    is_absent = result.refusal in (result_files.NOT_HANDED_IN, result_files.AS_RELEASED)  # said by `refusal` alone
    return {
        "student": f"{printable(name)} ({result.student})" if name else result.student,
        "course": texts.title,
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
        "right_values": right_values,
        "notes": [] if is_absent else [printable(note) for note in result.notes],
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
        "figures": [{"image": picture, "words": printable(words_of(picture))} for picture in question.figures],
    }


def _take_right_values(blocks: Sequence[dict[str, Any]]) -> dict[str, list[dict[str, Any]]] | None:
    """Take from the reasons on the right values of which steps they were judged, to say it once.

    Returns
    -------
    dict or None
        The ``wrong`` steps, and the questions ``judged`` on right values of theirs; None if there are none.
    """
    wrong: dict[str, None] = {}
    judged = []
    for block in blocks:
        noted = _RIGHT_VALUES.search(block["reason"])
        if noted:
            wrong |= dict.fromkeys((noted["after"] or noted["before"]).split(", "))
            judged.append(block)
            block["reason"] = _RIGHT_VALUES.sub("", block["reason"], count=1).strip()
    by_id = {block["id"]: block for block in blocks}
    steps = [by_id.get(step, {"id": step, "heading": step}) for step in wrong]
    return {"wrong": steps, "judged": judged} if steps else None


def _task(text: QuestionText | None) -> str:
    """The text of a question as HTML; empty if it is not known."""
    return prose_html(text.task) if text is not None and text.task else ""


def _model(
    question: QuestionResult, text: QuestionText | None, values: Mapping[str, Mapping[str, str]]
) -> dict[str, Any] | None:
    """The model answer of a question, with its values on the student's record; None if it is not known."""
    if text is None or not text.model:
        return None
    by_hand = question.status == "manual"
    return {
        "prose": prose_html(text.model) if by_hand else None,
        "code": text.model,
        "values": values_of(question.question, text, values),
    }


def _rubric(text: QuestionText | None, mark: Mark | None) -> list[dict[str, Any]]:
    """The lines of the rubric by which a question was marked; none if it was not marked by one."""
    if text is None or mark is None or not mark.ticked:
        return []
    return [
        {"text": prose_html(one.text), "points": plain_decimal(one.points), "ticked": number in mark.ticked}
        for number, one in enumerate(text.rubric)
    ]


def values_of(question: str, text: QuestionText, values: Mapping[str, Mapping[str, str]]) -> dict[str, str]:
    """The right values that belong to a model answer: those of the question, or those that its metadata name."""
    if not text.values:
        return dict(values.get(question, {}))
    known = {name: value for found in values.values() for name, value in found.items()}
    return {name: known[name] for name in text.values if name in known}


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


def as_sentence(text: str) -> str:
    """A text with a capital at its beginning, unless that may be a name in code."""
    return text[:1].upper() + text[1:] if re.match(r"(a|[a-z]{2,}) ", text) else text


def with_code(text: str) -> markupsafe.Markup:
    """Escaped HTML of a text, with backticked names as code."""
    parts = str(text).split("`")
    if len(parts) % 2 == 0:  # an unpaired backtick is an ordinary character
        return markupsafe.escape(text)
    marked = (f"<code>{markupsafe.escape(p)}</code>" if i % 2 else markupsafe.escape(p) for i, p in enumerate(parts))
    return markupsafe.Markup("".join(marked))


def load_template(name: str, folder: Path = TEMPLATES) -> jinja2.Template:
    """Load a page template; it escapes all values."""
    loader = jinja2.FileSystemLoader([folder, STYLE_SHEETS])
    environment = jinja2.Environment(loader=loader, autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True)
    environment.filters |= {"with_code": with_code, "as_sentence": as_sentence}
    return environment.get_template(name)
