"""Natural first tries: each message names the mistake, and no mistake is ticked. `tests/tries_table.py` prints them."""

import re
from functools import cache
from itertools import permutations

import numpy as np
import pytest
from declared_slips import SHARED, declared_slips
from one_answer import quietly, solve
from tries import ACCEPTED, ASSIGNMENTS, Said, Try, fault_of, said_to, tries_of
from tries.nonlinear_least_squares import lm
from variants import Wrong, variants_of

from labsid.checks.double_mistakes import FACTORS, TWO
from labsid.checks.notebook import load_assignment
from labsid.checks.recursions import RECURSION
from labsid.checks.verdict import PYTHON_ERROR

ELSEWHERE = {
    ("lab-identification", "start-up averaged in"): "test_lab_identification, on a record that is not settled",
    ("step-response", "mean before the rig has settled"): "test_step_response, on a record that is not settled",
    ("nonlinear-least-squares", "every step accepted"): "below: a given cell stops before the check",
    ("sim-to-real-gap", "the other offset"): "test_sim_to_real_gap: grading alone knows",
    ("sim-to-real-gap", "does not hold on fresh data"): "test_sim_to_real_gap: grading alone knows",
    (SHARED, "typed in"): "test_typed_values: told from the runs of cells",
}
"""Slips that are reached in another place than by a try or a variant."""
NAMES_BOTH = {
    ("lab-1a-sampling-time", "the first time"): "0 is t[0], and a rounded difference",
    ("lab-2c-transfer-function", "no sampling time"): "None and True are told together",
    ("gap-1-rest", "spread of the whole record"): "half of the record spreads as the whole does",
    ("gap-5-operating", "another signal sorted"): "empty cells are the same for every signal beside them: it asks",
    ("sev-1-read", "one signal only"): "one column is named, or taken: it asks",
}
"""Messages that different mistakes with one result get, and why each of these is in it."""

NAMES_SEVERAL = (TWO, RECURSION, FACTORS)
"""Slips whose message names two mistakes, or all terms."""


@cache
def outcomes(name: str) -> dict[Try, Said]:
    """What is said to each try at an assignment."""
    return {one: said_to(one, solve(name)) for one in tries_of(name)}


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_each_first_try_is_taught(name: str) -> None:
    said = outcomes(name)
    faults = {f"{one.question}, {one.name}": fault for one in said if (fault := fault_of(one, said[one]))}
    assert faults == {}


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_what_names_a_mistake_is_not_said_to_its_neighbours(name: str) -> None:
    """Other tries at the question get another message, and of those with another slip none that names this mistake."""
    said = {one: it for one, it in outcomes(name).items() if one.grade != ACCEPTED}
    alike = [
        (one.question, one.name, other.name, said[other].message)
        for one, other in permutations(said, 2)
        if one.question == other.question and one.says != other.says
        if said[one].message == said[other].message or _is_named_beside(one, said[one], said[other])
        if (one.question, said[one].slip) not in NAMES_BOTH
    ]
    assert alike == []


def _is_named_beside(one: Try, its: Said, others: Said) -> bool:
    """Whether the message that names another slip names this mistake, too."""
    other_slip = others.slip not in (its.slip, None, PYTHON_ERROR, *NAMES_SEVERAL)
    return other_slip and re.search(one.says, others.message, re.IGNORECASE) is not None


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_every_question_is_tried(name: str) -> None:
    tried = {one.question for one in tries_of(name)}
    assert tried == {question.id for question in load_assignment(name).questions}


def named(name: str) -> set[str | None]:
    """The slips that tries at an assignment, or its variants, are given."""
    of_variants = {one.slip for one in variants_of(name) if isinstance(one, Wrong)}
    return of_variants | {said.slip for said in outcomes(name).values()}


@pytest.mark.parametrize("name", [*ASSIGNMENTS, SHARED])
def test_every_slip_is_reached(name: str) -> None:
    declared = declared_slips()[name.replace("-", "_")]
    reached = named(name) if name in ASSIGNMENTS else set().union(*map(named, ASSIGNMENTS))
    elsewhere = {slip for there, slip in ELSEWHERE if there == name}
    assert {slip: declared[slip] for slip in declared.keys() - reached} == {slip: declared[slip] for slip in elsewhere}


def test_a_fit_that_accepts_every_step_is_told_where_it_ends() -> None:
    solved = solve("nonlinear-least-squares")
    with quietly():
        variables = solved.run("nl-4-damping", {})
        exec(lm(test="True"), variables)
        with pytest.raises(np.linalg.LinAlgError):
            exec(solved.cells["nl-4-trial"], variables)
        verdict = solved.verdict("nl-4-damping", variables, 0)
    assert verdict.slip == "every step accepted"
