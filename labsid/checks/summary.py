"""How far an assignment is: each question with its mark, as text and as HTML. Pure functions of the states."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from html import escape
from itertools import groupby

from labsid.checks.cells import Cell, answer_id, is_stub

PASSED, FAILED, SKIPPED, NOT_DONE, BY_HAND = "right", "not right", "skipped", "not done", "marked by hand"
NOTED = "noted"
"""An answer that is complete, and of which grading alone can tell whether it is right."""
SIGNS = {PASSED: "✓", FAILED: "✗", SKIPPED: "–", NOT_DONE: "·", BY_HAND: "✎", NOTED: "○"}
_COLOURS = {
    PASSED: "#1a7f37", FAILED: "#c62828", SKIPPED: "#8a5a00", NOT_DONE: "#5f6368", BY_HAND: "#5f6368", NOTED: "#5f6368"
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class QuestionState:
    """One question in a summary.

    Attributes
    ----------
    question : Cell
        With its points, its heading and its part.
    state : str
        One of `PASSED`, `FAILED`, `SKIPPED`, `NOT_DONE`, `BY_HAND`, `NOTED`.
    """

    question: Cell
    state: str

    @property
    def marks(self) -> Decimal:
        """The marks to be had."""
        return self.question.points or Decimal(0)

    @property
    def earned(self) -> Decimal:
        """The marks that the checks give."""
        return self.marks if self.state == PASSED else Decimal(0)


def states_of(
    questions: Iterable[Cell], found: Mapping[str, str], sources: Mapping[str, str]
) -> tuple[QuestionState, ...]:
    """The questions of an assignment with their states.

    Parameters
    ----------
    questions : iterable of Cell
    found : mapping
        What the checks found, by question; a question that is missing is not done.
    sources : mapping
        The text of the notebook's answer cells, by id. A question whose cell is as released is not done, rather than
        not right or marked by hand.

    Returns
    -------
    tuple of QuestionState
    """
    return tuple(QuestionState(cell, _state(cell, found, sources)) for cell in questions)


def _state(question: Cell, found: Mapping[str, str], sources: Mapping[str, str]) -> str:
    if question.kind == "manual":
        return NOT_DONE if is_stub(sources.get(question.id, question.source)) else BY_HAND
    state = found.get(question.id, NOT_DONE)
    answer = sources.get(answer_id(question.id))
    return NOT_DONE if state == FAILED and answer is not None and is_stub(answer) else state


def total_text(states: Sequence[QuestionState]) -> str:
    """The marks of several questions in words."""
    earned, marks = sum_of(states)
    by_hand = sum((one.marks for one in states if one.question.kind == "manual"), Decimal(0))
    noted = sum((one.marks for one in states if one.state == NOTED), Decimal(0))
    beside = f"; {decimal_text(by_hand)} of them are given by hand" if by_hand else ""
    beside += f"; {decimal_text(noted)} are for answers that are noted, and judged at grading" if noted else ""
    return f"{marks_of(earned, marks)} marks{beside}"


def sum_of(states: Sequence[QuestionState]) -> tuple[Decimal, Decimal]:
    """Marks earned and marks to be had, exact."""
    zero = Decimal(0)
    return sum((one.earned for one in states), zero), sum((one.marks for one in states), zero)


def summary_text(title: str, states: Sequence[QuestionState]) -> str:
    """The summary as a table of text."""
    wide = max((len(one.question.id) for one in states), default=0)
    lines = [title]
    for part, inside in _parts(states):
        if part:
            lines.append(f"{part}: {total_text(inside)}")
        lines += [
            f"  {SIGNS[one.state]} {one.question.id:<{wide}} {_marks(one):>12}  {one.state:<14} {one.question.heading}"
            for one in inside
        ]
    return "\n".join([*lines, f"Total: {total_text(states)}"])


def summary_html(title: str, states: Sequence[QuestionState]) -> str:
    """The summary as an HTML table."""
    rows = []
    for part, inside in _parts(states):
        if part:
            rows.append(_row("th", "", escape(part), total_text(inside), ""))
        for one in inside:
            step = f"{escape(one.question.heading)} <code>{escape(one.question.id)}</code>"
            rows.append(_row("td", sign_html(one.state), step, _marks(one), one.state))
    rows.append(_row("th", "", "Total", total_text(states), ""))
    return f"<table><caption>{escape(title)}</caption><tbody>{''.join(rows)}</tbody></table>"


def sign_html(state: str) -> str:
    """The sign of a state in its colour."""
    return f'<span style="color:{_COLOURS[state]};font-weight:bold">{SIGNS[state]}</span>'


def decimal_text(number: Decimal) -> str:
    """A number of marks without trailing zeros."""
    return f"{number.normalize():f}"


def marks_of(earned: Decimal, marks: Decimal) -> str:
    """Marks earned of marks to be had."""
    return f"{decimal_text(earned)} of {decimal_text(marks)}"


def _marks(one: QuestionState) -> str:
    if one.question.kind == "manual" or one.state == NOTED:
        return f"up to {decimal_text(one.marks)}"
    return marks_of(one.earned, one.marks)


def _row(cell: str, sign: str, step: str, marks: str, state: str) -> str:
    left, whole = ' style="text-align:left"', ' style="text-align:left;white-space:nowrap"'
    return (
        f"<tr><{cell}>{sign}</{cell}><{cell}{left}>{step}</{cell}><{cell}{left}>{marks}</{cell}>"
        f"<{cell}{whole}>{state}</{cell}></tr>"
    )


def _parts(states: Sequence[QuestionState]) -> list[tuple[str, list[QuestionState]]]:
    """The questions by part; the part is empty if there is only one."""
    parts = [(part, list(inside)) for part, inside in groupby(states, key=lambda one: one.question.part)]
    return parts if len(parts) > 1 else [("", list(states))]
