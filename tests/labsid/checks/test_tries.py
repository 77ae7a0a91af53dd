"""Natural first tries: each message names the mistake, and no mistake gets a tick. `tests/tries_table.py` prints them."""

import pytest
from one_answer import solve
from tries import ASSIGNMENTS, fault_of, said_to, tries_of

from labsid.checks.notebook import load_assignment


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_each_first_try_is_taught(name: str) -> None:
    solved = solve(name)
    faults = {
        f"{one.question}, {one.name}": fault
        for one in tries_of(name)
        if (fault := fault_of(one, *said_to(one, solved)))
    }  # fmt: skip
    assert faults == {}


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_every_question_is_tried(name: str) -> None:
    tried = {one.question for one in tries_of(name)}
    assert tried == {question.id for question in load_assignment(name).questions}
