"""Natural first tries: each message names the mistake, and no mistake is ticked. `tests/tries_table.py` prints them."""

import re
from functools import lru_cache

import pytest
from one_answer import solve
from tries import ACCEPTED, ASSIGNMENTS, Try, fault_of, said_to, tries_of

from labsid.checks.notebook import load_assignment


@lru_cache(maxsize=1)
def outcomes(name: str) -> dict[Try, tuple[bool, str]]:
    """What is said to each try at an assignment."""
    return {one: said_to(one, solve(name)) for one in tries_of(name)}


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_each_first_try_is_taught(name: str) -> None:
    said = outcomes(name)
    faults = {f"{one.question}, {one.name}": fault for one in said if (fault := fault_of(one, *said[one]))}
    assert faults == {}
    # the neighbours of a mistake, other tries at the same question, are not told what names it
    for one in said:
        others = [said[other][1] for other in said if other.question == one.question and other.says != one.says]
        alike = [text for text in others if re.search(one.says, text, re.IGNORECASE)]
        assert one.grade == ACCEPTED or len(alike) <= len(others) / 2, (one.question, one.name, alike)


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_every_question_is_tried(name: str) -> None:
    tried = {one.question for one in tries_of(name)}
    assert tried == {question.id for question in load_assignment(name).questions}
