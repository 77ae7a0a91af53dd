"""What a student's function may hand back, alone or in parts."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from labsid.checks import NoAnswer
from labsid.checks.question import returned, returned_parts


def test_what_comes_back_is_handed_on(answers: Callable) -> None:
    assert returned(answers({"double": lambda x: 2 * x}, 0), "double", 3.0) == 6.0


def test_a_function_without_return_is_told_so(answers: Callable) -> None:
    with pytest.raises(NoAnswer, match="`fit` returns nothing: end it with `return`") as told:
        returned(answers({"fit": lambda: None}, 0), "fit")
    assert told.value.slip == "no return"


@pytest.mark.parametrize(
    "parts", [(np.eye(2), np.ones(2)), [np.ones(2), np.zeros(2)], (1.0, 2.0), np.ones((2, 5)), (np.ones(3), 1)]
)
def test_parts_may_come_in_a_tuple_a_list_or_stacked(parts: Any, answers: Callable) -> None:
    got = returned_parts(answers({"fit": lambda: parts}, 0), "fit", "theta and P", 2)
    assert len(got) == 2
    for part, right in zip(got, parts, strict=True):
        np.testing.assert_array_equal(part, right)


@pytest.mark.parametrize(
    ("value", "kind"),
    [(np.ones((3, 2)), "an array of shape"), (1.0, "a number"), ("ab", "text"), ((1, "a", 2), "tuple")],
)
def test_another_number_of_parts_is_said(value: Any, kind: str, answers: Callable) -> None:
    with pytest.raises(NoAnswer, match=f"`fit` should return theta and P; it returns .*{kind}") as told:
        returned_parts(answers({"fit": lambda: value}, 0), "fit", "theta and P", 2)
    assert told.value.slip == "incomplete result"
