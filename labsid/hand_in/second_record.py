"""The run of a notebook on a public second record, as grading runs it on records that nobody has seen."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from labsid.checks.cells import Template
from labsid.checks.notebook import find_assignment
from labsid.checks.other_records import another_record, can_be_drawn
from labsid.checks.question import FollowsFrom
from labsid.checks.summary import FAILED, PASSED
from labsid.checks.typed_values import PUBLIC_ENTROPY
from labsid.hand_in.clean_run import CleanRun, run_from_clean_start
from labsid.records.record import load_record

ON_YOUR_RECORD_ONLY = (
    "it is right on your record, and not on another one. Grading runs your notebook on another record, too, where this "
    "would earn nothing: compute it from the record, and type no value that another record does not have."
)


def confirmed_on_another_record(
    first: CleanRun, cells: Sequence[Mapping[str, Any]], template: Template, notebook: Path
) -> CleanRun:
    """The clean run with the questions as not right that are right on the student's own record alone.

    Parameters
    ----------
    first : CleanRun
        On the student's own record.
    cells : sequence of mapping
        The student's cells.
    template : Template
        The assignment as it was released.
    notebook : Path
        The notebook's file.

    Returns
    -------
    CleanRun
        As it was, where nothing that follows from the record is right, or no other record can be drawn.
    """
    assignment = find_assignment(template.assignment)
    asked = {question.id for question in assignment.questions if question.follows_from is FollowsFrom.DATA}
    right = {state.question.id for state in first.states if state.state == PASSED} & asked
    own = notebook.parent / (assignment.record_file or "")
    if not right or not can_be_drawn(own.name) or not own.is_file():
        return first
    try:
        content = another_record(own.name, load_record(own), PUBLIC_ENTROPY)
    except ValueError:  # grading has no other record either
        return first
    second = run_from_clean_start(cells, template, notebook, content=content)
    wrong = {
        state.question.id: state.question
        for state in second.states
        if state.state == FAILED and state.question.id in right
    }
    reasons = {key: f"{key} ({cell.heading}): {ON_YOUR_RECORD_ONLY}" for key, cell in wrong.items()}
    states = tuple(replace(state, state=FAILED) if state.question.id in wrong else state for state in first.states)
    return replace(first, states=states, reasons={**first.reasons, **reasons})
