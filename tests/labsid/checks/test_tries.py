"""Natural first tries: each message names the mistake, and no mistake is ticked. `tests/tries_table.py` prints them."""

import re
from functools import cache

import numpy as np
import pytest
from declared_slips import SHARED, declared_slips
from one_answer import quietly, solve
from tries import ACCEPTED, ASSIGNMENTS, Said, Try, fault_of, said_to, tries_of
from tries.nonlinear_least_squares import lm
from variants import Wrong, variants_of

from labsid.checks.notebook import load_assignment

ELSEWHERE = {
    "start-up averaged in": "test_lab_identification, on a record that is not settled",
    "mean before the rig has settled": "test_step_response, on a record that is not settled",
    "every step accepted": "below: a given cell stops before the check",
    "lag off by one": "test_sim_to_real_gap, on the rigs whose run it shows",
    "the other offset": "test_sim_to_real_gap: grading alone knows",
    "does not hold on fresh data": "test_sim_to_real_gap: grading alone knows",
    "typed in": "test_typed_values: told from the runs of cells",
}
"""Slips that are reached in another place than by a try or a variant."""


@cache
def outcomes(name: str) -> dict[Try, Said]:
    """What is said to each try at an assignment."""
    return {one: said_to(one, solve(name)) for one in tries_of(name)}


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_each_first_try_is_taught(name: str) -> None:
    said = outcomes(name)
    faults = {f"{one.question}, {one.name}": fault for one in said if (fault := fault_of(one, said[one]))}
    assert faults == {}
    # the neighbours of a mistake, other tries at the same question, are not told what names it
    for one in said:
        others = [said[other].message for other in said if other.question == one.question and other.says != one.says]
        alike = [text for text in others if re.search(one.says, text, re.IGNORECASE)]
        assert one.grade == ACCEPTED or len(alike) <= len(others) / 2, (one.question, one.name, alike)


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_every_question_is_tried(name: str) -> None:
    tried = {one.question for one in tries_of(name)}
    assert tried == {question.id for question in load_assignment(name).questions}


def named(name: str) -> set[str | None]:
    """The slips that tries at an assignment, or its variants, are given."""
    of_variants = {one.slip for one in variants_of(name) if isinstance(one, Wrong)}
    return of_variants | {said.slip for said in outcomes(name).values()}


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_every_slip_of_an_assignment_is_reached(name: str) -> None:
    declared = declared_slips()[name.replace("-", "_")]
    assert {declared[slip]: slip for slip in declared.keys() - named(name) - ELSEWHERE.keys()} == {}


def test_every_slip_that_assignments_share_is_reached() -> None:
    declared = declared_slips()
    shared = declared[SHARED].keys() - set().union(*map(named, ASSIGNMENTS))
    assert shared <= ELSEWHERE.keys()
    assert ELSEWHERE.keys() <= set().union(*declared.values())


def test_a_fit_that_accepts_every_step_is_told_where_it_ends() -> None:
    solved = solve("nonlinear-least-squares")
    with quietly():
        variables = solved.run("nl-4-damping", {})
        exec(lm(test="True"), variables)
        with pytest.raises(np.linalg.LinAlgError):
            exec(solved.cells["nl-4-trial"], variables)
        verdict = solved.verdict("nl-4-damping", variables, 0)
    assert verdict.slip == "every step accepted"
