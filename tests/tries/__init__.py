"""Natural first mistakes of a third-year student at each question, and what the checks must say to them."""

import linecache
import re
from dataclasses import dataclass, replace
from importlib import import_module
from typing import NamedTuple

from one_answer import Solved, cells_of, quietly, solve

from labsid.checks.notebook import NotebookAsk
from labsid.checks.python_errors import told
from labsid.checks.stops import stop_of
from labsid.checks.time_limit import OutOfTime, limit_time
from labsid.checks.verdict import PYTHON_ERROR

ASSIGNMENTS = (
    "prelab-sinusoids",
    "lab-identification",
    "postlab-model-order",
    "step-response",
    "least-squares",
    "model-structures",
    "recursive-identification",
    "armax-and-instruments",
    "nonlinear-least-squares",
    "sim-to-real-gap",
    "several-signals",
)
TAUGHT, VAGUE, MISLEADING, TICK, ACCEPTED = "taught", "vague", "misleading", "false tick", "acceptable"
_KINDS = (
    "kinds_of_errors",
    "answers_in_the_lab",
    "answers_at_rigs",
    "answers_on_lectures",
    "causes_in_the_lab",
    "causes_on_lectures",
    "terms_and_factors",
    "causes_and_numbers",
    "neighbours_of_errors",
    "one_symptom",
    "other_formulas",
    "other_repairs",
    "places_and_parts",
    "tried_repairs",
    "two_at_once",
)
"""Modules with tries at several assignments."""
_SECONDS = 5.0


@dataclass(frozen=True)
class Try:
    """One first try.

    Attributes
    ----------
    question, name : str
    code : str
        The answer cell.
    says : str
        Pattern of what the message must contain: what names the mistake. "" where the answer is acceptable.
    grade : str
        How the message was judged when it was written down.
    never : str
        Pattern of what the message must not contain, such as the cause of a neighbouring mistake.
    more : tuple of (str, str)
        Other cells that belong to it: grade_id and source.
    """

    question: str
    name: str
    code: str
    says: str
    grade: str = TAUGHT
    never: str = ""
    more: tuple[tuple[str, str], ...] = ()


def tries_of(assignment: str) -> tuple[Try, ...]:
    """The tries at an assignment."""
    tries: tuple[Try, ...] = import_module(f"tries.{assignment.replace('-', '_')}").TRIES
    of_kinds = [import_module(f"tries.{kinds}").TRIES for kinds in _KINDS]
    return (*tries, *(one for kinds in of_kinds for one in kinds.get(assignment, ())))


def edited(question: str, *changes: tuple[str, str]) -> str:
    """The model solution of a question, with some of its text replaced."""
    source = next(cells[f"{question}-answer"] for cells in map(cells_of, ASSIGNMENTS) if f"{question}-answer" in cells)
    for old, new in changes:
        assert old in source, f"{old!r} is not in the solution of {question}"
        source = source.replace(old, new)
    return source


class Said(NamedTuple):
    """The outcome of a try: whether it gets a tick, the message of the notebook's check, and the slip it names."""

    ticked: bool
    message: str
    slip: str | None = None


def said_to(one: Try, solved: Solved) -> Said:
    """What the notebook's check says to a try."""
    cells = {**dict(one.more), f"{one.question}-answer": one.code}
    ids = list(solved.cells)
    first = min(map(ids.index, cells))
    questions = {question.id for question in solved.assignment.questions}
    to_run = [name for name in ids[first : ids.index(one.question)] if name not in questions]
    sources = {name: cells.get(name, solved.cells[name]) for name in to_run}
    variables = solved.kept[ids[first]].variables(sources.values())
    with quietly(), solved.in_folder():
        for name, source in sources.items():
            try:
                linecache.cache[name] = (len(source), None, source.splitlines(keepends=True), name)  # as IPython does
                with limit_time(_SECONDS):
                    exec(compile(source, name, "exec"), variables)
            except (Exception, OutOfTime) as error:
                question = solved.assignment.question(one.question)
                ask = NotebookAsk(variables, solved.record, solved.known[one.question], one.question)
                stop = replace(stop_of(error, variables, source), outcome=question.outcome_of_mends(ask))
                return Said(False, told(stop, "its answer cell"), PYTHON_ERROR)
        ask = NotebookAsk(variables, solved.record, solved.known[one.question], one.question, one.code)
        verdict = solved.assignment.question(one.question).verdict(ask)
    question = solved.assignment.question(one.question)
    for_values = question.reference is not None or question.gives is not None
    tried = "" if verdict.slip is not None or verdict.passed or for_values else ask.tried
    beside = ask.beside if verdict.slip in (None, PYTHON_ERROR) and not verdict.passed else ""
    said = " ".join(filter(None, (verdict.reason, beside, tried)))
    return Said(verdict.passed and not verdict.noted, said, verdict.slip)


def outcome(one: Try) -> Said:
    """What is said to a try at its assignment's model solution."""
    name = next(name for name in ASSIGNMENTS if one in tries_of(name))
    return said_to(one, solve(name))


def fault_of(one: Try, said: Said) -> str:
    """What is wrong with the outcome of a try; empty if nothing is."""
    ticked, message, _ = said
    if one.grade == ACCEPTED:
        return "" if ticked else f"an acceptable answer is refused: {message}"
    if ticked:
        return "it gets a tick"
    if not re.search(one.says, message, re.IGNORECASE):
        return f"the message lacks {one.says!r}: {message}"
    if one.never and re.search(one.never, message, re.IGNORECASE):
        return f"the message has {one.never!r}: {message}"
    return ""
