"""What the notebook with solutions says of each question: its text, the model answer, and how it is marked by hand."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal
from functools import lru_cache
from pathlib import Path

import nbformat

from autograder.course.layout import Course
from autograder.course.lint import METADATA, SOLUTION_DELIMITERS
from labsid.checks.cells import HIDDEN_DELIMITERS, read_cell

_HIDDEN_REGION = re.compile(rf"[ \t]*{HIDDEN_DELIMITERS[0]}.*?{HIDDEN_DELIMITERS[1]}[^\n]*\n?", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Criterion:
    """One line of a rubric.

    Attributes
    ----------
    text : str
        What the answer says, in Markdown.
    points : Decimal
    """

    text: str
    points: Decimal


@dataclass(frozen=True, slots=True)
class QuestionText:
    """A question as the notebook with solutions has it.

    Attributes
    ----------
    task : str
        The text above the answer, below its last heading, in Markdown.
    model : str
        The model answer: Markdown if it is marked by hand, otherwise code.
    rubric : tuple of Criterion
        How it is marked by hand; may be empty.
    values : tuple of str
        Names of right values that belong to the model answer and depend on the record.
    """

    task: str
    model: str
    rubric: tuple[Criterion, ...] = ()
    values: tuple[str, ...] = ()


def read_questions(course: Course | None, assignment: str) -> Mapping[str, QuestionText]:
    """The questions of an assignment, by ID; empty where the course, or its notebook with solutions, is not here."""
    path = None if course is None else course.source / assignment / f"{assignment}.ipynb"
    return _read(path, path.stat().st_mtime_ns) if path is not None and path.is_file() else {}


@lru_cache(maxsize=64)
def _read(path: Path, changed_ns: int) -> Mapping[str, QuestionText]:
    """The questions in a notebook with solutions, cached until it changes."""
    found: dict[str, QuestionText] = {}
    texts: list[str] = []
    answers: list[str] = []
    for raw in nbformat.reads(path.read_text(encoding="utf-8"), as_version=4).cells:
        cell = read_cell(raw)
        if cell is None:
            texts += [raw.source] if raw.cell_type == "markdown" else []
        elif cell.kind == "answer":
            answers.append(without_delimiters(cell.source))
        elif cell.kind in ("question", "tests", "manual"):
            model = without_delimiters(cell.source) if cell.kind == "manual" else "\n\n".join(answers)
            own = raw.metadata.get(METADATA, {})
            rubric = tuple(Criterion(one["text"], Decimal(str(one["points"]))) for one in own.get("rubric", ()))
            found[cell.id] = QuestionText(
                _last_section("\n\n".join(texts)), model, rubric, tuple(own.get("values", ()))
            )
            texts, answers = [], []
    return found


def without_delimiters(source: str) -> str:
    """A cell of the notebook with solutions without the marks of its solution, and without hidden tests."""
    lines = _HIDDEN_REGION.sub("", source).splitlines()
    return "\n".join(line for line in lines if line.strip() not in SOLUTION_DELIMITERS).strip()


def _last_section(text: str) -> str:
    """Markdown from below its last heading, without folded hints."""
    *_, last = re.split(r"^#{1,6}\s.*$", text, flags=re.MULTILINE)
    return re.sub(r"<details>.*?</details>\n*", "", last, flags=re.DOTALL).strip()
